//! A robot that lacks a component is sent it by another one before it starts: over loopback, between
//! containers of their own.

mod memory;

use std::path::{Path, PathBuf};

use robot_network::package::{Machine, Package, SigningKey};
use rustix::process::Signal;
use tests::{Application, Member, Outcome, Supervised, Watched, artifacts, take_turn};

use crate::robots::{free_port, network, package};

/// The component that travels: the counter under a name that no other file has, so that only who is
/// sent it can have it.
const TRAVELLER: &str = "traveller";
const OUTPUT: &str =
    "<data_port><name>output</name><usage>output</usage><data_type>Sample</data_type></data_port>";

/// Robot R2, which has the traveller and gives it away.
struct Sender {
    robot: Application,
    port: u16,
    running: Watched,
}

/// Profile, library, key and package of the traveller, in the folder of a robot.
pub(crate) fn pack(robot: &Application) {
    let folder = robot.folder();
    let library = artifacts().join("libcounter.so");
    std::fs::copy(library, folder.join("libtraveller.so")).expect("a copy of the counter");
    std::fs::create_dir(folder.join("packages")).expect("a folder");
    for name in ["team", "stranger"] {
        let made = package(folder, &["key", &format!("{name}.key")]);
        assert_eq!(made.code, Some(0), "{made}");
        robot.write(&format!("{name}.pub"), made.stdout);
    }
    let sealed = ["seal", "traveller.xml", "--key", "team.key"];
    let sealed = [&sealed[..], &["--output", "packages/traveller.sfp"]].concat();
    let sealed = package(folder, &sealed);
    assert_eq!(sealed.code, Some(0), "{sealed}");
}

pub(crate) fn traveller() -> Member {
    let member = Member::new(TRAVELLER, TRAVELLER).property("remembers", "true");
    member.ports(OUTPUT)
}

impl Sender {
    fn start() -> Self {
        let port = free_port();
        let address = format!("listen='tcp/127.0.0.1:{port}' packages='packages'");
        let robot = Application::new()
            .with(&Member::new("diary", "diary"))
            .with_profile(&traveller())
            .element(&format!("<network name='R2' {address}/>"));
        pack(&robot);
        let running = robot.start(&["--clock", "real"]);
        robot.wait_until(|events| events.contains("run_started"));
        Self {
            robot,
            port,
            running,
        }
    }

    fn package(&self) -> PathBuf {
        self.robot.folder().join("packages/traveller.sfp")
    }

    /// Robot R1, which lacks the traveller and trusts the keys in a file.
    fn receiver(&self, key: &str) -> Application {
        let fetch = format!("<fetch component='{TRAVELLER}' from='R2' key='{key}' within='20s'/>");
        let receiver = receiver(&network("R1", free_port(), &[self.port], &fetch));
        for name in ["team.pub", "stranger.pub"] {
            let content = std::fs::read(self.robot.folder().join(name)).expect("a key");
            receiver.write(name, content);
        }
        receiver
    }
}

/// A robot that records what the traveller counts.
pub(crate) fn receiver(network: &str) -> Application {
    Application::new()
        .with_reference(TRAVELLER, "traveller.xml")
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .connect("data", "traveller.output", "recorder.input")
        .element(&format!("\n{network}"))
}

/// Runs it, with what is private to runs below its folder.
fn run(robot: &Application, duration: &str) -> Outcome {
    let private = robot.folder().join("private");
    std::fs::create_dir_all(&private).expect("a folder");
    let arguments = ["--clock", "real", "--for", duration];
    let mut command = robot.command(&[robot.profile()], &arguments);
    let running = Watched::spawn(command.env("TMPDIR", &private));
    let outcome = robot.outcome(running.wait(std::time::Duration::from_secs(100)));
    assert_eq!(files_in(&private), 0, "nothing is left for a later run");
    outcome
}

fn files_in(folder: &Path) -> usize {
    std::fs::read_dir(folder).expect("a folder").count()
}

#[test]
fn a_component_that_a_robot_lacks_is_sent_and_runs() {
    let _turn = take_turn();
    let sender = Sender::start();
    let receiver = sender.receiver("team.pub");
    let outcome = run(&receiver, "1s").ended_well();
    let logs = outcome.logs("recorder");
    assert!(
        logs.iter().any(|line| line.starts_with("got 1=1")),
        "{logs:?}"
    );
    assert!(outcome.cycles(TRAVELLER) > 10);
    // Who only asks is no robot of the team, and none that dies.
    let seen = sender.robot.events_so_far();
    assert!(!seen.contains("visitor"), "{seen}");
    // It is not kept: without the other robot it is lacking again.
    drop(sender.running);
}

/// How the package on the sender is spoilt; the key that the receiver trusts; the words.
type Spoilt = (fn(&Sender) -> Vec<u8>, &'static str, &'static str);

fn sealed(sender: &Sender) -> Vec<u8> {
    std::fs::read(sender.package()).expect("the package")
}

fn tampered(sender: &Sender) -> Vec<u8> {
    let mut bytes = sealed(sender);
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    bytes
}

fn cut_short(sender: &Sender) -> Vec<u8> {
    let mut bytes = sealed(sender);
    bytes.truncate(bytes.len() - 9);
    bytes
}

/// Rightly signed, but of another component, or for another machine.
fn signed(sender: &Sender, component: &str, change: impl FnOnce(&mut Machine)) -> Vec<u8> {
    let read = |name: &str| std::fs::read(sender.robot.folder().join(name)).expect("a file");
    let key = String::from_utf8(read("team.key")).expect("a key");
    let key = SigningKey::parse(&key).expect("a key");
    let mut machine = container::network::this_machine();
    change(&mut machine);
    let (library, profile) = (read("libtraveller.so"), read("traveller.xml"));
    let package = Package::new((component, "0.1.0"), &machine, library, profile);
    package.seal(&key).expect("a package")
}

const SPOILT: [Spoilt; 6] = [
    (sealed, "stranger.pub", "no key that this robot trusts"),
    (tampered, "team.pub", "library was tampered with"),
    (cut_short, "team.pub", "cut short"),
    (
        |sender| signed(sender, "other", |_here| {}),
        "team.pub",
        "it is the package of 'other'",
    ),
    (
        |sender| {
            signed(sender, TRAVELLER, |machine| {
                machine.architecture = "riscv64-linux".to_owned();
            })
        },
        "team.pub",
        "it is built for riscv64-linux",
    ),
    (
        |sender| signed(sender, TRAVELLER, |machine| machine.abi += 1),
        "team.pub",
        "of the ABI",
    ),
];

#[test]
fn what_is_not_as_it_should_be_is_refused_before_anything_is_loaded() {
    let _turn = take_turn();
    let sender = Sender::start();
    let good = sealed(&sender);
    for (spoil, key, words) in SPOILT {
        std::fs::write(sender.package(), &good).expect("a file");
        let bytes = spoil(&sender);
        std::fs::write(sender.package(), bytes).expect("a file");
        let receiver = sender.receiver(key);
        let outcome = run(&receiver, "1s");
        let place = "application.xml:10:";
        let says = [
            "`traveller` cannot be taken from robot `R2`",
            "help: ",
            place,
        ];
        outcome.was_refused(1, &[&says[..], &[words]].concat());
    }
    std::fs::remove_file(sender.package()).expect("it is there");
    let outcome = run(&sender.receiver("team.pub"), "1s");
    outcome.was_refused(1, &["gives away no such package", "put traveller.sfp"]);
    let outcome = run(&sender.receiver("nobody.pub"), "1s");
    outcome.was_refused(2, &["nobody.pub cannot be read", "package key"]);
}

/// Without the other robot the start is refused after the limit; a check finds nothing wrong with it.
#[test]
fn without_the_other_robot_the_start_is_refused_after_the_limit() {
    let fetch = "<fetch component='traveller' from='R2' key='team.pub' within='300ms'/>";
    let receiver = receiver(&network("R1", free_port(), &[free_port()], fetch));
    let key = "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a";
    receiver.write("team.pub", key);
    let begun = std::time::Instant::now();
    let outcome = run(&receiver, "1s");
    assert!(begun.elapsed().as_millis() >= 300, "it waits");
    let words = ["`traveller`", "`R2`", "has not answered within 300 ms"];
    outcome.was_refused(2, &words);
    let outcome = receiver.simulate("1s");
    outcome.was_refused(1, &["robot `R2` sends it", "--clock real"]);
    let mut check = std::process::Command::new(artifacts().join("steadfast"));
    check.args(["check", "--strict"]).arg(receiver.profile());
    let checked = Watched::spawn(&mut check).wait(std::time::Duration::from_secs(60));
    assert_eq!(checked.code, Some(0), "{checked}");
    for words in ["robot `R2` sends it", "0 warnings, 1 note"] {
        assert!(checked.stdout.contains(words), "{checked}");
    }
}

/// The container of a supervised run is restarted with what was sent, though nobody could send it
/// again.
#[test]
fn a_supervised_container_keeps_what_was_sent() {
    let _turn = take_turn();
    let sender = Sender::start();
    let receiver = sender.receiver("team.pub");
    let parent = receiver.start(&["--clock", "real", "--supervised"]);
    let processes = Supervised::by(&parent);
    let first = processes.container(None);
    receiver.wait_until(|events| events.contains("got "));
    sender.running.signal(Signal::KILL);
    rustix::process::kill_process(first, Signal::KILL).expect("it runs");
    let _second = processes.container(Some(first));
    receiver.wait_until(|events| {
        let restart = events.find("container_restarted");
        restart.is_some_and(|at| events[at..].contains("got "))
    });
    receiver.interrupt(parent).ended_well().logs("recorder");
}
