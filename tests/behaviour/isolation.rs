//! Components in processes of their own: what dies there, dies alone.

mod bounds;
mod chance;
mod critical;
mod faults;
mod groups;
mod heap;
mod outside;
mod residue;
mod sabotage;

use tests::{Application, Member, Outcome};

/// A healthy chain: each number that is counted is received.
fn healthy() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .connect("data", "counter.output", "recorder.input")
}

/// The healthy chain ran on and lost nothing.
#[track_caller]
fn healthy_missed_nothing(outcome: &Outcome, context: &str) {
    for healthy in ["counter", "recorder"] {
        let component = outcome.component(healthy);
        assert_eq!(component["state"], "ACTIVE", "{context}: {component}");
        assert_eq!(component["faults"], 0, "{context}: {component}");
    }
    let logs = outcome.logs("recorder");
    let last = logs.last().map(String::as_str).unwrap_or_default();
    assert!(last.ends_with("gaps 0"), "{context}: {last}");
}

/// Whether so many faults of this component are on record, and the healthy chain has gone on for a
/// while since it was recovered from the last of them.
fn recovered(events: &str, component: &str, faults: usize) -> bool {
    let line = |event: &str| format!("\"event\":\"{event}\",\"component\":\"{component}\"");
    let (fault, state) = (line("fault"), line("state"));
    let Some((last, _)) = events.match_indices(&fault).nth(faults - 1) else {
        return false;
    };
    let since = &events[last..];
    let works = format!("{state},\"from\":\"READY\",\"to\":\"ACTIVE\"");
    since
        .find(&works)
        .is_some_and(|again| since[again..].matches("got ").count() > 20)
}
