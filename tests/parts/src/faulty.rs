//! A component that does its work until its time has come.
//!
//! Property `callback` names the callback in which it misbehaves (default `onExecute`), `at_cycle`
//! the call of that callback, counted from 1 (default 5).

use std::marker::PhantomData;

use component_sdk::prelude::*;

use crate::{Arithmetic, Sample};

/// One way to fail.
pub trait Misbehaviour: 'static {
    /// Fails, or returns and has done harm.
    ///
    /// # Errors
    /// If returning an error is the way.
    fn misbehave(ports: &FaultyPorts) -> Outcome;
}

/// Ports by which the component shows that it works, and by which every callback can be reached.
#[derive(Ports)]
pub struct FaultyPorts {
    /// A number each cycle.
    pub output: Output<Sample>,
    heard: EventInput<Sample>,
    arithmetic: Provided<Arithmetic>,
}

/// A component with one misbehaviour.
pub struct Faulty<Way> {
    ports: FaultyPorts,
    /// Callback and the call of it; read from the properties by the first callback.
    plan: Option<(String, u64)>,
    calls: u64,
    written: u64,
    way: PhantomData<Way>,
}

impl<Way: Misbehaviour> Faulty<Way> {
    /// To be called at the start of every callback.
    fn strike_if_due(&mut self, context: &Context, callback: &str) -> Outcome {
        if self.plan.is_none() {
            let planned = context.property("callback");
            let call = context.property_or("at_cycle", 5)?;
            self.plan = Some((planned.unwrap_or_else(|| "onExecute".to_owned()), call));
        }
        let Some((planned, call)) = &self.plan else {
            return Ok(());
        };
        if planned != callback {
            return Ok(());
        }
        self.calls += 1;
        if self.calls == *call {
            Way::misbehave(&self.ports)
        } else {
            Ok(())
        }
    }
}

impl<Way: Misbehaviour> Component for Faulty<Way> {
    type Ports = FaultyPorts;

    fn new(ports: FaultyPorts) -> Self {
        Self {
            ports,
            plan: None,
            calls: 0,
            written: 0,
            way: PhantomData,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.strike_if_due(context, "onInitialize")
    }

    fn on_start(&mut self, context: &Context) -> Outcome {
        self.strike_if_due(context, "onStart")
    }

    fn on_stop(&mut self, context: &Context) -> Outcome {
        self.strike_if_due(context, "onStop")
    }

    fn on_destroy(&mut self, context: &Context) -> Outcome {
        self.strike_if_due(context, "onDestroy")
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        self.strike_if_due(context, "onExecute")?;
        self.written += 1;
        self.ports.output.write(&Sample {
            number: self.written,
            value: 0.0,
        });
        Ok(())
    }

    fn on_updated(&mut self, context: &Context) -> Outcome {
        self.strike_if_due(context, "onUpdated")
    }

    fn on_event(&mut self, context: &Context, event: &Event<'_>) -> Outcome {
        if self.ports.heard.content(event).is_some() {
            self.strike_if_due(context, "onEvent")?;
        }
        Ok(())
    }

    fn on_period_changed(&mut self, context: &Context, _period_ns: u64) -> Outcome {
        self.strike_if_due(context, "onPeriodChanged")
    }

    fn on_call(&mut self, context: &Context, call: &mut Call<'_>) -> Outcome {
        self.strike_if_due(context, "onCall")?;
        if self.ports.arithmetic.method(call) == Some("double") {
            let number: f64 = call.request()?;
            call.reply(&(2.0 * number))?;
        }
        Ok(())
    }
}
