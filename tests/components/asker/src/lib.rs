//! Calls a service in every cycle.
//!
//! Properties: `number`, the number to be doubled (default 21); `deadline_ms` (default 1000);
//! `method`, `double` or `note`. It logs an answer that differs from the one before.
#![forbid(unsafe_code)]

use std::time::Duration;

use component_sdk::prelude::*;
use test_parts::Arithmetic;

#[derive(Ports)]
struct Ports {
    arithmetic: Required<Arithmetic>,
}

struct Asker {
    ports: Ports,
    number: f64,
    deadline: Duration,
    notes: bool,
    noted: u64,
    last: String,
}

impl Component for Asker {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            number: 21.0,
            deadline: Duration::ZERO,
            notes: false,
            noted: 0,
            last: String::new(),
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.number = context.property_or("number", self.number)?;
        self.deadline = Duration::from_millis(context.property_or("deadline_ms", 1000)?);
        self.notes = context.property("method").as_deref() == Some("note");
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let answer = if self.notes {
            self.noted += 1;
            let sent = self.ports.arithmetic.send("note", &self.noted);
            sent.map(|()| "sent".to_owned())
        } else {
            self.ports
                .arithmetic
                .call::<f64, f64>("double", &self.number, self.deadline)
                .map(|answer| answer.to_string())
        };
        let text = answer.unwrap_or_else(|failure| failure.status.to_string());
        if text != self.last {
            context.info(format!("answer {text}"));
            self.last = text;
        }
        Ok(())
    }
}

export_component!(Asker);
