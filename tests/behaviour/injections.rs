//! Every fault that can be injected is detected, judged and handled by a rule; what happens without
//! any rule is as sensible as can be. A leak is seen by a rule about memory alone: see `memory`.

mod callbacks;
mod data;
mod robot;

use serde_json::Value;
use tests::{Application, Member};

/// Cycles in a second of simulated time at 10 ms.
const CYCLES: u64 = 100;

/// A source of numbers (1, 2, 3, ... with values 1, 2, 3, ..., every 10 ms) and their reader.
fn application() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .with(&Member::new("diary", "diary"))
        .connect("data", "counter.output", "recorder.input")
}

fn word(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

/// What fails in the container's own handling: the next rung of the ladder is taken.
#[test]
fn in_the_handling_itself_climb_the_ladder() {
    let rules = "<component name='counter'><severity>reset</severity>\
                 <resurrect><reset>true</reset><backup>20</backup></resurrect>\
                 <fault window='10s'><retry_max>2</retry_max><severity>ignore</severity></fault>\
                 </component>";
    let crash = "<inject at='500ms' component='counter' fault='segfault'/>";
    for (failure, actions, note) in [
        (
            "<inject at='400ms' component='counter' fault='library_missing'/>",
            &["reset counter: failed", "reset counter: done"][..],
            "is missing (injected)",
        ),
        (
            "<inject at='400ms' component='counter' fault='recovery_fails'/>",
            &["reset counter: failed", "reset counter: done"],
            "injected failure of the recovery",
        ),
        (
            "<inject at='400ms' component='counter' fault='checkpoint_corrupt'/>",
            &["reset counter: done"],
            "wrong checksum",
        ),
    ] {
        let outcome = Application::new()
            .with(&Member::new("counter", "counter").property("remembers", "true"))
            .with(&Member::new("recorder", "recorder"))
            .connect("data", "counter.output", "recorder.input")
            .rules(rules)
            .injections(failure)
            .injections(crash)
            .simulate("1s")
            .ended_well();
        assert_eq!(outcome.actions(), actions, "{failure}");
        let notes = outcome.notes();
        assert!(notes[0].contains(note), "{failure}: {notes:?}");
        assert_eq!(outcome.component("counter")["state"], "ACTIVE", "{failure}");
    }
}

/// Without a rule about memory the component goes on, and so does everything else.
#[test]
fn a_leak_changes_nothing_without_a_rule() {
    let outcome = application()
        .injections("<inject component='counter' fault='leak' bytes='4096'/>")
        .simulate("1s")
        .ended_well();
    assert!(outcome.verdicts().is_empty());
    assert_eq!(outcome.cycles("counter"), CYCLES);
    assert_eq!(
        outcome.logs("recorder").last().map(String::as_str),
        Some("received 100, last 100, gaps 0")
    );
}
