//! Provides a service.
//!
//! `double` doubles a number and refuses negative ones; `note` logs a number. Property `busy_ms`:
//! how long its first `onExecute` takes, during which it cannot be called.
#![forbid(unsafe_code)]

use std::time::Duration;

use component_sdk::prelude::*;
use test_parts::Arithmetic;

#[derive(Ports)]
struct Ports {
    arithmetic: Provided<Arithmetic>,
}

struct Adder {
    ports: Ports,
    busy: Duration,
}

impl Component for Adder {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            busy: Duration::ZERO,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.busy = Duration::from_millis(context.property_or("busy_ms", 0)?);
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        std::thread::sleep(std::mem::take(&mut self.busy));
        Ok(())
    }

    fn on_call(&mut self, context: &Context, call: &mut Call<'_>) -> Outcome {
        match self.ports.arithmetic.method(call) {
            Some("double") => {
                let number: f64 = call.request()?;
                if number < 0.0 {
                    return Err(Failure::new(Status::INPUT_OUT_OF_RANGE, "negative"));
                }
                call.reply(&(2.0 * number))
            }
            Some("note") => {
                let number: u64 = call.request()?;
                context.info(format!("noted {number}"));
                Ok(())
            }
            _ => Err(Failure::new(Status::UNSUPPORTED_METHOD, "no such method")),
        }
    }
}

export_component!(Adder);
