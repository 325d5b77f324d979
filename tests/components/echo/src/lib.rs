//! Sends back what it receives, when it is run at all.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::Sample;

#[derive(Ports)]
struct Ports {
    input: Input<Sample>,
    output: Output<Sample>,
}

struct Echo {
    ports: Ports,
}

impl Component for Echo {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self { ports }
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        while let Some(sample) = self.ports.input.read() {
            self.ports.output.write(&sample);
        }
        Ok(())
    }
}

export_component!(Echo);
