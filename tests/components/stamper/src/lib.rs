//! Sends the time, by turns in a small and in a large datum.
#![forbid(unsafe_code)]

use std::time::{SystemTime, UNIX_EPOCH};

use component_sdk::prelude::*;
use test_parts::{LargeStamp, SmallStamp};

#[derive(Ports)]
struct Ports {
    small: Output<SmallStamp>,
    large: Output<LargeStamp>,
}

struct Stamper {
    ports: Ports,
    large: Box<LargeStamp>,
    is_large: bool,
}

fn now_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |time| u64::try_from(time.as_nanos()).unwrap_or_default())
}

impl Component for Stamper {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            large: Box::new(LargeStamp {
                sent_ns: 0,
                rest: [9; 57_592],
            }),
            is_large: false,
        }
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        self.is_large = !self.is_large;
        if self.is_large {
            self.large.sent_ns = now_ns();
            self.ports.large.write(&self.large);
        } else {
            self.ports.small.write(&SmallStamp {
                sent_ns: now_ns(),
                rest: [9; 7],
            });
        }
        Ok(())
    }
}

export_component!(Stamper);
