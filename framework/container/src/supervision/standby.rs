//! Instances that stand by for a component: made ahead as far as the rules say, from the factory
//! when there is none.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crossbeam::atomic::AtomicCell;
use system_model::life_cycle::{LifeCycleState, Operation};
use system_model::rules::Preload;

use super::recovery::words;
use crate::assembly::Factory;
use crate::component::Component;
use crate::guard::loss::Loss;
use crate::status::ComponentStatus;

/// The standbys of one component, one of each variant at most. One thread at a time prepares them;
/// whoever needs one takes it without ever waiting for that thread, which has the least priority of
/// all.
pub struct Standbys {
    factory: Arc<Factory>,
    /// By variant.
    places: Box<[Place]>,
    /// The instance whose place was taken last: freeing it is for who has time.
    retired: AtomicCell<Option<Box<Component>>>,
    /// A copy of the component's own library is kept loaded as well, for a reset.
    keeps_own: bool,
}

/// Where a standby of one variant stands.
#[derive(Default)]
struct Place {
    standby: AtomicCell<Option<Box<Component>>>,
    /// Whether there is one. Said before it is there, and taken back by who has taken it, so that
    /// it is never said of an empty place for good.
    taken: AtomicBool,
}

const _: () = assert!(AtomicCell::<Option<Box<Component>>>::is_lock_free());

impl Standbys {
    /// None yet. `keeps_own`: a copy of the component's own library shall be kept loaded for a
    /// reset, because loading takes longer than all the rest of it.
    pub fn new(factory: Arc<Factory>, keeps_own: bool) -> Self {
        Self {
            places: factory
                .variants()
                .iter()
                .map(|_| Place::default())
                .collect(),
            factory,
            retired: AtomicCell::new(None),
            keeps_own,
        }
    }

    /// Where instances come from.
    pub fn factory(&self) -> &Factory {
        &self.factory
    }

    /// Variants of which the rules want one prepared, and none is.
    pub fn wanting(&self) -> impl Iterator<Item = usize> {
        let variants = self.factory.variants().iter().enumerate();
        let wanted = variants.filter(|(index, variant)| {
            variant.preload != Preload::Cold || (*index == 0 && self.keeps_own)
        });
        let indices = wanted.map(|(index, _)| index);
        indices.filter(|index| !self.places[*index].taken.load(Ordering::Acquire))
    }

    /// Each variant of which the rules want one prepared, and whether it is.
    pub fn readiness(&self) -> impl Iterator<Item = (usize, bool)> {
        let variants = self.factory.variants().iter().enumerate();
        let wanted = variants.filter(|(_, variant)| variant.preload != Preload::Cold);
        wanted.map(|(index, _)| (index, self.places[index].taken.load(Ordering::Acquire)))
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
        component.touch_memory();
        self.add(variant, component);
        Ok(())
    }

    /// Puts an instance of a variant where it stands by.
    pub(super) fn add(&self, variant: usize, component: Box<Component>) {
        let place = &self.places[variant];
        place.taken.store(true, Ordering::Release);
        place.standby.store(Some(component));
    }

    /// An instance of a variant, and how far it was prepared.
    pub(super) fn take(&self, variant: usize) -> Result<(Box<Component>, &'static str), String> {
        let place = self.places.get(variant);
        let standby = place.and_then(|place| {
            let standby = place.standby.take()?;
            place.taken.store(false, Ordering::Release);
            // What it runs in may have died while it stood by.
            Some(standby).filter(|standby| standby.is_fit())
        });
        let Some(component) = standby else {
            return Ok((self.make(variant)?, "by a fresh instance"));
        };
        let readiness = match component.state() {
            LifeCycleState::Ready => "by a warm standby",
            _ if component.is_constructed() => "by a loaded standby",
            _ => "by a fresh instance of a loaded copy",
        };
        Ok((component, readiness))
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

    /// Keeps an instance whose place was taken until [`Self::free_retired`]. Nothing of one that is
    /// quarantined is ever freed; one that could be called has been destroyed.
    pub(super) fn retire(&self, mut predecessor: Box<Component>) {
        predecessor.retire();
        drop(self.retired.swap(Some(predecessor)));
    }

    /// Frees what can be freed of the instance whose place was taken last.
    pub fn free_retired(&self) {
        drop(self.retired.take());
    }

    fn make(&self, variant: usize) -> Result<Box<Component>, String> {
        let name = self.factory.variants().first();
        let name = name.map_or_else(String::new, |first| first.specification.name.clone());
        let status = Arc::new(ComponentStatus::standby(name));
        self.factory.make(variant, status).map(Box::new)
    }
}
