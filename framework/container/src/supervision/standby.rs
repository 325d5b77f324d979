//! Instances that stand by for a component: made ahead as far as the rules say, from the factory
//! when there is none.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use system_model::life_cycle::{LifeCycleState, Operation};
use system_model::rules::Preload;

use super::recovery::words;
use crate::assembly::Factory;
use crate::component::Component;
use crate::guard::loss::Loss;
use crate::status::ComponentStatus;

/// The standbys of one component.
pub struct Standbys {
    factory: Arc<Factory>,
    ready: Mutex<Vec<Standby>>,
    /// A copy of the component's own library is kept loaded as well, for a reset.
    keeps_own: bool,
}

struct Standby {
    variant: usize,
    component: Component,
}

impl Standbys {
    /// None yet. `keeps_own`: a copy of the component's own library shall be kept loaded for a
    /// reset, because loading takes longer than all the rest of it.
    pub fn new(factory: Arc<Factory>, keeps_own: bool) -> Self {
        Self {
            factory,
            ready: Mutex::default(),
            keeps_own,
        }
    }

    /// Where instances come from.
    pub fn factory(&self) -> &Factory {
        &self.factory
    }

    /// Variants of which the rules want one prepared, and none is.
    pub fn wanting(&self) -> Vec<usize> {
        let mut ready = self.ready();
        ready.retain(|standby| standby.component.is_fit());
        let variants = self.factory.variants().iter().enumerate();
        variants
            .filter(|(index, variant)| {
                variant.preload != Preload::Cold || (*index == 0 && self.keeps_own)
            })
            .map(|(index, _)| index)
            .filter(|index| !ready.iter().any(|standby| standby.variant == *index))
            .collect()
    }

    /// Prepares one of a variant, as far as the rules say.
    ///
    /// # Errors
    /// Why not; then it is made when it is needed.
    pub fn prepare(&self, variant: usize, loss: &Loss) -> Result<(), String> {
        let mut component = self.make(variant)?;
        let preload = self.factory.variants()[variant].preload;
        if preload != Preload::Cold {
            component
                .construct(loss)
                .map_err(|error| words("create", &error))?;
            component.set_constructed();
        }
        if preload == Preload::Warm {
            component
                .operate(Operation::Initialize, loss)
                .map_err(|error| words("onInitialize", &error))?;
        }
        self.ready().push(Standby { variant, component });
        Ok(())
    }

    /// An instance of a variant, and how far it was prepared.
    pub(super) fn take(&self, variant: usize) -> Result<(Component, &'static str), String> {
        let mut ready = self.ready();
        ready.retain(|standby| standby.component.is_fit());
        let found = ready.iter().position(|standby| standby.variant == variant);
        if let Some(found) = found {
            let component = ready.swap_remove(found).component;
            let readiness = match component.state() {
                LifeCycleState::Ready => "by a warm standby",
                _ if component.is_constructed() => "by a loaded standby",
                _ => "by a fresh instance of a loaded copy",
            };
            return Ok((component, readiness));
        }
        drop(ready);
        Ok((self.make(variant)?, "by a fresh instance"))
    }

    /// Brings an instance to READY, from wherever it is.
    pub(super) fn bring_up(&self, component: &mut Component, loss: &Loss) -> Result<(), String> {
        if !component.is_constructed() {
            component
                .construct(loss)
                .map_err(|error| words("create", &error))?;
            component.set_constructed();
        }
        component
            .operate(Operation::Initialize, loss)
            .map_err(|error| words("onInitialize", &error))
    }

    fn make(&self, variant: usize) -> Result<Component, String> {
        let name = self.factory.variants().first();
        let name = name.map_or_else(String::new, |first| first.specification.name.clone());
        let status = Arc::new(ComponentStatus::standby(name));
        self.factory.make(variant, status)
    }

    fn ready(&self) -> MutexGuard<'_, Vec<Standby>> {
        self.ready.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
