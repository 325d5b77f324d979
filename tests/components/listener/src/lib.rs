//! Logs the numbers of the events that it hears.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::Sample;

#[derive(Ports)]
struct Ports {
    news: EventInput<Sample>,
}

struct Listener {
    ports: Ports,
}

impl Component for Listener {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self { ports }
    }

    fn on_event(&mut self, context: &Context, event: &Event<'_>) -> Outcome {
        if let Some(news) = self.ports.news.content(event) {
            context.info(format!("heard {}", news.number));
        }
        Ok(())
    }
}

export_component!(Listener);
