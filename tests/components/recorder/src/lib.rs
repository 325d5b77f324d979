//! Receives numbers and says what it got.
//!
//! In every cycle it takes all that has arrived. Property `verbose`: log each cycle's numbers and
//! values. Property `chokes_on`: a number that it panics on. When stopped it logs how many came, and
//! how often a number was not the successor of the one before.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::Sample;

#[derive(Ports)]
struct Ports {
    input: Input<Sample>,
}

struct Recorder {
    ports: Ports,
    verbose: bool,
    chokes_on: Option<u64>,
    last: u64,
    received: u64,
    gaps: u64,
}

impl Component for Recorder {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            verbose: false,
            chokes_on: None,
            last: 0,
            received: 0,
            gaps: 0,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.verbose = context.property_or("verbose", false)?;
        self.chokes_on = match context.property_or("chokes_on", 0)? {
            0 => None,
            number => Some(number),
        };
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let mut text = String::new();
        while let Some(sample) = self.ports.input.read() {
            if self.chokes_on == Some(sample.number) {
                context.info(format!("choked on {}", sample.number));
                panic!("cannot swallow it");
            }
            self.received += 1;
            self.gaps += u64::from(sample.number != self.last + 1);
            self.last = sample.number;
            if self.verbose {
                text += &format!(" {}={}", sample.number, sample.value);
            }
        }
        if !text.is_empty() {
            context.info(format!("got{text}"));
        }
        Ok(())
    }

    fn on_stop(&mut self, context: &Context) -> Outcome {
        context.info(format!(
            "received {}, last {}, gaps {}",
            self.received, self.last, self.gaps
        ));
        Ok(())
    }
}

export_component!(Recorder);
