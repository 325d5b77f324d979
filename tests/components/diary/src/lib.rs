//! Logs each of its callbacks.
//!
//! Property `show`: names of properties, separated by commas, whose values it logs when it is
//! initialised. Property `device`: a device that it opens then.
#![forbid(unsafe_code)]

use component_sdk::prelude::*;

struct Diary;

impl Component for Diary {
    type Ports = ();

    fn new((): ()) -> Self {
        Self
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
