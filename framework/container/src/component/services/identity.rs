//! Who the component is, and what passes on when another instance takes its place.

use std::sync::Arc;

use component_abi::Status;
use fault_manager::DetectorId;

use super::{Detectors, Environment, Services};
use crate::component::port_end::{Inbox, PortEnd};
use crate::event_log::Event;
use crate::guard::{ForeignBytes, ForeignBytesMut};
use crate::injection::Changed;
use crate::library::PortDescription;
use crate::world::World;

impl Environment {
    /// Puts injected faults on record that have begun or ended.
    pub fn record_injections(&self, changed: &[Changed]) {
        for change in changed {
            let event = Event::Injection {
                fault: change.fault,
                component: change.component.clone(),
                change: if change.begins { "begins" } else { "ends" },
            };
            self.events.record(self.clock.now_ns(), event);
        }
    }
}

impl Services {
    /// Instance name.
    pub fn name(&self) -> &Arc<str> {
        &self.name
    }

    /// Which instance of this name it is, counted from 1.
    pub fn incarnation(&self) -> u32 {
        self.incarnation
    }

    /// What all components of the application share.
    pub fn environment(&self) -> &Arc<Environment> {
        &self.environment
    }

    /// From now on it opens simulated devices in this world.
    pub fn set_world(&mut self, world: Option<Arc<World>>) {
        self.world = world;
    }

    /// The detectors that the fault manager has for the component.
    pub fn detectors(&self) -> Option<Detectors> {
        self.detectors
    }

    /// From now on the fault manager is told.
    pub fn set_detectors(&mut self, detectors: Detectors) {
        self.detectors = Some(detectors);
    }

    /// Faults of this name that the component reports are those of a rule.
    pub fn name_fault(&mut self, name: String, detector: DetectorId) {
        self.named_faults.push((name, detector));
    }

    /// The ports, as the library describes them.
    pub fn interface(&self) -> &Arc<[PortDescription]> {
        &self.interface
    }

    pub(in crate::component) fn port_name(&self, index: usize) -> String {
        let port = self.interface.get(index);
        port.map_or_else(String::new, |port| port.name.clone())
    }

    /// The container's end of a port.
    pub fn port_mut(&mut self, index: usize) -> Option<&mut PortEnd> {
        self.ports.get_mut(index)
    }

    /// Adds a queue of messages for this component.
    pub fn add_inbox(&mut self, inbox: Inbox) {
        self.inboxes.push(inbox);
    }

    /// Takes the queues of messages from the instance that was there before.
    pub(in crate::component) fn take_inboxes(&mut self, predecessor: &mut Self) {
        std::mem::swap(&mut self.inboxes, &mut predecessor.inboxes);
    }

    /// What belongs to the name rather than to the instance.
    pub(in crate::component) fn take_over(&mut self, predecessor: &mut Self) {
        self.detectors = predecessor.detectors;
        self.named_faults = std::mem::take(&mut predecessor.named_faults);
        self.cycle_ns = predecessor.cycle_ns;
    }

    /// Data and messages are this incarnation's from now on; what older ones have sent and nobody
    /// taken is void.
    pub(in crate::component) fn begin_incarnation(&mut self, incarnation: u32) {
        self.incarnation = incarnation;
        self.begin_taps_anew();
        for port in &mut self.ports {
            match port {
                PortEnd::DataOutput(output) => {
                    for (sender, _) in &output.connections {
                        sender.succeed(incarnation);
                    }
                }
                PortEnd::EventOutput(output) => {
                    for (sender, _) in &output.connections {
                        sender.succeed(incarnation);
                    }
                }
                PortEnd::Required(calls) => {
                    for queue in calls.methods.iter().filter_map(|it| it.queue.as_ref()) {
                        queue.succeed(incarnation);
                    }
                }
                PortEnd::DataInput(_) | PortEnd::EventInput | PortEnd::Provided => {}
            }
        }
    }

    /// Whoever writes from now on is not compared with what was written before.
    pub(crate) fn begin_taps_anew(&mut self) {
        for port in &mut self.ports {
            if let PortEnd::DataOutput(output) = port
                && let Some(tap) = &mut output.tap
            {
                tap.begin_anew();
            }
        }
    }

    /// The registered memory, for reading.
    pub(in crate::component) fn critical_memory(&self) -> Option<ForeignBytes> {
        self.critical().map(ForeignBytesMut::for_reading)
    }

    /// The registered memory.
    pub fn critical(&self) -> Option<ForeignBytesMut> {
        let (address, size) = self.critical?;
        Some(ForeignBytesMut::at(address, size))
    }

    pub(in crate::component) fn record(&self, event: Event) {
        self.environment
            .events
            .record(self.environment.clock.now_ns(), event);
    }

    pub(in crate::component) fn last_status(&self) -> Status {
        self.last_status
    }
}
