//! The bar of one component: states over time, no more of them than can be seen.

use super::super::amounts::{at, seconds};
use super::super::model::StateChange;
use super::super::scale::Scale;

/// A state that is drawn is at least so wide that it is seen, in pixels.
const LEAST_WIDTH: f64 = 2.0;

/// A part of the bar.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Span {
    pub(super) x: f64,
    pub(super) width: f64,
    /// Class: the name of the state, if there is such a state.
    pub(super) state: &'static str,
    /// In words.
    pub(super) what: String,
}

/// States that have a colour.
const STATES: [&str; 6] = [
    "CREATED",
    "READY",
    "ACTIVE",
    "INACTIVE",
    "ERROR",
    "DESTROYED",
];

/// The colour of a state; of what a tree or a node of one has come to, that of a component that is
/// about as far. A node that is idle has none.
fn class(state: &str) -> Option<&'static str> {
    Some(match state {
        "IDLE" | "SKIPPED" | "WAITING" => return None,
        "RUNNING" => "ACTIVE",
        "SUCCESS" => "READY",
        "FAILURE" | "STOPPED" => "INACTIVE",
        "FAILED" => "ERROR",
        other => STATES
            .into_iter()
            .find(|it| *it == other)
            .unwrap_or("other"),
    })
}

/// The bar. What is narrower than a pixel is seen in what is beside it, but an error always.
pub(super) fn spans(changes: &[StateChange], end_ns: u64, time: &Scale) -> Vec<Span> {
    let ends = changes.iter().skip(1).map(|next| next.t_ns).chain([end_ns]);
    let mut spans: Vec<Span> = Vec::new();
    for (change, until_ns) in changes.iter().zip(ends) {
        let x = time.place(seconds(change.t_ns));
        let width = time.place(seconds(until_ns)) - x;
        let is_error = change.to == "ERROR";
        let hides = |last: &Span| last.state == "ERROR" && x < last.x + LEAST_WIDTH;
        if is_error && spans.last().is_some_and(hides) {
            continue;
        }
        if width < 1.0 && !is_error {
            continue;
        }
        let instance = match change.incarnation {
            // Of a tree, or a node of one.
            0 => String::new(),
            number => format!(" (incarnation {number})"),
        };
        let Some(state) = class(&change.to) else {
            continue;
        };
        spans.push(Span {
            x,
            width: width.max(LEAST_WIDTH),
            state,
            what: format!(
                "{}{instance} from {} to {}",
                change.to,
                at(change.t_ns),
                at(until_ns)
            ),
        });
    }
    // An error lies over what follows it, or that would hide it.
    spans.sort_by_key(|span| span.state == "ERROR");
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(changes: &[(u64, &str)]) -> Vec<(&'static str, f64, f64)> {
        let changes: Vec<StateChange> = (changes.iter())
            .map(|(t_ms, to)| StateChange {
                t_ns: t_ms * 1_000_000,
                from: String::new(),
                to: (*to).to_owned(),
                incarnation: 1,
            })
            .collect();
        // A pixel is ten milliseconds.
        let time = Scale::new([0.0, 10.0], [0.0, 1000.0]);
        let spans = spans(&changes, 10_000_000_000, &time);
        spans
            .into_iter()
            .map(|it| (it.state, it.x.round(), it.width.round()))
            .collect()
    }

    #[test]
    fn states_follow_each_other() {
        for (changes, expected) in [
            (&[][..], &[][..]),
            (&[(0, "ACTIVE")], &[("ACTIVE", 0.0, 1000.0)]),
            (
                &[
                    (0, "READY"),
                    (0, "ACTIVE"),
                    (3000, "ERROR"),
                    (3000, "READY"),
                    (3000, "ACTIVE"),
                ],
                &[
                    ("ACTIVE", 0.0, 300.0),
                    ("ACTIVE", 300.0, 700.0),
                    ("ERROR", 300.0, 2.0),
                ],
            ),
            (
                &[(0, "ACTIVE"), (5000, "ASLEEP")],
                &[("ACTIVE", 0.0, 500.0), ("other", 500.0, 500.0)],
            ),
        ] {
            assert_eq!(bar(changes), expected, "{changes:?}");
        }
    }

    #[test]
    fn no_more_are_drawn_than_can_be_seen() {
        let changes = (0..20_000).map(|at| (at / 2, if at % 2 == 0 { "ERROR" } else { "ACTIVE" }));
        let changes: Vec<(u64, &str)> = changes.collect();
        let drawn = bar(&changes).len();
        assert!((100..=1000).contains(&drawn), "{drawn}");
    }
}
