//! One instance takes another's place: ports, messages and name pass on, and every datum that the
//! old one has sent and nobody taken is void.

use std::sync::Arc;
use std::time::Duration;

use system_model::specification::{PortDirection, PortKind};

use super::port_end::{Calls, PortEnd};
use super::{Checkpoints, Component, Restored, Services};
use crate::library::{MethodDescription, PortDescription};
use system_model::injection::ContainerFailure;
use system_model::life_cycle::LifeCycleState;

/// How the ports and methods that others call by number are numbered in this instance's library,
/// where that is not the library that they were connected to.
#[derive(Debug, Clone, Default)]
pub(super) struct Numbering {
    /// By the first library's number; empty where nothing differs.
    ports: Box<[u32]>,
    /// By this library's port, and the first library's method.
    methods: Box<[Box<[u32]>]>,
    /// The interface that others were connected to; none: this instance's own.
    first: Option<Arc<[PortDescription]>>,
}

impl Numbering {
    /// This library's number of a port.
    #[inline]
    pub(super) fn port(&self, port: u32) -> u32 {
        self.ports.get(port as usize).copied().unwrap_or(port)
    }

    /// This library's number of a method of one of its ports.
    #[inline]
    pub(super) fn method(&self, port: u32, method: u32) -> u32 {
        let of_port = self.methods.get(port as usize);
        of_port
            .and_then(|methods| methods.get(method as usize))
            .copied()
            .unwrap_or(method)
    }

    fn between(first: &Arc<[PortDescription]>, own: &Arc<[PortDescription]>) -> Self {
        if are_numbered_alike(first, own) {
            return Self {
                first: Some(Arc::clone(first)),
                ..Self::default()
            };
        }
        let ports = first
            .iter()
            .map(|port| index_of(own.iter().map(|other| &other.name), &port.name))
            .collect();
        let methods = own
            .iter()
            .map(|port| {
                let same = first.iter().find(|other| other.name == port.name);
                let methods = same.map_or(&[][..], |other| &other.methods);
                let number = |name| index_of(port.methods.iter().map(|method| &method.name), name);
                methods.iter().map(|method| number(&method.name)).collect()
            })
            .collect();
        Self {
            ports,
            methods,
            first: Some(Arc::clone(first)),
        }
    }
}

impl Component {
    /// Takes the place of `predecessor`, which keeps nothing that it could be reached by. What the
    /// predecessor had sent and nobody taken is not delivered any more; what had been sent to it
    /// waits for this one.
    pub fn succeed(&mut self, predecessor: &mut Self) {
        let first = predecessor.numbering.first.as_ref();
        let first = Arc::clone(first.unwrap_or(predecessor.services.interface()));
        self.numbering = Numbering::between(&first, self.services.interface());
        let incarnation = predecessor.services.incarnation() + 1;
        self.take_ports(&mut predecessor.services);
        self.services.take_over(&mut predecessor.services);
        self.checkpoints = predecessor.checkpoints.take();
        self.status = Arc::clone(&predecessor.status);
        if let Some(executor) = predecessor.executor.take() {
            self.run_by(executor);
        }
        self.enter_incarnation(incarnation);
    }

    /// Takes the container's ends of all ports that the predecessor has, too: by their names, which
    /// most often have the same numbers.
    fn take_ports(&mut self, predecessor: &mut Services) {
        let own = Arc::clone(self.services.interface());
        let old = Arc::clone(predecessor.interface());
        for (index, port) in own.iter().enumerate() {
            let is_same = |other: &PortDescription| {
                (&other.name, other.kind, other.direction)
                    == (&port.name, port.kind, port.direction)
            };
            let found = match old.get(index) {
                Some(other) if is_same(other) => Some(index),
                _ => old.iter().position(is_same),
            };
            let Some(found) = found else { continue };
            let ends = (self.services.port_mut(index), predecessor.port_mut(found));
            let (Some(end), Some(old_end)) = ends else {
                continue;
            };
            std::mem::swap(end, old_end);
            if let PortEnd::Required(calls) = end {
                reorder(calls, &old[found], port);
            }
        }
        self.services.take_inboxes(predecessor);
    }

    /// Which instance of this name it is, counted from 1.
    pub fn incarnation(&self) -> u32 {
        self.services.incarnation()
    }

    /// Which of the component's libraries it is of.
    pub fn variant(&self) -> usize {
        self.variant
    }

    /// Says which of the component's libraries it is of.
    pub fn set_variant(&mut self, variant: usize) {
        self.variant = variant;
        self.status.set_variant(variant);
    }

    /// Whether the library's constructor has run.
    pub fn is_constructed(&self) -> bool {
        self.constructed
    }

    /// Says that the library's constructor has run.
    pub fn set_constructed(&mut self) {
        self.constructed = true;
    }

    /// Sees to it that its first callbacks need not wait for memory.
    pub fn touch_memory(&self) {
        self.instance.touch_memory();
    }

    /// Initialised anew: READY, whatever it or its predecessor was before.
    pub fn enter_ready(&mut self) {
        self.enter_state(LifeCycleState::Ready);
    }

    /// The end of an instance whose place was taken: what can be freed is freed when it is dropped.
    pub fn retire(&mut self) {
        if self.instance.is_alive() && self.state() != LifeCycleState::Destroyed {
            self.instance.quarantine();
        }
    }

    /// From now on checkpoints are taken with this period.
    pub fn keep_checkpoints(&mut self, period: Duration) {
        self.checkpoints = Some(Box::new(Checkpoints::new(period)));
    }

    /// Whether checkpoints shall be taken of an active component that has registered no memory.
    pub fn keeps_checkpoints_of_nothing(&self) -> bool {
        self.checkpoints.is_some() && self.is_active() && self.services.critical().is_none()
    }

    /// Copies the newest certified checkpoint that was taken before `before_ns` to the registered
    /// memory.
    pub fn restore_checkpoint(&mut self, before_ns: u64) -> Restored {
        let component = self.services.detectors().map(|all| all.component);
        let injections = &self.services.environment().injections;
        let corrupt =
            component.is_some_and(|it| injections.fails(it, ContainerFailure::CheckpointCorrupt));
        let Some(checkpoints) = &mut self.checkpoints else {
            return Restored::NotKept;
        };
        if corrupt {
            checkpoints.corrupt();
        }
        let (found, broken) = checkpoints.newest_before(before_ns);
        let Some(found) = found else {
            return Restored::Nothing { broken };
        };
        let Some(memory) = self.services.critical() else {
            return Restored::NoMemory;
        };
        let sequence = found.sequence;
        if memory.size() != found.bytes.len() || !memory.copy_from(found.bytes) {
            return Restored::Misfit {
                sequence,
                bytes: found.bytes.len(),
                registered: memory.size(),
            };
        }
        checkpoints.send_again(sequence, self.variant, self.services.incarnation());
        Restored::Done { sequence, broken }
    }

    /// From now on this same instance is another incarnation.
    pub fn begin_incarnation(&mut self, incarnation: u32) {
        self.instance.forget_allocations();
        self.enter_incarnation(incarnation);
    }

    fn enter_incarnation(&mut self, incarnation: u32) {
        self.status.set_incarnation(incarnation);
        self.services.begin_incarnation(incarnation);
    }
}

/// Whether two libraries number the same ports and methods alike.
fn are_numbered_alike(one: &[PortDescription], other: &[PortDescription]) -> bool {
    let alike = |(one, other): (&PortDescription, &PortDescription)| {
        one.name == other.name && have_methods_alike(one, other)
    };
    one.len() == other.len() && one.iter().zip(other).all(alike)
}

fn have_methods_alike(one: &PortDescription, other: &PortDescription) -> bool {
    let names = one.methods.iter().map(|method| &method.name);
    names.eq(other.methods.iter().map(|method| &method.name))
}

fn index_of<'name>(mut names: impl Iterator<Item = &'name String>, name: &str) -> u32 {
    names
        .position(|other| other == name)
        .and_then(|index| u32::try_from(index).ok())
        .unwrap_or(u32::MAX)
}

/// Puts the bound methods of a required port into the order of another library.
fn reorder(calls: &mut Calls, old: &PortDescription, port: &PortDescription) {
    debug_assert!(port.kind == PortKind::Service && port.direction == PortDirection::Output);
    if have_methods_alike(old, port) {
        return;
    }
    let mut bound: Vec<_> = std::mem::take(&mut calls.methods)
        .into_iter()
        .map(Some)
        .collect();
    let take = |method: &MethodDescription| {
        let index = old
            .methods
            .iter()
            .position(|other| other.name == method.name)?;
        bound.get_mut(index)?.take()
    };
    calls.methods = port.methods.iter().filter_map(take).collect();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn port(name: &str, methods: &[&str]) -> PortDescription {
        PortDescription {
            name: name.to_owned(),
            kind: PortKind::Service,
            direction: PortDirection::Input,
            data_type: None,
            methods: methods
                .iter()
                .map(|name| MethodDescription {
                    name: (*name).to_owned(),
                    blocking: true,
                    request: None,
                    reply: None,
                })
                .collect(),
        }
    }

    #[test]
    fn callers_keep_their_numbers_whatever_the_order_in_the_successor() {
        let first: Arc<[_]> = [port("a", &["x", "y"]), port("b", &["u", "v", "w"])].into();
        let own: Arc<[_]> = [
            port("new", &[]),
            port("b", &["w", "u", "v"]),
            port("a", &["y", "x"]),
        ]
        .into();
        let numbering = Numbering::between(&first, &own);
        assert_eq!((numbering.port(0), numbering.port(1)), (2, 1));
        assert_eq!((numbering.method(2, 0), numbering.method(2, 1)), (1, 0));
        let of_b: Vec<u32> = (0..3).map(|method| numbering.method(1, method)).collect();
        assert_eq!(of_b, [1, 2, 0]);
        let same = Numbering::between(&first, &first);
        assert_eq!((same.port(1), same.method(1, 2)), (1, 2));
    }
}
