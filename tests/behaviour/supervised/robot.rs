//! The reference robot under a parent: its world outlives the container.

use std::path::PathBuf;

use rustix::process::{Pid, Signal};
use tests::{Application, Supervised, Watched, repository, take_turn, until};

use super::{LIMIT, PATIENT};

fn start(application: &Application, arguments: &[&str]) -> Watched {
    let profile = repository().join("profiles/applications/target_following.xml");
    // A seed whose target is near, so that the test takes half a minute.
    let supervised = ["--supervised", "--supervision-timeout", PATIENT];
    let seed = ["--seed", "17", "--for", "110s"];
    let all = [&supervised[..], &seed, arguments].concat();
    application.start_files(&[profile], &all)
}

/// Waits until the robot has been driven for a while by a container.
fn wait_until_driving(application: &Application) {
    let operator = application.operator();
    operator.socket();
    let cycles = || operator.status()["components"]["path_planner"]["cycles"].as_u64();
    assert!(until(LIMIT, || cycles() > Some(75)), "it does not drive");
}

/// A run whose robot drives, with its container and its world.
fn drive(application: &Application, arguments: &[&str]) -> (Watched, Pid, Pid) {
    let run = start(application, arguments);
    wait_until_driving(application);
    let processes = Supervised::by(&run);
    let (container, world) = (processes.container(None), processes.world());
    (run, container, world)
}

fn picture(application: &Application) -> PathBuf {
    application.folder().join("drive.svg")
}

/// What the planner knows outlives the container.
const PERSISTED: &str = "<fault_rules application='target_following'>\
    <component name='path_planner'>\
    <resurrect><reset>true</reset><backup persist='true'>80</backup></resurrect>\
    </component></fault_rules>";

#[test]
fn it_reaches_its_target_although_its_container_was_killed() {
    let _turn = take_turn();
    let application = Application::new();
    let path = picture(&application);
    let rules = application.write("persisted.xml", PERSISTED);
    let arguments = ["--picture", "--rules"].into_iter().zip([&path, &rules]);
    let arguments =
        arguments.flat_map(|(option, file)| [option.to_owned(), file.display().to_string()]);
    let arguments: Vec<String> = arguments.collect();
    let fresh = ["--fresh"].into_iter();
    let arguments: Vec<&str> = fresh.chain(arguments.iter().map(String::as_str)).collect();
    let (run, container, world) = drive(&application, &arguments);
    Supervised::signal(container, Signal::KILL);
    let outcome = application.outcome(run.wait(2 * LIMIT)).ended_well();
    let summary = outcome.summary();
    assert_eq!(summary["restarts"], 1, "{summary}");
    let robot = &summary["robot"];
    assert_eq!(robot["reached"], true, "{robot}");
    assert_eq!(robot["collisions"], 0, "{robot}");
    let restored = outcome.events("checkpoint_restored", "path_planner");
    assert_eq!(restored.len(), 1, "its checkpointed state came back");
    assert_eq!(restored[0]["incarnation"], 2, "{}", restored[0]);
    let drive = std::fs::read_to_string(path).expect("a picture");
    assert!(drive.contains("<svg"));
    Supervised::assert_ends(world);
}

#[test]
fn nothing_is_left_of_a_parent_that_was_killed() {
    let _turn = take_turn();
    let application = Application::new();
    let (run, container, world) = drive(&application, &[]);
    run.signal(Signal::KILL);
    Supervised::assert_ends(container);
    Supervised::assert_ends(world);
}

#[test]
fn a_world_that_dies_ends_the_run() {
    let _turn = take_turn();
    let application = Application::new();
    let (run, container, world) = drive(&application, &[]);
    Supervised::signal(world, Signal::KILL);
    let finished = run.wait(LIMIT);
    assert_eq!(finished.code, Some(6), "{finished}");
    assert!(finished.stderr.contains("simulated world"), "{finished}");
    Supervised::assert_ends(container);
}
