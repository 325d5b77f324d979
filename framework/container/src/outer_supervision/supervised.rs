//! The container's end of the line to its parent.

use std::io::{self, ErrorKind, Write as _};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use serde::Serialize;

use super::messages::{Death, LINE_LIMIT, Sign, Welcome};
use super::{die_with_parent, monotonic, take_line};
use crate::clock::nanoseconds;
use crate::descriptor_line::DescriptorLine;
use crate::event_log::Event;
use crate::world::{RemoteWorld, World};

/// Beats are at least this far apart: half of the time between two looks of a fault manager that has
/// nothing to do. One that has much to do looks more often than any parent wants to know.
const BEAT_PERIOD: Duration = Duration::from_millis(50);

/// What a container has of the parent that supervises it.
#[derive(Debug)]
pub struct Supervised {
    line: UnixStream,
    world: Option<Arc<World>>,
    welcome: Welcome,
    running: AtomicBool,
    /// When the last beat was, in nanoseconds of the monotonic clock.
    last_beat_ns: AtomicU64,
}

impl Supervised {
    /// Makes this process a child that dies with its parent, and hears what that has to say.
    ///
    /// # Errors
    /// If the parent of that number is gone, or says something else.
    pub fn join(parent: i32) -> io::Result<Self> {
        die_with_parent(parent)?;
        let mut line = DescriptorLine::new(take_line()?, LINE_LIMIT)?;
        let received = line.receive::<Welcome>()?;
        let (welcome, world) = received.ok_or(ErrorKind::UnexpectedEof)?;
        let world = match world {
            Some(descriptor) => {
                let world = RemoteWorld::new(UnixStream::from(descriptor))?;
                Some(Arc::new(World::remote(world)))
            }
            None => None,
        };
        let line = line.into_stream();
        // Nobody waits for a parent that does not read.
        line.set_nonblocking(true)?;
        Ok(Self {
            line,
            world,
            welcome,
            running: AtomicBool::new(false),
            last_beat_ns: AtomicU64::new(0),
        })
    }

    /// A container that runs, over this line.
    #[cfg(test)]
    pub(crate) fn running_over(line: UnixStream) -> Self {
        Self {
            line,
            world: None,
            welcome: Welcome {
                first_start_ns: 0,
                restarts: 0,
                death: None,
            },
            running: AtomicBool::new(true),
            last_beat_ns: AtomicU64::new(0),
        }
    }

    /// The simulated world, which was there before this container.
    pub fn world(&self) -> Option<&Arc<World>> {
        self.world.as_ref()
    }

    /// How long ago the first container of the run was started.
    pub fn run_time(&self) -> Duration {
        let first_start = Duration::from_nanos(self.welcome.first_start_ns);
        monotonic().saturating_sub(first_start)
    }

    /// How often the container was restarted before this one, this one included.
    pub fn restarts(&self) -> u32 {
        self.welcome.restarts
    }

    /// The applications run; the record of the restart, if it was one.
    pub fn runs(&self) -> Option<Event> {
        self.running.store(true, Ordering::Release);
        self.beat();
        let death = self.welcome.death.as_ref()?;
        let restart = ContainerRestart::new(death, self.welcome.restarts, monotonic());
        Some(Event::ContainerRestarted(Box::new(restart)))
    }

    /// The fault manager looks after things. To be called from where it does, and only there.
    pub fn beat(&self) {
        let now_ns = nanoseconds(monotonic());
        let last_ns = self.last_beat_ns.load(Ordering::Relaxed);
        let is_due = now_ns.saturating_sub(last_ns) >= nanoseconds(BEAT_PERIOD);
        if is_due && self.running.load(Ordering::Acquire) {
            self.last_beat_ns.store(now_ns, Ordering::Relaxed);
            self.give(Sign::Beat);
        }
    }

    /// The run is over, and all stops in order.
    pub fn stops(&self) {
        self.give(Sign::Stops);
    }

    fn give(&self, sign: Sign) {
        // A parent that is gone takes this process along, and one whose line is full has signs
        // enough to read.
        let _unheard = (&self.line).write(&[sign.byte()]);
    }
}

/// What is on record of a container's death and what followed. Times are in microseconds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ContainerRestart {
    /// How many restarts there have been in this run.
    pub restart: u32,
    /// What was seen.
    pub seen: String,
    /// Why it was judged so.
    pub judged: String,
    /// What was done.
    pub done: String,
    /// From the last sign of life until the death was seen.
    pub detection_us: u64,
    /// From there until the next container was started.
    pub decision_us: u64,
    /// From there until it ran.
    pub handling_us: u64,
    /// How long no container ran, as far as is known: the sum of the last two.
    pub without_container_us: u64,
}

impl ContainerRestart {
    /// The record when the successor runs, `now`.
    fn new(death: &Death, restart: u32, now: Duration) -> Self {
        let microseconds = |from: u64, to: u64| to.saturating_sub(from) / 1000;
        let now_ns = nanoseconds(now);
        Self {
            restart,
            seen: death.seen.clone(),
            judged: death.judged.clone(),
            done: death.done.clone(),
            detection_us: microseconds(death.heard_ns, death.seen_ns),
            decision_us: microseconds(death.seen_ns, death.restarted_ns),
            handling_us: microseconds(death.restarted_ns, now_ns),
            without_container_us: microseconds(death.seen_ns, now_ns),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_phases_of_a_restart_follow_each_other() {
        let death = Death {
            seen: "it was ended by signal 9 (SIGKILL)".to_owned(),
            judged: "a crash".to_owned(),
            done: "restart 1 of 5".to_owned(),
            heard_ns: 1_000_000,
            seen_ns: 3_000_000,
            restarted_ns: 7_000_000,
        };
        let restart = ContainerRestart::new(&death, 1, Duration::from_nanos(15_000_000));
        let event = Event::ContainerRestarted(Box::new(restart));
        let json = serde_json::to_value(&event).unwrap();
        for (phase, expected_us) in [
            ("detection_us", 2_000),
            ("decision_us", 4_000),
            ("handling_us", 8_000),
            ("without_container_us", 12_000),
        ] {
            assert_eq!(json[phase], expected_us, "{phase}");
        }
        assert_eq!(json["event"], "container_restarted");
    }
}
