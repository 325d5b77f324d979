//! A simulated world that outlives the containers that drive in it.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::os::fd::AsFd as _;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use container::descriptor_line::DescriptorLine;
use container::world::{RemoteWorld, STANDS, World, serve};
use robot_interface::serial_line::{Message, MotionCommand, encode};
use robot_simulation::{Fault, Simulation};
use system_profile::load_world;

/// What a busy machine gets.
const LIMIT: Duration = Duration::from_secs(30);

/// As often as the main board of a robot commands.
const COMMAND_PERIOD: Duration = Duration::from_millis(20);

/// A robot that stands trembles less than this in the time between two looks; one that drives comes
/// farther by more than ten times as much.
const STANDSTILL_M: f64 = 0.001;

/// The parent's view of a world; here it is a thread.
struct Parent {
    line: DescriptorLine,
    world: JoinHandle<std::io::Result<()>>,
}

impl Parent {
    fn new() -> Self {
        let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
        let file = root.join("../../profiles/worlds/target_arena.xml");
        let world = load_world(&file).world.expect("a sound world");
        let simulation = Simulation::new(&world, 1).expect("an arena");
        let (here, there) = UnixStream::pair().expect("a line");
        let world = std::thread::spawn(move || serve(simulation, there));
        let mut word = [0];
        (&here).read_exact(&mut word).expect("it says something");
        assert_eq!(word, [STANDS]);
        Self {
            line: DescriptorLine::new(here, LIMIT).expect("a line"),
            world,
        }
    }

    /// The world as the next container sees it.
    fn connect(&mut self) -> World {
        let (container, world) = UnixStream::pair().expect("a line");
        self.line.send(&(), Some(world.as_fd())).expect("it reads");
        drop(world);
        World::remote(RemoteWorld::new(container).expect("it answers"))
    }

    fn end(self) {
        drop(self.line);
        let ended = self.world.join().expect("it does not panic");
        ended.expect("its parent has ended it");
    }
}

/// Commands the wheels over the motion board's line until the robot has come so far.
fn drive(world: &World, to_m: f64) {
    let (line, path) = world.open("motion_board").expect("the board is there");
    assert!(path.is_some_and(|path| path.starts_with("/dev/pts")));
    let mut line = File::from(line);
    let ahead = encode(&Message::Command(MotionCommand::from_wheel_rpm(40.0, 40.0)));
    let start = Instant::now();
    while world.summary().path_length_m < to_m {
        assert!(start.elapsed() < LIMIT, "it does not move");
        line.write_all(&ahead).expect("the line takes commands");
        std::thread::sleep(COMMAND_PERIOD);
    }
}

#[test]
fn a_robot_whose_container_died_stops_and_stays_where_it_is() {
    let mut parent = Parent::new();
    let first = parent.connect();
    drive(&first, 0.1);
    drop(first);
    let second = parent.connect();
    let start = Instant::now();
    let mut before_m = f64::NEG_INFINITY;
    // Nothing moves it for longer than its board waits for commands.
    loop {
        let now_m = second.summary().path_length_m;
        if now_m - before_m < STANDSTILL_M {
            break;
        }
        assert!(start.elapsed() < LIMIT, "it does not stop: {now_m} m");
        before_m = now_m;
        std::thread::sleep(Duration::from_millis(300));
    }
    assert!(before_m >= 0.1, "it is where it came to");
    drive(&second, before_m + 0.05);
    parent.end();
}

/// What the README tells the parent to write to a motion board is what the board takes for a stop.
#[test]
fn the_safe_state_of_the_readme_is_a_stop() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let readme = std::fs::read_to_string(root.join("../../README.md")).expect("the README");
    let bytes = readme.split_once("<safe_state device=\"/dev/ttyUSB0\" bytes=\"");
    let bytes = bytes.and_then(|(_, rest)| rest.split_once('"'));
    let (bytes, _) = bytes.expect("the README has a safe state");
    let stop = encode(&Message::Command(MotionCommand::stop()));
    let written: Vec<String> = stop.iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(bytes, written.join(" "));
}

#[test]
fn a_container_sees_the_world_as_if_it_were_its_own() {
    let mut parent = Parent::new();
    let world = parent.connect();
    assert!(world.picture().expect("a picture").contains("<svg"));
    let (_camera, path) = world.open("camera").expect("the camera is there");
    assert_eq!(path, None, "it has no serial line");
    let error = world.open("arm").expect_err("there is no arm");
    assert!(error.to_string().contains("no device 'arm'"), "{error}");
    world.set_fault(Fault::UnplugSonar(0), true);
    world.set_fault(Fault::UnplugSonar(0), false);
    let summary = world.summary();
    assert!(!summary.reached && summary.distance_to_target_m > 0.0);
    assert!(!world.has_reached_target());
    parent.end();
    assert_eq!(world.summary().path_length_m, summary.path_length_m);
    assert!(world.picture().is_err(), "it is gone");
}
