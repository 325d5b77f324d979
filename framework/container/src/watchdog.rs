//! The watchdog: a thread that outranks every component, looks at what each lane is in, and breaks
//! off callbacks that do not return within their limit.
//!
//! A callback's time is that in which it ran or waited for something. Time in which it wanted to
//! run and the machine had no processor for it does not count: an overrun tells of that, and the
//! component is not to blame.

mod record;
mod thread_time;

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::guard::interrupt;
use crate::lane::{Crew, Lane};
use crate::scheduling::outrank_components;

use record::{Record, Verdict};

/// A callback that is to be broken off is tried again after this time, and no look comes sooner
/// after another: two looks cost a few microseconds a lane, which is below 1 % of it.
pub(crate) const TICK: Duration = Duration::from_millis(1);

/// The longest time between looks. It adds to the time in which a hang is found, and is below the
/// deadline of a component that runs every 2 ms and has the default of three periods.
const LONGEST_SLEEP: Duration = Duration::from_millis(4);

/// Watches over a crew's lanes until it is dismissed. Runs on the calling thread.
pub(crate) fn watch_over(crew: &Crew) {
    outrank_components();
    let mut watched = Vec::new();
    let mut known = 0;
    let mut sleep = LONGEST_SLEEP;
    let mut last = Instant::now();
    while !crew.is_dismissed() {
        std::thread::sleep(sleep);
        // Whoever holds the list may have less priority: then it is looked at next time.
        if crew.lanes_started() != known
            && let Some(started) = crew.with_lanes(|lanes| take_over(&mut watched, lanes))
        {
            known = started;
        }
        let now = Instant::now();
        // What this thread overslept is no sign of a hang: others could not run either.
        let passed = (now - last).min(2 * sleep);
        last = now;
        sleep = watched
            .iter_mut()
            .map(|one| one.look(passed))
            .min()
            .unwrap_or(LONGEST_SLEEP);
    }
}

/// A lane, and what is known of the callback that it is in.
struct Watched {
    lane: Arc<Lane>,
    record: Record,
}

impl Watched {
    /// Looks at the lane, `passed` after the last look; when to look again at the latest.
    fn look(&mut self, passed: Duration) -> Duration {
        let watch = self.lane.loss().watch();
        let inside = watch.inside();
        let Some(thread) = watch.thread() else {
            return LONGEST_SLEEP;
        };
        let spent = |since| thread_time::spent(thread, since, passed);
        match self.record.look(inside, spent) {
            Verdict::InNothing => LONGEST_SLEEP,
            Verdict::LookWithin(left) => left.clamp(TICK, LONGEST_SLEEP),
            Verdict::Overdue => {
                watch.condemn(inside.generation);
                interrupt(thread);
                TICK
            }
        }
    }
}

/// Brings the watched lanes up to date with those of the crew.
fn take_over(watched: &mut Vec<Watched>, lanes: &[Arc<Lane>]) {
    let is = |one: &Watched, lane: &Arc<Lane>| Arc::ptr_eq(&one.lane, lane);
    watched.retain(|one| lanes.iter().any(|lane| is(one, lane)));
    for lane in lanes {
        if !watched.iter().any(|one| is(one, lane)) {
            watched.push(Watched {
                lane: Arc::clone(lane),
                record: Record::default(),
            });
        }
    }
}
