//! Components that share a process.

use std::collections::BTreeSet;

use rustix::process::Signal;
use tests::{Application, Member, Watched};

use super::{healthy, healthy_missed_nothing, recovered};

/// Two in one process, and the healthy chain guarded.
fn application() -> Application {
    let group = |name: &str| {
        format!(
            "<component name='{name}'><isolation group='twins'>process</isolation>\
             </component>"
        )
    };
    healthy()
        .with(&Member::new("first", "counter"))
        .with(&Member::new("second", "diary"))
        .rules(&["first", "second"].map(group).concat())
}

fn hosts(run: &Watched) -> BTreeSet<i32> {
    let hosts = run.hosts().into_iter();
    hosts.map(|host| host.id()).collect()
}

fn hosts_of(run: &Watched, component: &str) -> BTreeSet<i32> {
    let hosts = run.hosts().into_iter();
    let own = hosts.filter(|host| host.runs(component));
    own.map(|host| host.id()).collect()
}

#[test]
fn a_group_is_one_process_and_dies_and_comes_back_together() {
    let application = application();
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

/// Both kinds of standby of a group live in a process that is not the group's own.
#[test]
fn who_stands_by_is_not_where_that_is_for_which_it_stands_by() {
    let application = application()
        .with_profile(&Member::new("spare", "counter"))
        .rules(
            "<component name='first'><fault><retry_max>0</retry_max><secondary preload='warm'>\
             <reference>spare.xml</reference></secondary></fault></component>",
        );
    let run = application.start(&[]);
    application.wait_until(|events| events.matches("got ").count() > 5);
    let spare = run.host_of("spare");
    assert!(!hosts_of(&run, "second").is_empty());
    let shared = spare.runs("second") && hosts_of(&run, "second").len() == 1;
    assert!(!shared, "the spare one would die with the group");
    let present = run
        .hosts()
        .into_iter()
        .find(|host| !host.runs("spare") && host.runs("second"));
    let present = present.expect("the group has a process");
    assert!(present.runs("first"), "{present:?}");
    assert!(present.signal(Signal::KILL));
    application
        .wait_until(|events| recovered(events, "first", 1) && recovered(events, "second", 1));
    assert!(!hosts(&run).contains(&present.id()));
    let outcome = application.interrupt(run).ended_well();
    let replaced = "replace first by spare: done".to_owned();
    assert!(
        outcome.actions().contains(&replaced),
        "{:?}",
        outcome.actions()
    );
    let notes = outcome.notes();
    let by_spare = notes
        .iter()
        .filter(|note| note.contains("by a warm standby"));
    assert!(by_spare.count() >= 1, "{notes:?}");
    healthy_missed_nothing(&outcome, "a group died");
}

/// A panic is caught: who else lives in that process does not notice.
#[test]
fn a_panic_of_one_leaves_the_other_of_its_group() {
    let outcome = application()
        .injections("<inject at='500ms' component='first' fault='panic'/>")
        .simulate("1s")
        .ended_well();
    assert_eq!(outcome.actions(), ["reset first: done"]);
    assert_eq!(outcome.component("first")["incarnation"], 2);
    let other = outcome.component("second");
    assert_eq!(other["faults"], 0, "{other}");
    assert_eq!(other["cycles"], 100, "{other}");
    assert_eq!(other["isolation"], "process", "{other}");
    healthy_missed_nothing(&outcome, "a panic in a group");
}
