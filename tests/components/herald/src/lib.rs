//! Raises numbered events.
//!
//! Property `burst`: how many in each cycle (default 1). It logs the first number that was refused.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::Sample;

#[derive(Ports)]
struct Ports {
    news: EventOutput<Sample>,
}

struct Herald {
    ports: Ports,
    burst: u64,
    raised: u64,
}

impl Component for Herald {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            burst: 1,
            raised: 0,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.burst = context.property_or("burst", 1)?;
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let mut refused = None;
        for _ in 0..self.burst {
            self.raised += 1;
            let news = Sample {
                number: self.raised,
                value: 0.0,
            };
            if let Err(status) = self.ports.news.raise(&news) {
                refused = refused.or(Some((self.raised, status)));
            }
        }
        if let Some((number, status)) = refused {
            context.warn(format!("refused from {number}: {status}"));
        }
        Ok(())
    }
}

export_component!(Herald);
