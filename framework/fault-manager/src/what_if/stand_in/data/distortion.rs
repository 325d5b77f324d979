//! What comes of a datum on its way through a port whose data are distorted.

use std::collections::VecDeque;
use std::time::Duration;

use system_model::injection::Distortion;

use super::Datum;

/// What comes of a datum: nothing, one, or two. `delayed` are those that wait, with their times.
pub(super) fn distort(
    datum: Datum,
    distortion: Option<Distortion>,
    now: Duration,
    delayed: &mut VecDeque<(Duration, Datum)>,
) -> Vec<Datum> {
    let Some(distortion) = distortion else {
        return vec![datum];
    };
    let far = Datum { far: true, ..datum };
    let same = Datum {
        same: true,
        ..datum
    };
    match distortion {
        Distortion::OutOfRange(_) => vec![Datum { same: true, ..far }],
        Distortion::NotANumber => vec![Datum {
            no_number: true,
            ..same
        }],
        Distortion::Stuck => vec![same],
        Distortion::Offset(_) => vec![far],
        Distortion::Drift(_) | Distortion::Noise(_) => vec![Datum { wild: true, ..far }],
        Distortion::Drop => Vec::new(),
        // The second one tells nothing new, and nobody takes that for a standstill.
        Distortion::Duplicate => vec![datum, datum],
        Distortion::Delay(delay) => {
            let late = Datum {
                late: true,
                ..datum
            };
            delayed.push_back((now.saturating_add(delay), late));
            let mut due = Vec::new();
            while delayed.front().is_some_and(|(at, _)| *at <= now) {
                due.extend(delayed.pop_front().map(|(_, datum)| datum));
            }
            due
        }
    }
}
