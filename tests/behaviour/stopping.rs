//! Stopping: in order, within a deadline, whatever a component does.

use std::process::Command;
use std::time::Duration;

use rustix::process::Signal;
use tests::{Application, Finished, Member, Watched, artifacts, until};

/// The container promises three seconds; a busy machine gets more.
const STOP_LIMIT: Duration = Duration::from_secs(30);

/// Until the application runs.
const START_LIMIT: Duration = Duration::from_secs(60);

/// Starts an application, waits until `sign` is in the events, and interrupts it.
fn interrupted(
    application: &Application,
    arguments: &[&str],
    sign: &str,
    signal: Signal,
) -> Finished {
    let child = application.start(arguments);
    let events = application.events_file();
    let runs = until(START_LIMIT, || {
        std::fs::read_to_string(&events).is_ok_and(|text| text.contains(sign))
    });
    assert!(runs, "'{sign}' is not in {}", events.display());
    child.signal(signal);
    child.wait(STOP_LIMIT)
}

#[test]
fn by_a_signal_in_order() {
    for clock in ["real", "simulated"] {
        for signal in [Signal::INT, Signal::TERM] {
            let application = Application::new()
                .with(&Member::new("first", "diary").period(200))
                .with(&Member::new("second", "diary").period(200));
            let arguments = ["--clock", clock];
            let finished = interrupted(&application, &arguments, "onExecute", signal);
            let outcome = application.outcome(finished).ended_well();
            assert_eq!(outcome.application()["ended_by"], "stopped", "{clock}");
            let last: Vec<String> = outcome
                .all_events()
                .iter()
                .filter(|event| event["to"] == "INACTIVE" || event["to"] == "DESTROYED")
                .map(|event| format!("{} {}", event["component"], event["to"]).replace('"', ""))
                .collect();
            assert_eq!(
                last,
                [
                    "second INACTIVE",
                    "first INACTIVE",
                    "second DESTROYED",
                    "first DESTROYED"
                ]
            );
        }
    }
}

/// A component that does not return is left behind; the process ends all the same and says so.
#[test]
fn although_a_component_hangs() {
    for callback in ["onExecute", "onStop"] {
        let application = Application::new()
            .with(&Member::new("diary", "diary").period(200))
            .with(
                &Member::new("hangs", "hangs")
                    .property("callback", callback)
                    .property("at_cycle", "1"),
            );
        let finished = interrupted(&application, &[], "onExecute", Signal::INT);
        let outcome = application.outcome(finished).ended_well();
        assert!(outcome.raw_events().contains("left behind"), "{callback}");
    }
}

/// After components have crashed in every way.
#[test]
fn after_faults() {
    let mut application = Application::new().with(&Member::new("diary", "diary"));
    for misbehaviour in [
        "panics",
        "writes_null",
        "aborts",
        "overflows_stack",
        "crashes_in_libc",
    ] {
        application = application.with(&Member::new(misbehaviour, misbehaviour));
    }
    let finished = interrupted(&application, &[], "\"thread_lost\":true", Signal::INT);
    let outcome = application.outcome(finished).ended_well();
    assert_eq!(outcome.application()["state"], "DEGRADED");
    assert_eq!(
        outcome.states("diary"),
        ["READY", "ACTIVE", "INACTIVE", "DESTROYED"]
    );
}

/// The container's own end is not taken for a component's.
#[test]
fn a_signal_from_outside_ends_the_container() {
    let application = Application::new().with(&Member::new("diary", "diary").period(1));
    let finished = interrupted(&application, &[], "onExecute", Signal::SEGV);
    assert_eq!(finished.code, None, "{finished}");
}

#[test]
fn wrong_arguments_are_explained() {
    for arguments in [
        ["run", "application.xml", "--for", "soon"],
        ["run", "application.xml", "--clock", "moon"],
        ["walk", "application.xml", "--for", "1s"],
    ] {
        let mut command = Command::new(artifacts().join("steadfast"));
        let finished = Watched::spawn(command.args(arguments)).wait(STOP_LIMIT);
        assert_eq!(finished.code, Some(2), "{finished}");
        assert!(finished.stderr.contains("error"), "{finished}");
    }
}
