//! Hears the fault manager, and reports to it: events without content.
//!
//! Property `reports_at`: the cycle in which it raises `alarm` (default: none).
#![forbid(unsafe_code)]

use component_sdk::prelude::*;

#[derive(Ports)]
struct Ports {
    fault: EventInput<()>,
    emergency_stop: EventInput<()>,
    alarm: EventOutput<()>,
}

struct Sentry {
    ports: Ports,
    cycle: u64,
    reports_at: u64,
}

impl Component for Sentry {
    type Ports = Ports;

    fn new(ports: Ports) -> Self {
        Self {
            ports,
            cycle: 0,
            reports_at: 0,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.reports_at = context.property_or("reports_at", 0)?;
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        self.cycle += 1;
        if self.cycle == self.reports_at
            && let Err(status) = self.ports.alarm.raise(&())
        {
            context.warn(format!("not heard: {status}"));
        }
        Ok(())
    }

    fn on_event(&mut self, context: &Context, event: &Event<'_>) -> Outcome {
        if self.ports.fault.content(event).is_some() {
            context.info("a fault");
        }
        if self.ports.emergency_stop.content(event).is_some() {
            context.info("an emergency stop");
        }
        Ok(())
    }
}

export_component!(Sentry);
