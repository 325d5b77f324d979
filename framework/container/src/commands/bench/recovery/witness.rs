//! Who watches a running application: notes when faults acted and when components worked again, and
//! ends emergency stops as an operator would.

use std::sync::Arc;
use std::time::{Duration, Instant};

use container::status::ComponentStatus;
use container::system::System;
use fault_manager::Observation;

/// As often as components run: each notes only its last recovery, and is hit by another fault many
/// periods later.
const LOOK_PERIOD: Duration = Duration::from_millis(1);

/// Looks at an emergency stop before it is cleared: by then the actuators have answered.
const LOOKS_AT_A_STOP: u32 = 2;

/// Without any news for so long there will be none.
const PATIENCE: Duration = Duration::from_secs(3);

/// What was seen of one component, by the container's clock, in nanoseconds.
#[derive(Debug, Default)]
pub(super) struct Seen {
    /// When faults acted.
    pub(super) misbehaved_ns: Vec<u64>,
    /// When it had completed its first cycle after each.
    pub(super) works_since_ns: Vec<u64>,
}

/// Watches until each of the components has worked again so many times, or nothing happens any
/// more. The first `stops` of them are ended emergency stops, if any are to be expected.
pub(super) fn watch(
    system: &System,
    names: &[String],
    recoveries: usize,
    stops: usize,
) -> Vec<Seen> {
    let find = |name: &String| system.statuses().iter().find(|it| it.name == *name);
    let statuses: Vec<&Arc<ComponentStatus>> = names.iter().filter_map(find).collect();
    let mut seen: Vec<Seen> = statuses.iter().map(|_| Seen::default()).collect();
    let mut news = Instant::now();
    let (mut looks, mut stopped) = (0, 0);
    while news.elapsed() < PATIENCE {
        std::thread::sleep(LOOK_PERIOD);
        for (seen, status) in seen.iter_mut().zip(&statuses) {
            if seen.note(status) {
                news = Instant::now();
            }
        }
        if stops > 0 && system.supervisor().is_emergency() {
            looks += 1;
            if looks == LOOKS_AT_A_STOP {
                system.supervisor().observe(Observation::Clear(None));
                news = Instant::now();
                (looks, stopped) = (0, stopped + 1);
            }
        }
        let all_worked = seen.iter().all(|it| it.works_since_ns.len() >= recoveries);
        if all_worked && stopped >= stops {
            break;
        }
    }
    seen
}

impl Seen {
    /// Whether there is something new.
    fn note(&mut self, status: &ComponentStatus) -> bool {
        let misbehaved = note(&mut self.misbehaved_ns, status.misbehaved_ns());
        let works = note(&mut self.works_since_ns, status.works_since_ns());
        misbehaved || works
    }
}

/// Notes a time that was not there before; 0 is none.
fn note(times_ns: &mut Vec<u64>, time_ns: u64) -> bool {
    let is_new = time_ns > 0 && times_ns.last() != Some(&time_ns);
    if is_new {
        times_ns.push(time_ns);
    }
    is_new
}
