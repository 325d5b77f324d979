//! Standbys of a component itself: how ready they are, that they are there again, and that nobody
//! downstream misses anything.

use tests::{Application, Member, Outcome};

/// A counter that remembers, with a standby, and behind it, in the same executor, a recorder that is
/// told every number.
fn counting(standby: &str, injections: &str, period_ms: u64) -> Application {
    let rules = format!(
        "<component name='counter'>{standby}\
         <resurrect><reset>true</reset><backup>{period_ms}</backup></resurrect>\
         <fault window='50ms'><retry_max>100</retry_max></fault></component>"
    );
    let counter = Member::new("counter", "counter").property("remembers", "true");
    let recorder = Member::new("recorder", "recorder");
    Application::new()
        .with(&counter.kind("periodic-shared").period(period_ms))
        .with(&recorder.kind("periodic-shared").period(period_ms))
        .connect("data", "counter.output", "recorder.input")
        .rules(&rules)
        .injections(injections)
}

#[test]
fn a_reset_of_an_instance_that_crashed_is_done_by_its_standby() {
    for (standby, by) in [
        ("", "by a fresh instance"),
        ("<standby preload='cold'/>", "by a fresh instance"),
        ("<standby preload='loaded'/>", "by a loaded standby"),
        ("<standby preload='warm'/>", "by a warm standby"),
    ] {
        let crashes = "<inject at='100ms' repeat='3' every='100ms' component='counter' \
                       fault='segfault'/>";
        let outcome = counting(standby, crashes, 10)
            .simulate("500ms")
            .ended_well();
        assert_eq!(outcome.actions(), ["reset counter: done"; 3], "{standby}");
        let expected = [10, 20, 30].map(|number| format!("{by}, checkpoint {number} restored"));
        assert_eq!(outcome.notes(), expected, "{standby}");
        let told = ["received 50, last 50, gaps 0"];
        assert_eq!(outcome.logs("recorder"), told, "{standby}");
    }
}

/// What it holds it need not open again.
#[test]
fn an_instance_that_can_be_called_is_reset_in_place_nevertheless() {
    let error = "<inject at='100ms' component='counter' fault='error_return' code='503'/>";
    let outcome = counting("<standby preload='warm'/>", error, 10)
        .simulate("200ms")
        .ended_well();
    assert_eq!(outcome.actions(), ["reset counter: done"]);
    assert_eq!(outcome.notes(), ["checkpoint 10 restored"]);
}

/// It crashes in its first cycle: there is no second one yet, so that is made at once.
#[test]
fn a_fault_before_there_is_another_standby_is_recovered_all_the_same() {
    let crashes = "<inject at='100ms' for='1ms' component='counter' fault='panic'/>";
    let outcome = counting("<standby preload='warm'/>", crashes, 10)
        .simulate("200ms")
        .ended_well();
    let actions = outcome.actions();
    assert_eq!(actions, ["reset counter: failed", "reset counter: done"]);
    assert_eq!(outcome.component("counter")["state"], "ACTIVE");
}

/// The successor does what its predecessor failed to do before those behind it look, a hundred
/// times: each of them gets the datum of every period, at 1 kHz, and each callback comes once in a
/// cycle.
#[test]
fn downstream_gets_every_period_s_datum() {
    const CRASHES: u64 = 100;
    let crashes = format!(
        "<inject at_cycle='20' repeat='{CRASHES}' every_cycles='7' component='counter' \
         fault='segfault'/>"
    );
    let application = counting("<standby preload='warm'/>", &crashes, 1);
    let outcome = application.simulate("1s").ended_well();
    assert_eq!(outcome.actions(), ["reset counter: done"; 100]);
    let by_standby = |note: &String| note.starts_with("by a warm standby");
    assert!(outcome.notes().iter().all(by_standby));
    assert_eq!(outcome.component("counter")["incarnation"], CRASHES + 1);
    assert_eq!(outcome.cycles("counter"), 1000);
    let told = ["received 1000, last 1000, gaps 0"];
    assert_eq!(outcome.logs("recorder"), told);
}

/// One of a shared executor: after its recovery it is updated with the others, not before.
#[test]
fn a_successor_is_updated_once_in_a_cycle() {
    let diary = Member::new("diary", "diary").kind("periodic-shared");
    let other = Member::new("other", "diary").kind("periodic-shared");
    let crash = "<inject at_cycle='3' component='diary' fault='segfault'/>";
    let outcome = Application::new()
        .with(&diary)
        .with(&other)
        .injections(crash)
        .simulate("50ms")
        .ended_well();
    for name in ["diary", "other"] {
        let logs = outcome.logs(name);
        let updates = logs.iter().filter(|line| *line == "onUpdated").count();
        assert_eq!(updates, 5, "{name}: {logs:?}");
    }
}

/// By the machine's clock: how many data come does not depend on how fast it is.
#[test]
fn in_real_time_no_number_is_missing_either() {
    const CRASHES: usize = 30;
    let crashes = format!(
        "<inject at_cycle='20' repeat='{CRASHES}' every_cycles='9' component='counter' \
         fault='segfault'/>"
    );
    let application = counting("<standby preload='warm'/>", &crashes, 10);
    let outcome = application
        .run_until(|events| events.matches("\"to\":\"ERROR\"").count() == CRASHES)
        .ended_well();
    let done = outcome.actions();
    let resets = done
        .iter()
        .filter(|action| *action == "reset counter: done");
    assert!(resets.count() >= CRASHES - 1, "{done:?}");
    // A cycle of a busy machine may come too soon after another for a checkpoint: then its number
    // comes again.
    let (received, last) = received_and_last(&outcome);
    assert!(received >= last, "{received} of {last}");
    let standbys = outcome.notes();
    let standbys = standbys
        .iter()
        .filter(|note| note.starts_with("by a warm standby"));
    assert!(standbys.count() > 0, "{:?}", outcome.notes());
}

/// How many numbers the recorder got, and the last of them.
fn received_and_last(outcome: &Outcome) -> (u64, u64) {
    let told = outcome.logs("recorder").concat();
    let number = |before: &str| -> u64 {
        let text = told.split(before).nth(1).unwrap_or_default();
        let text = text.split([',', ' ']).next().unwrap_or_default();
        text.parse().expect("a number")
    };
    (number("received "), number("last "))
}
