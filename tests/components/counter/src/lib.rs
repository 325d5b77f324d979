//! Sends increasing numbers.
//!
//! Properties: `burst`, how many in each cycle (default 1); `remembers`, whether the last number is
//! registered as critical, so that a successor goes on from a checkpoint.
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
    memory: Option<&'static mut Sample>,
}

impl Component for Counter {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            burst: 1,
            sent: 0,
            memory: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.burst = context.property_or("burst", 1)?;
        if context.property_or("remembers", false)? && self.memory.is_none() {
            self.memory = Some(context.critical(Sample::default())?);
        }
        Ok(())
    }

    fn on_recover(&mut self, _context: &Context) -> Outcome {
        self.sent = self.memory.as_ref().map_or(0, |memory| memory.number);
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
        if let Some(memory) = &mut self.memory {
            memory.number = self.sent;
        }
        Ok(())
    }
}

export_component!(Counter);
