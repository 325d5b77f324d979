//! Reading and writing where rules look on.

use component_abi::Status;

use super::{Services, bit};
use crate::component::port_end::PortEnd;
use crate::component::tap::Circumstances;
use crate::guard::{ForeignBytes, ForeignBytesMut};

impl Services {
    pub(super) fn read_tapped(&mut self, port: u32, data: ForeignBytesMut) -> Status {
        let at = Circumstances {
            observations: &self.environment.observations,
            incarnation: self.incarnation,
            now_ns: self.cycle_ns,
        };
        let Some(PortEnd::DataInput(input)) = self.ports.get_mut(port as usize) else {
            return Status::BAD_INPUT_PARAMETER;
        };
        let (Some(tap), Some(source)) = (&mut input.tap, &mut input.source) else {
            return Status::NOTHING;
        };
        match tap.receive(source, at) {
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
        let at = Circumstances {
            observations: &self.environment.observations,
            incarnation: self.incarnation,
            now_ns: self.cycle_ns,
        };
        let Some(PortEnd::DataOutput(output)) = self.ports.get_mut(port as usize) else {
            return Status::BAD_INPUT_PARAMETER;
        };
        let Some(tap) = &mut output.tap else {
            return Status::SUCCESS;
        };
        if !data.copy_to(&mut tap.scratch) {
            return self.bad_pointer("write");
        }
        if !tap.look(at) {
            self.contaminated = true;
        }
        for (sender, wake) in &mut output.connections {
            sender.send(self.cycle_ns, self.incarnation, |bytes| {
                bytes.copy_from_slice(&tap.scratch);
                true
            });
            if let Some(wake) = wake {
                wake.wake();
            }
        }
        Status::SUCCESS
    }
}
