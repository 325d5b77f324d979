//! Recovery: in place, by checkpoints, by secondaries; what had been sent and what was in work; and
//! where the ladder ends.

mod data;
mod ending;
mod ladder;
mod real_time;
mod standby;

use tests::{Application, Member, Outcome};

/// A rule that resets with a checkpoint every 20 ms.
const WITH_BACKUP: &str = "<severity>reset</severity>\
                           <resurrect><reset>true</reset><backup>20</backup></resurrect>";

/// An error that the diary returns in its cycle of this number.
fn error_return(at_cycle: u32) -> String {
    format!("<inject at_cycle='{at_cycle}' component='diary' fault='error_return' code='503'/>")
}

/// Its own callbacks, without what every cycle has.
fn diary(outcome: &Outcome) -> Vec<String> {
    let mut logs = outcome.logs("diary");
    logs.retain(|line| line != "onUpdated" && !line.starts_with("onPeriodChanged"));
    logs
}

/// The instance lives: it is called in the order of the life cycle, and works at once.
#[test]
fn an_instance_that_lives_is_reset_in_place() {
    let outcome = Application::new()
        .with(&Member::new("diary", "diary").property("remembers", "true"))
        .rules(&format!(
            "<component name='diary'>{WITH_BACKUP}</component>"
        ))
        .injections(&error_return(4))
        .simulate("50ms")
        .ended_well();
    assert_eq!(
        diary(&outcome),
        [
            "onInitialize",
            "onStart",
            "onExecute at 0 ms",
            "onExecute at 10 ms",
            "onExecute at 20 ms",
            "onError",
            "onReset",
            "onInitialize",
            "onRecover after 3 cycles",
            "onStart",
            "onExecute at 30 ms",
            "onExecute at 40 ms",
            "onStop",
            "onDestroy",
        ]
    );
    assert_eq!(
        outcome.states("diary"),
        [
            "READY",
            "ACTIVE",
            "ERROR",
            "READY",
            "ACTIVE",
            "INACTIVE",
            "DESTROYED"
        ]
    );
    assert_eq!(outcome.actions(), ["reset diary: done"]);
    assert_eq!(outcome.notes(), ["checkpoint 2 restored"]);
    assert_eq!(outcome.component("diary")["incarnation"], 2);
}

/// A crash: nothing of the old instance is called again, a fresh one comes up in the same order.
#[test]
fn an_instance_that_crashed_is_succeeded_by_a_fresh_one() {
    let outcome = Application::new()
        .with(&Member::new("diary", "diary").property("remembers", "true"))
        .rules(&format!(
            "<component name='diary'>{WITH_BACKUP}</component>"
        ))
        .injections("<inject at_cycle='4' component='diary' fault='segfault'/>")
        .simulate("50ms")
        .ended_well();
    assert_eq!(
        diary(&outcome),
        [
            "onInitialize",
            "onStart",
            "onExecute at 0 ms",
            "onExecute at 10 ms",
            "onExecute at 20 ms",
            "onInitialize",
            "onRecover after 3 cycles",
            "onStart",
            "onExecute at 30 ms",
            "onExecute at 40 ms",
            "onStop",
            "onDestroy",
        ]
    );
    let notes = outcome.notes();
    assert_eq!(notes, ["by a fresh instance, checkpoint 2 restored"]);
}

/// Without a checkpoint nothing is recovered, and the component is told nothing of it.
#[test]
fn without_a_backup_it_begins_anew() {
    let outcome = Application::new()
        .with(&Member::new("diary", "diary").property("remembers", "true"))
        .injections(&error_return(3))
        .simulate("30ms")
        .ended_well();
    assert_eq!(
        diary(&outcome)[4..9],
        [
            "onError",
            "onReset",
            "onInitialize",
            "onStart",
            "onExecute at 20 ms"
        ]
    );
}

/// The application comes up without it, and it is recovered as soon as the others run.
#[test]
fn what_failed_while_it_was_brought_up_is_recovered() {
    for callback in ["onInitialize", "onStart"] {
        let outcome = Application::new()
            .with(&Member::new("counter", "counter"))
            .with(&Member::new("recorder", "recorder"))
            .connect("data", "counter.output", "recorder.input")
            .injections(&format!(
                "<inject component='counter' callback='{callback}' fault='segfault'/>"
            ))
            .simulate("1s")
            .ended_well();
        let expected = [("segfault".to_owned(), callback.to_owned())];
        assert_eq!(outcome.faults("counter"), expected);
        assert_eq!(outcome.actions(), ["reset counter: done"], "{callback}");
        assert_eq!(outcome.component("counter")["incarnation"], 2, "{callback}");
        assert_eq!(
            outcome.component("counter")["state"],
            "ACTIVE",
            "{callback}"
        );
        assert!(outcome.cycles("counter") >= 99, "{callback}");
        assert_eq!(outcome.application()["state"], "ACTIVE", "{callback}");
    }
}

/// The state that was copied after the data had gone wrong is not brought back: the checkpoint is
/// older than the first symptom. The numbers go on from there.
#[test]
fn a_contaminated_state_is_not_restored() {
    let outcome = Application::new()
        .with(&Member::new("counter", "counter").property("remembers", "true"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .connect("data", "counter.output", "recorder.input")
        .rules(
            "<component name='counter'>\
             <port name='output'><validity field='value'><min>0</min>\
             <confirm count='4' within='1s'/></validity></port>\
             <severity>reset</severity>\
             <resurrect><reset>true</reset><backup>10</backup></resurrect></component>",
        )
        .injections(
            "<inject at_cycle='11' component='counter' port='output' field='value' \
             fault='out_of_range' value='-1' for='35ms'/>",
        )
        .simulate("200ms")
        .ended_well();
    assert_eq!(outcome.actions(), ["reset counter: done"]);
    let verdict = outcome.verdicts()[0];
    assert_eq!(verdict["first_symptom_ns"], 100_000_000_u64);
    assert_eq!(verdict["confirmed_ns"], 130_000_000_u64);
    // Ten numbers were good; those of the bad cycles come again, from the next cycle on. The last bad
    // datum of the old incarnation is not delivered any more.
    assert_eq!(outcome.notes(), ["checkpoint 10 restored"]);
    let received = outcome.logs("recorder").join(" ");
    let expected = "got 10=10 got 11=-1 got 12=-1 got 13=-1 got 11=11 got 12=12 got 13=13";
    assert!(received.contains(expected), "{received}");
}
