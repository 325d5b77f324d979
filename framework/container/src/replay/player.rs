//! A component that does what the recording says.

use std::sync::Arc;

use component_abi::Status;
use system_model::specification::{PortDirection, PortKind};

use super::score::Score;
use crate::guard::{Callback, Ending, ForeignBytesMut, HostServices, Request};
use crate::library::PortDescription;

/// Data that one input gives in one cycle: as many as the longest queue that a person writes.
const MOST_READS: usize = 65_536;

/// An instance without a library behind it.
#[derive(Debug)]
pub struct Player {
    number: usize,
    score: Arc<Score>,
    /// Numbers of its data inputs, each with room for a datum.
    inputs: Vec<(u32, Box<[u8]>)>,
}

impl Player {
    /// The player of the component of this number, with its ports.
    pub fn new(number: usize, score: Arc<Score>, ports: &[PortDescription]) -> Self {
        let numbered = (0u32..).zip(ports);
        let inputs = numbered.filter(|(_, port)| {
            (port.kind, port.direction) == (PortKind::Data, PortDirection::Input)
        });
        let with_room = |(number, port): (u32, &PortDescription)| {
            let size = port.data_type.as_ref().map_or(0, |it| it.size);
            (number, vec![0; size].into_boxed_slice())
        };
        Self {
            number,
            score,
            inputs: inputs.map(with_room).collect(),
        }
    }

    /// A callback: in its cycle it writes what is due and reads all that has arrived.
    pub(crate) fn call(&mut self, callback: Callback, services: &mut impl HostServices) -> Ending {
        match callback {
            Callback::Execute => {
                self.write(services);
                self.read(services);
                Ending::Returned(Status::SUCCESS)
            }
            // A recording does not hold what its services answered.
            Callback::Call(_) => Ending::Returned(Status::UNSUPPORTED_METHOD),
            _ => Ending::Returned(Status::SUCCESS),
        }
    }

    fn write(&self, services: &mut impl HostServices) {
        for mut due in self.score.take(self.number) {
            let content = ForeignBytesMut::of(&mut due.datum).for_reading();
            let request = match due.kind {
                PortKind::Event => Request::Raise(due.port, content),
                _ => Request::Write(due.port, content),
            };
            // Refused where a queue of events is full, as it was for the component itself.
            let _status = services.answer(&request);
        }
    }

    fn read(&mut self, services: &mut impl HostServices) {
        let found = u64::from(Status::SUCCESS.0);
        for (port, datum) in &mut self.inputs {
            for _ in 0..MOST_READS {
                let request = Request::Read(*port, ForeignBytesMut::of(datum));
                if services.answer(&request) != found {
                    break;
                }
            }
        }
    }
}
