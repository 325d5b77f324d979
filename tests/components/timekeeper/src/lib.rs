//! Says, when it is stopped, how long each time that came was under way, in nanoseconds.
#![forbid(unsafe_code)]

use std::time::{SystemTime, UNIX_EPOCH};

use component_sdk::prelude::*;
use test_parts::{LargeStamp, SmallStamp};

/// More times than a minute brings.
const TIMES_MAXIMUM: usize = 10_000;

#[derive(Ports)]
struct Ports {
    small: Input<SmallStamp>,
    large: Input<LargeStamp>,
}

struct Timekeeper {
    ports: Ports,
    small_ns: Vec<u64>,
    large_ns: Vec<u64>,
}

fn since(sent_ns: u64) -> u64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let now_ns = now.map_or(0, |time| u64::try_from(time.as_nanos()).unwrap_or_default());
    now_ns.saturating_sub(sent_ns)
}

impl Component for Timekeeper {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            small_ns: Vec::with_capacity(TIMES_MAXIMUM),
            large_ns: Vec::with_capacity(TIMES_MAXIMUM),
        }
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        if let Some(stamp) = self.ports.small.read()
            && self.small_ns.len() < TIMES_MAXIMUM
        {
            self.small_ns.push(since(stamp.sent_ns));
        }
        if let Some(stamp) = self.ports.large.read()
            && self.large_ns.len() < TIMES_MAXIMUM
        {
            self.large_ns.push(since(stamp.sent_ns));
        }
        Ok(())
    }

    fn on_stop(&mut self, context: &Context) -> Outcome {
        for (name, times) in [("small", &mut self.small_ns), ("large", &mut self.large_ns)] {
            times.sort_unstable();
            let at = |part: usize| times.get(times.len() * part / 100).copied().unwrap_or(0);
            context.info(format!("{name}: {} {} {}", times.len(), at(50), at(99)));
        }
        Ok(())
    }
}

export_component!(Timekeeper);
