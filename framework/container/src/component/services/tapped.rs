//! Reading and writing where rules look on.

use component_abi::Status;

use super::{Environment, Services, bit};
use crate::component::port_end::PortEnd;
use crate::component::tap::{Circumstances, InputTap, OutputTap};
use crate::guard::{ForeignBytes, ForeignBytesMut};

impl Services {
    /// Puts a tap on a data port that has none.
    pub fn tap(&mut self, port: usize) {
        match self.ports.get_mut(port) {
            Some(PortEnd::DataOutput(output)) => {
                let size = output.size;
                output
                    .tap
                    .get_or_insert_with(|| Box::new(OutputTap::new(size)));
            }
            Some(PortEnd::DataInput(input)) => {
                input
                    .tap
                    .get_or_insert_with(|| Box::new(InputTap::default()));
            }
            _ => {}
        }
    }

    pub(super) fn read_tapped(&mut self, port: u32, data: ForeignBytesMut) -> Status {
        let component = self.detectors.map(|all| all.component);
        let at = circumstances(
            &self.environment,
            self.incarnation,
            self.cycle_ns,
            component,
            port,
        );
        let Some(PortEnd::DataInput(input)) = self.ports.get_mut(port as usize) else {
            return Status::BAD_INPUT_PARAMETER;
        };
        let Some(tap) = &mut input.tap else {
            return Status::NOTHING;
        };
        match tap.receive(input.source.as_mut(), at) {
            None => Status::NOTHING,
            Some((sent, bytes)) if data.copy_from(bytes) => {
                if sent {
                    self.in_work |= bit(port);
                }
                Status::SUCCESS
            }
            Some(_) => self.bad_pointer("read"),
        }
    }

    pub(super) fn write_tapped(&mut self, port: u32, data: ForeignBytes) -> Status {
        let component = self.detectors.map(|all| all.component);
        let at = circumstances(
            &self.environment,
            self.incarnation,
            self.cycle_ns,
            component,
            port,
        );
        let Some(PortEnd::DataOutput(output)) = self.ports.get_mut(port as usize) else {
            return Status::BAD_INPUT_PARAMETER;
        };
        let Some(tap) = &mut output.tap else {
            return Status::SUCCESS;
        };
        if !data.copy_to(tap.scratch.bytes_mut()) {
            return self.bad_pointer("write");
        }
        tap.scratch.set_origin(self.cycle_ns, self.incarnation);
        let mut times = tap.distort(at);
        loop {
            if times == 0 {
                if at.injections.is_none() || !tap.resume(at) {
                    return Status::SUCCESS;
                }
                times = 1;
            }
            if !tap.look(at) {
                self.contaminated = true;
            }
            for (sender, wake) in &mut output.connections {
                // A delayed datum keeps the time at which it was written.
                let (stamp_ns, incarnation) = (tap.scratch.stamp_ns(), tap.scratch.incarnation());
                sender.send(stamp_ns, incarnation, |bytes| {
                    bytes.copy_from_slice(tap.scratch.bytes());
                    true
                });
                if let Some(wake) = wake {
                    wake.wake();
                }
            }
            times -= 1;
        }
    }
}

fn circumstances(
    environment: &Environment,
    incarnation: u32,
    now_ns: u64,
    component: Option<usize>,
    port: u32,
) -> Circumstances<'_> {
    let injections = component
        .filter(|_| environment.injections.is_armed())
        .map(|component| (&environment.injections, component, port as usize));
    Circumstances {
        observations: &environment.observations,
        incarnation,
        now_ns,
        seen_ns: environment.clock.cycle_time_ns(now_ns),
        injections,
    }
}
