//! Sends increasing numbers.
//!
//! Property `burst`: how many in each cycle (default 1).
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::Sample;

#[derive(Ports)]
struct Ports {
    output: Output<Sample>,
}

struct Counter {
    ports: Ports,
    burst: u64,
    sent: u64,
}

impl Component for Counter {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            burst: 1,
            sent: 0,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.burst = context.property_or("burst", 1)?;
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        for _ in 0..self.burst {
            self.sent += 1;
            #[allow(clippy::cast_precision_loss)] // tests do not count that far
            let value = self.sent as f64;
            self.ports.output.write(&Sample {
                number: self.sent,
                value,
            });
        }
        Ok(())
    }
}

export_component!(Counter);
