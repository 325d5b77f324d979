//! Logs each of its callbacks.
//!
//! Property `show`: names of properties, separated by commas, whose values it logs when it is
//! initialised. Property `device`: a device that it opens then. Property `remembers`: whether it
//! counts its cycles in memory that it registers as critical.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;
use test_parts::Sample;

struct Diary {
    memory: Option<&'static mut Sample>,
}

impl Component for Diary {
    type Ports = ();

    fn new((): ()) -> Self {
        Self { memory: None }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        context.info("onInitialize");
        for name in context.property("show").unwrap_or_default().split(',') {
            if !name.is_empty() {
                context.info(format!("{name} is {:?}", context.property(name)));
            }
        }
        if let Some(device) = context.property("device") {
            context.open_device(&device)?;
        }
        if context.property_or("remembers", false)? && self.memory.is_none() {
            self.memory = Some(context.critical(Sample::default())?);
        }
        Ok(())
    }

    fn on_reset(&mut self, context: &Context) -> Outcome {
        context.info("onReset");
        if let Some(memory) = &mut self.memory {
            memory.number = 0;
        }
        Ok(())
    }

    fn on_recover(&mut self, context: &Context) -> Outcome {
        let remembered = self.memory.as_ref().map_or(0, |memory| memory.number);
        context.info(format!("onRecover after {remembered} cycles"));
        Ok(())
    }

    fn on_start(&mut self, context: &Context) -> Outcome {
        context.info("onStart");
        Ok(())
    }

    fn on_stop(&mut self, context: &Context) -> Outcome {
        context.info("onStop");
        Ok(())
    }

    fn on_error(&mut self, context: &Context) -> Outcome {
        context.info("onError");
        Ok(())
    }

    fn on_destroy(&mut self, context: &Context) -> Outcome {
        context.info("onDestroy");
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        context.info(format!("onExecute at {} ms", context.now().as_millis()));
        if context.property("fails").is_some() {
            return Err(Failure::internal("asked to"));
        }
        if let Some(memory) = &mut self.memory {
            memory.number += 1;
        }
        Ok(())
    }

    fn on_updated(&mut self, context: &Context) -> Outcome {
        context.info("onUpdated");
        Ok(())
    }

    fn on_period_changed(&mut self, context: &Context, period_ns: u64) -> Outcome {
        context.info(format!("onPeriodChanged to {} ms", period_ns / 1_000_000));
        Ok(())
    }
}

export_component!(Diary);
