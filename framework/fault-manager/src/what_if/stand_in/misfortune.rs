//! The fault that is supposed, as it strikes.

use std::collections::BTreeSet;
use std::time::Duration;

use system_model::fault::FaultKind;
use system_model::injection::{ContainerFailure, Distortion, Misbehaviour};

use super::{BEGIN, Component};
use crate::system::Scope;
use crate::what_if::{SupposedFault, Supposition, slowness};

/// What is supposed, and how far it has come.
#[derive(Debug)]
pub(super) struct Misfortune {
    /// By its number in all applications.
    component: usize,
    port: Option<String>,
    fault: SupposedFault,
    /// How much longer a slow callback takes.
    slow: Duration,
    /// What happens once has happened.
    struck: bool,
    /// The failure of the handling has happened.
    taken: bool,
    /// Components that wrong data have come to.
    readers: BTreeSet<usize>,
}

/// What a callback does instead of its work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Strike {
    Exception(FaultKind),
    Hang,
    /// Before its work.
    Slow(Duration),
}

impl Misfortune {
    /// `first` is the number of the first component of the application.
    pub fn new(supposition: &Supposition, first: usize, scopes: &[Scope]) -> Self {
        let specification = &scopes[supposition.application].specification;
        let component = &specification.components[supposition.component];
        Self {
            component: first + supposition.component,
            port: supposition.port.clone(),
            fault: supposition.fault,
            slow: slowness(&component.execution),
            struck: false,
            taken: false,
            readers: BTreeSet::new(),
        }
    }

    /// What the component does in this call; a callback that takes as long as `limit` is a hang.
    pub fn strike(&mut self, component: usize, now: Duration, limit: Duration) -> Option<Strike> {
        if component != self.component || now < BEGIN {
            return None;
        }
        match self.fault {
            SupposedFault::Callback(Misbehaviour::Slow(_)) if self.slow >= limit => {
                Some(Strike::Hang)
            }
            SupposedFault::Callback(Misbehaviour::Slow(_)) => Some(Strike::Slow(self.slow)),
            SupposedFault::Callback(Misbehaviour::Leak(_)) | SupposedFault::Port(_) => None,
            _ if std::mem::replace(&mut self.struck, true) => None,
            SupposedFault::Callback(Misbehaviour::Hang) => Some(Strike::Hang),
            // It shows by the handling of another fault.
            SupposedFault::Handling(_) => Some(Strike::Exception(FaultKind::Segfault)),
            fault => fault.exception().map(Strike::Exception),
        }
    }

    /// Whether this failure of the handling is supposed; it happens once.
    pub fn takes(&mut self, component: usize, failure: ContainerFailure) -> bool {
        let supposed = self.fault == SupposedFault::Handling(failure);
        supposed && component == self.component && !std::mem::replace(&mut self.taken, true)
    }

    /// Whether the component has lost more memory than any rule allows.
    pub fn leaks(&self, component: usize, now: Duration) -> bool {
        let leak = matches!(self.fault, SupposedFault::Callback(Misbehaviour::Leak(_)));
        leak && component == self.component && now > BEGIN
    }

    /// What happens to the data of a port.
    pub fn distortion(&self, component: usize, port: &str, now: Duration) -> Option<Distortion> {
        match self.fault {
            SupposedFault::Port(distortion)
                if now >= BEGIN
                    && component == self.component
                    && self.port.as_deref() == Some(port) =>
            {
                Some(distortion)
            }
            _ => None,
        }
    }

    /// A component takes wrong data for right ones.
    pub fn reaches(&mut self, component: usize) {
        self.readers.insert(component);
    }

    /// Names of those components.
    pub fn readers(&self, components: &[Component]) -> Vec<String> {
        let readers = self.readers.iter();
        readers
            .map(|index| components[*index].name.clone())
            .collect()
    }
}
