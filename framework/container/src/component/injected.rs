//! Injected faults in callbacks. In simulated time, where a callback takes none, an injected delay is
//! time of that clock, and an injected hang is broken off as soon as the watchdog can.

use std::time::Duration;

use system_model::injection::CallbackName;

use super::Component;
use crate::guard::{CallLimit, Callback, Misbehaviour};

/// After which time of the machine an injected hang is broken off in simulated time, in which it
/// lasts as long as the rules say: nothing depends on the machine's time there, so as short as the
/// watchdog looks.
const INJECTED_HANG: Duration = Duration::from_millis(1);

impl Component {
    /// Lets it misbehave in its next callback, whoever else wants what of it.
    pub(crate) fn misbehave(&mut self, misbehaviour: Misbehaviour) {
        self.instance.inject(Some(misbehaviour));
    }

    /// Lets the component misbehave in the callback that is about to begin, if it is to; the limit
    /// of that, where it is another one.
    #[cold]
    pub(super) fn inject(&mut self, callback: Callback, name: &'static str) -> Option<CallLimit> {
        let component = self.services.detectors()?.component;
        let environment = self.services.environment();
        let simulated = environment.clock.is_simulated();
        if matches!(callback, Callback::Execute) {
            let cycle = self.status.cycles() + 1;
            let now = environment.clock.now();
            let changed =
                environment
                    .injections
                    .begin_execution(component, cycle, now, &environment.worlds);
            environment.record_injections(&changed);
        }
        let (_, called) = CallbackName::ALL.iter().find(|(known, _)| *known == name)?;
        let mut misbehaviour = environment.injections.misbehaviour(component, *called)?;
        let limit = self.nominal.of(callback);
        if simulated && let Misbehaviour::Slow(time) = misbehaviour {
            if limit.is_zero() || time < limit {
                environment.busy.add(time);
                return None;
            }
            misbehaviour = Misbehaviour::Hang;
        }
        self.instance.inject(Some(misbehaviour));
        let hangs = matches!(misbehaviour, Misbehaviour::Hang);
        (simulated && hangs && !limit.is_zero()).then(|| INJECTED_HANG.into())
    }
}
