//! Makes values smaller, and says how large an error it expects to leave.
//!
//! Properties: `gain`, what each value is multiplied with (default 1); `expects`, the error that it
//! writes to its port `expected` (default 0); `misbehaves_in`, the cycle in which it begins to
//! misbehave, counted from 1 (default: never), and `how`: `panics`, `hangs`, `fails`, `is_silent`,
//! `makes_worse` (it multiplies by 100).
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::Sample;

#[derive(Ports)]
struct Ports {
    input: Input<Sample>,
    output: Output<Sample>,
    expected: Output<Sample>,
}

struct Refiner {
    ports: Ports,
    gain: f64,
    expects: f64,
    misbehaves_in: u64,
    how: String,
    cycles: u64,
}

impl Component for Refiner {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            gain: 1.0,
            expects: 0.0,
            misbehaves_in: 0,
            how: String::new(),
            cycles: 0,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.gain = context.property_or("gain", 1.0)?;
        self.expects = context.property_or("expects", 0.0)?;
        self.misbehaves_in = context.property_or("misbehaves_in", 0)?;
        self.how = context.property_or("how", String::new())?;
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        self.cycles += 1;
        let mut gain = self.gain;
        if self.misbehaves_in > 0 && self.cycles >= self.misbehaves_in {
            match self.how.as_str() {
                "panics" => panic!("told to"),
                "hangs" => loop {
                    std::hint::spin_loop();
                },
                "fails" => return Err(Failure::new(Status::INTERNAL_FAULT, "told to")),
                "is_silent" => return Ok(()),
                "makes_worse" => gain = 100.0,
                other => context.warn(format!("no misbehaviour {other}")),
            }
        }
        while let Some(mut sample) = self.ports.input.read() {
            sample.value *= gain;
            self.ports.output.write(&sample);
            sample.value = self.expects;
            self.ports.expected.write(&sample);
        }
        Ok(())
    }
}

export_component!(Refiner);
