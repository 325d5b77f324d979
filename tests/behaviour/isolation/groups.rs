//! Components that share a process.

use rustix::process::Signal;
use tests::{Application, Member};

use super::{healthy, healthy_missed_nothing, recovered};

/// Two in one process, and the healthy chain guarded; with further rules for the first of the two.
fn application(rules: &str) -> Application {
    let group = |(name, rules): (&str, &str)| {
        format!(
            "<component name='{name}'><isolation group='twins'>process</isolation>{rules}\
             </component>"
        )
    };
    healthy()
        .with(&Member::new("first", "counter"))
        .with(&Member::new("second", "diary"))
        .rules(&[("first", rules), ("second", "")].map(group).concat())
}

#[test]
fn a_group_is_one_process_and_dies_and_comes_back_together() {
    let application = application("");
    let run = application.start(&[]);
    application.wait_until(|events| events.matches("got ").count() > 5);
    let first = run.host_of("first");
    assert!(first.runs("second"), "they share {first:?}");
    assert!(first.signal(Signal::KILL));
    application
        .wait_until(|events| recovered(events, "first", 1) && recovered(events, "second", 1));
    let again = run.host_of("first");
    assert_ne!(first.id(), again.id());
    assert!(again.runs("second"), "they share {again:?}");
    let outcome = application.interrupt(run).ended_well();
    for component in ["first", "second"] {
        let faults = outcome.faults(component);
        assert_eq!(faults.len(), 1, "{component}: {faults:?}");
        assert_eq!(faults[0].0, "host_ended", "{component}");
        assert_eq!(outcome.component(component)["incarnation"], 2);
        assert_eq!(outcome.component(component)["state"], "ACTIVE");
    }
    healthy_missed_nothing(&outcome, "a group died");
}

/// Who stands by lives in a process that is not the group's own, and takes over when that dies.
#[test]
fn who_stands_by_is_not_where_that_is_for_which_it_stands_by() {
    let application = application(
        "<fault><retry_max>0</retry_max><secondary preload='warm'>\
         <reference>spare.xml</reference></secondary></fault>",
    )
    .with_profile(&Member::new("spare", "counter"));
    let run = application.start(&[]);
    application.wait_until(|events| events.matches("got ").count() > 5);
    let hosts = run.hosts();
    let [present, standby] = hosts.as_slice() else {
        panic!("the group has one process, and who stands by another: {hosts:?}");
    };
    assert!(present.runs("first") && present.runs("second"), "{hosts:?}");
    assert!(present.signal(Signal::KILL));
    application
        .wait_until(|events| recovered(events, "first", 1) && recovered(events, "second", 1));
    assert!(!standby.is_gone(), "{standby:?} took over");
    let outcome = application.interrupt(run).ended_well();
    let replaced = "replace first by spare: done".to_owned();
    let actions = outcome.actions();
    assert!(actions.contains(&replaced), "{actions:?}");
    let notes = outcome.notes();
    let by_standby = |note: &String| note.contains("by a warm standby");
    assert!(notes.iter().any(by_standby), "{notes:?}");
    healthy_missed_nothing(&outcome, "a group died");
}

/// A panic is caught: who else lives in that process does not notice.
#[test]
fn a_panic_of_one_leaves_the_other_of_its_group() {
    let outcome = application("")
        .injections("<inject at='500ms' component='first' fault='panic'/>")
        .simulate("1s")
        .ended_well();
    assert_eq!(outcome.actions(), ["reset first: done"]);
    assert_eq!(outcome.component("first")["incarnation"], 2);
    let other = outcome.component("second");
    assert_eq!(other["faults"], 0, "{other}");
    assert_eq!(other["cycles"], 100, "{other}");
    assert_eq!(other["tier"], "process", "{other}");
    healthy_missed_nothing(&outcome, "a panic in a group");
}
