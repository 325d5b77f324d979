//! The watchdog: a thread that outranks every component, looks at what each lane is in, and breaks
//! off callbacks that do not return within their limit.
//!
//! A callback's time is that in which it ran or waited for something. Time in which it wanted to
//! run and the machine had no processor for it does not count: an overrun tells of that, and the
//! component is not to blame.

mod record;
mod thread_time;
mod tick_rate;

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::guard::{CallLimit, interrupt};
use crate::lane::{Crew, Lane};
use crate::scheduling::outrank_components;

use record::{Record, Verdict};
use tick_rate::TickRate;

/// A callback that is to be broken off is tried again after this time: a thread that is in the
/// allocator's or the loader's code is out of it by then.
pub(crate) const TICK: Duration = Duration::from_millis(1);

/// The longest time between looks: how late a limit is heard of that is shorter than all before, or
/// that somebody is in a hurry.
const LONGEST_SLEEP: Duration = Duration::from_millis(4);

/// The shortest time between looks while no limit has passed: a look costs a few microseconds a
/// lane.
const SHORTEST_SLEEP: Duration = Duration::from_micros(200);

/// A sleep takes so long at least, whatever was asked for.
const LEAST_SLEEP: Duration = Duration::from_micros(20);

/// Watches over a crew's lanes until it is dismissed. Runs on the calling thread.
pub(crate) fn watch_over(crew: &Crew) {
    outrank_components();
    let mut watched = Vec::new();
    let mut known = 0;
    let mut sleep = LONGEST_SLEEP;
    let mut rate = TickRate::begin();
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
        let passed = (now - last).min(2 * sleep.max(TICK));
        last = now;
        rate.learn();
        sleep = watched
            .iter_mut()
            .map(|one| one.look(passed, &rate))
            .min()
            .unwrap_or(LONGEST_SLEEP);
    }
}

/// A lane, and what is known of the callback that it is in.
struct Watched {
    lane: Arc<Lane>,
    record: Record,
    /// The thread that was the lane's at the last look, and its processor time then.
    last: Option<(i32, Duration)>,
}

impl Watched {
    /// Looks at the lane, `passed` after the last look; when to look again at the latest: no limit
    /// passes before, neither that of the callback under way nor of one that begins at once.
    fn look(&mut self, passed: Duration, rate: &TickRate) -> Duration {
        let watch = self.lane.loss().watch();
        let inside = watch.inside();
        let age = rate.since(watch.since_ticks());
        let Some(thread) = watch.thread() else {
            return LONGEST_SLEEP;
        };
        let last = self.last.filter(|last| last.0 == thread);
        let before = last.map(|(_, processor_time)| processor_time);
        let now = thread_time::processor_time(thread);
        self.last = now.map(|now| (thread, now));
        let spent = |of| thread_time::spent(thread, before, now, of);
        let shortest = match watch.shortest_limit() {
            CallLimit::NONE => LONGEST_SLEEP,
            limit => limit.duration().clamp(SHORTEST_SLEEP, LONGEST_SLEEP),
        };
        match self.record.look(inside, age, passed, spent) {
            Verdict::InNothing => shortest,
            Verdict::LookWithin(left) => left.clamp(LEAST_SLEEP, shortest),
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
                last: None,
            });
        }
    }
}
