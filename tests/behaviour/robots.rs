//! Robots in a network: containers of their own on one machine, over loopback.

mod encryption;
mod forwarder;
mod latency;
mod partition;

use std::net::TcpListener;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use rustix::process::Signal;
use serde_json::Value;
use tests::{Application, Finished, Member, Watched, artifacts, repository, take_turn};

/// A port that nobody listens at.
pub(crate) fn free_port() -> u16 {
    let listener = TcpListener::bind(("127.0.0.1", 0)).expect("a free port");
    listener.local_addr().expect("its address").port()
}

/// `<network>` of a robot that listens at a port and knows others, with what is in it.
pub(crate) fn network(name: &str, listen: u16, connect: &[u16], content: &str) -> String {
    let address = |port: &u16| format!("tcp/127.0.0.1:{port}");
    let others: Vec<String> = connect.iter().map(address).collect();
    format!(
        "<network name='{name}' listen='{}' connect='{}' silence_limit='1s'>{content}</network>",
        address(&listen),
        others.join(" ")
    )
}

const OFFER: &str = "<offer component_name='counter' port_name='output'/>";

/// A robot that counts and offers its numbers.
fn counting(network: &str) -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .element(network)
}

/// What feeds the recorder of another robot.
fn from(robot: &str) -> String {
    format!(
        "<remote_connection><source robot='{robot}' component_name='counter' port_name='output'/>
         <target component_name='recorder' port_name='input'/></remote_connection>"
    )
}

/// A robot that records the numbers of others, and has a fault when they are too old.
fn recording(network: &str) -> Application {
    Application::new()
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .element(network)
        .rules(
            "<component name='recorder'><severity>ignore</severity><port name='input'>
               <freshness max_age='1s'/></port></component>",
        )
}

/// Changes of robots so far, as `robot change`.
fn changes(application: &Application) -> Vec<String> {
    let events = application.events_so_far();
    let events = events
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let robots = events.filter(|event| event["event"] == "robot");
    let words = |event: Value| format!("{} {}", word(&event["robot"]), word(&event["change"]));
    robots.map(words).collect()
}

fn word(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// Waits until a change is on record so many times.
fn wait_for(application: &Application, change: &str, times: usize) {
    application.wait_until(|_events| {
        let changes = changes(application);
        changes.iter().filter(|it| *it == change).count() >= times
    });
}

/// Waits until so many more cycles of the recorder have got something.
fn wait_for_data(application: &Application) {
    let got = |events: &str| events.matches("\"got ").count();
    let before = got(&application.events_so_far());
    application.wait_until(|events| got(events) > before + 5);
}

fn start(application: &Application) -> Watched {
    application.start(&["--clock", "real"])
}

#[test]
fn data_go_from_robot_to_robot_and_a_kill_is_a_fault_of_what_depends_on_it() {
    let _turn = take_turn();
    let (one, other) = (free_port(), free_port());
    let first = counting(&network("R1", one, &[], OFFER));
    let second = recording(&network("R2", other, &[one], &from("R1")));
    let (killed, living) = (start(&first), start(&second));
    wait_for(&second, "R1 appeared", 1);
    wait_for(&second, "R1 decides", 1);
    wait_for(&first, "R2 appeared", 1);
    wait_for_data(&second);
    killed.signal(Signal::KILL);
    wait_for(&second, "R1 died", 1);
    wait_for(&second, "R2 decides", 1);
    second.wait_until(|events| events.contains("\"kind\":\"stale\""));
    living.signal(Signal::INT);
    let outcome = second.outcome(living.wait(Duration::from_secs(30)));
    let logs = outcome.ended_well().logs("recorder");
    let last = logs.last().expect("what was received");
    assert!(
        last.starts_with("received ") && last != "received 0",
        "{last}"
    );
}

#[test]
fn a_robot_that_hangs_is_dead_until_it_is_heard_again() {
    let _turn = take_turn();
    let (one, other) = (free_port(), free_port());
    let first = counting(&network("R1", one, &[], OFFER));
    let second = recording(&network("R2", other, &[one], &from("R1")));
    let (hanging, _living) = (start(&first), start(&second));
    wait_for(&second, "R1 decides", 1);
    wait_for_data(&second);
    hanging.signal(Signal::STOP);
    wait_for(&second, "R1 died", 1);
    wait_for(&second, "R2 decides", 1);
    hanging.signal(Signal::CONT);
    wait_for(&second, "R1 appeared", 2);
    wait_for(&second, "R1 decides", 2);
    wait_for_data(&second);
}

#[test]
fn of_two_that_feed_one_input_one_is_obeyed_and_the_other_takes_over() {
    let _turn = take_turn();
    let (one, other, third) = (free_port(), free_port(), free_port());
    let first = counting(&network("R1", one, &[], OFFER));
    let second = counting(&network("R2", other, &[one], OFFER));
    let sources = from("R1") + &from("R2");
    let actuator = recording(&network("R3", third, &[one, other], &sources));
    let (killed, _second) = (start(&first), start(&second));
    let _actuator = start(&actuator);
    wait_for(&actuator, "R1 appeared", 1);
    wait_for(&actuator, "R2 appeared", 1);
    wait_for(&actuator, "R2 refused", 1);
    killed.signal(Signal::KILL);
    wait_for(&actuator, "R2 decides", 1);
    wait_for_data(&actuator);
    let stale = actuator.events_so_far().contains("\"kind\":\"stale\"");
    assert!(!stale || changes(&actuator).contains(&"R1 died".to_owned()));
}

#[test]
fn what_cannot_be_entered_is_said_before_anything_starts() {
    let port = free_port();
    let _taken = TcpListener::bind(("127.0.0.1", port)).expect("the port is free");
    let robot = counting(&network("R1", port, &[], OFFER));
    let outcome = robot.run(&["--clock", "real", "--for", "1s"]);
    outcome.was_refused(6, &["the network cannot be entered", "another program"]);
    let robot = counting(&network("R1", free_port(), &[], OFFER));
    let outcome = robot.run(&["--clock", "simulated", "--for", "1s"]);
    outcome.was_refused(1, &["--clock real"]);
}

/// `steadfast package` with these arguments, in a folder.
pub(crate) fn package(folder: &Path, arguments: &[&str]) -> Finished {
    let mut command = Command::new(artifacts().join("steadfast"));
    command.current_dir(folder).arg("package").args(arguments);
    Watched::spawn(&mut command).wait(Duration::from_secs(60))
}

/// A package that is refused, and of which nothing is left.
#[track_caller]
fn is_refused(folder: &Path, finished: &Finished, words: &str) {
    assert_eq!(finished.code, Some(1), "{finished}");
    assert!(finished.stderr.contains(words), "{finished}");
    assert!(!folder.join("taken").exists(), "nothing may be unpacked");
}

#[test]
fn a_component_travels_signed_or_not_at_all() {
    let _turn = take_turn();
    let port = free_port();
    let robot = counting(&format!(
        "<network name='R2' listen='tcp/127.0.0.1:{port}' packages='packages'/>"
    ));
    let folder = robot.folder();
    std::fs::create_dir(folder.join("packages")).expect("a folder");
    for name in ["signing", "other"] {
        let made = package(folder, &["key", &format!("{name}.key")]);
        assert_eq!(made.code, Some(0), "{made}");
        std::fs::write(folder.join(format!("{name}.trusted")), made.stdout).expect("a file");
    }
    let profile = repository().join("profiles/components/relay.xml");
    let profile = profile.to_str().expect("a path");
    let sealed = [
        "seal",
        profile,
        "--key",
        "signing.key",
        "--output",
        "packages/relay.sfp",
    ];
    let sealed = package(folder, &sealed);
    assert_eq!(sealed.code, Some(0), "{sealed}");
    let good = std::fs::read(folder.join("packages/relay.sfp")).expect("the package");
    let mut tampered = good.clone();
    let middle = tampered.len() / 2;
    tampered[middle] ^= 1;
    for (name, content) in [
        ("tampered", &tampered[..]),
        ("short", &good[..good.len() - 9]),
    ] {
        let path = folder.join(format!("packages/{name}.sfp"));
        std::fs::write(path, content).expect("a file");
    }

    let _robot = start(&robot);
    robot.wait_until(|events| events.contains("run_started"));
    let address = format!("tcp/127.0.0.1:{port}");
    let fetch = |component: &str, trusted: &str| {
        let options = [
            "--from",
            "R2",
            "--connect",
            &address,
            "--trust",
            trusted,
            "--into",
            "taken",
        ];
        package(folder, &[&["fetch", component][..], &options].concat())
    };
    for (component, trusted, words) in [
        ("tampered", "signing.trusted", "library was tampered with"),
        ("short", "signing.trusted", "cut short"),
        ("relay", "other.trusted", "no key that this robot trusts"),
        ("nothing", "signing.trusted", "gives away no package"),
    ] {
        is_refused(folder, &fetch(component, trusted), words);
    }
    let taken = fetch("relay", "signing.trusted");
    assert_eq!(taken.code, Some(0), "{taken}");
    let library = std::fs::read(folder.join("taken/librelay.so")).expect("the library");
    let original = std::fs::read(artifacts().join("librelay.so")).expect("the original");
    assert!(library == original, "the library has changed on its way");
    let profile_taken = std::fs::read(folder.join("taken/relay.xml")).expect("the profile");
    assert_eq!(profile_taken, std::fs::read(profile).expect("the original"));
}
