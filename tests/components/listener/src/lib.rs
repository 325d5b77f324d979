//! Logs the numbers of the events that it hears.
//!
//! Properties: `fails_at`, the cycle that it fails in; `chokes_on`, a number that it panics on (by
//! default none).
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::Sample;

#[derive(Ports)]
struct Ports {
    news: EventInput<Sample>,
}

struct Listener {
    ports: Ports,
    cycles_left: Option<u64>,
    chokes_on: u64,
}

impl Component for Listener {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            cycles_left: None,
            chokes_on: 0,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.cycles_left = match context.property_or("fails_at", 0)? {
            0 => None,
            cycle => Some(cycle),
        };
        self.chokes_on = context.property_or("chokes_on", 0)?;
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        if let Some(left) = &mut self.cycles_left {
            *left -= 1;
            if *left == 0 {
                return Err(Failure::internal("as the property says"));
            }
        }
        Ok(())
    }

    fn on_event(&mut self, context: &Context, event: &Event<'_>) -> Outcome {
        if let Some(news) = self.ports.news.content(event) {
            context.info(format!("heard {}", news.number));
            assert_ne!(news.number, self.chokes_on, "cannot swallow it");
        }
        Ok(())
    }
}

export_component!(Listener);
