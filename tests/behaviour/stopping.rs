//! Stopping: in order, within a deadline, whatever a component does.

use std::process::Command;
use std::time::Duration;

use rustix::process::Signal;
use tests::{Application, Member, Watched, artifacts};

/// Saying no takes milliseconds.
const REFUSAL_LIMIT: Duration = Duration::from_secs(30);

#[test]
fn by_a_signal_in_order() {
    for clock in ["real", "simulated"] {
        for signal in [Signal::INT, Signal::TERM] {
            let application = Application::new()
                .with(&Member::new("first", "diary").period(200))
                .with(&Member::new("second", "diary").period(200));
            let arguments = ["--clock", clock];
            let runs = |events: &str| events.contains("onExecute");
            let outcome = application
                .interrupt_when(&arguments, signal, runs)
                .ended_well();
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

/// After components have crashed in every way.
#[test]
fn after_faults() {
    let misbehaviours = [
        "panics",
        "writes_null",
        "aborts",
        "overflows_stack",
        "crashes_in_libc",
    ];
    let mut application = Application::new()
        .with(&Member::new("diary", "diary"))
        .not_recovered(&misbehaviours);
    for misbehaviour in misbehaviours {
        application = application.with(&Member::new(misbehaviour, misbehaviour));
    }
    let all = |events: &str| events.matches("\"event\":\"fault\"").count() == 5;
    let outcome = application.run_until(all).ended_well();
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
    let runs = |events: &str| events.contains("onExecute");
    let outcome = application.interrupt_when(&[], Signal::SEGV, runs);
    assert_eq!(outcome.finished().code, None, "{}", outcome.finished());
}

#[test]
fn wrong_arguments_are_explained() {
    for arguments in [
        ["run", "application.xml", "--for", "soon"],
        ["run", "application.xml", "--clock", "moon"],
        ["walk", "application.xml", "--for", "1s"],
    ] {
        let mut command = Command::new(artifacts().join("steadfast"));
        let finished = Watched::spawn(command.args(arguments)).wait(REFUSAL_LIMIT);
        assert_eq!(finished.code, Some(64), "{finished}");
        assert!(finished.stderr.contains("error"), "{finished}");
    }
}
