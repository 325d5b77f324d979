//! What leaves by the network.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use robot_network::frame::{self, Header};
use robot_network::{Node, NodeError, Outlet};
use system_model::specification::QueuePolicy;

use super::Shared;
use crate::library::PortDescription;
use crate::port::{Receiver, Sender, connection};
use crate::wake::Wake;

/// Data that may wait to be sent: a second and a half of a port that is written a hundred times a
/// second while the network stands still.
const QUEUE: usize = 16;

/// How often the thread looks whether it is to stop.
const LOOK_PERIOD: Duration = Duration::from_millis(100);

/// Outputs that other robots may listen to.
#[derive(Default)]
pub(super) struct Outputs {
    wake: Arc<Wake>,
    outputs: Vec<Output>,
}

struct Output {
    component: String,
    port: String,
    layout_hash: u64,
    receiver: Receiver,
}

/// The outputs with their places in the network.
pub(super) struct Sending {
    wake: Arc<Wake>,
    outputs: Vec<(Output, Outlet)>,
    shared: Arc<Shared>,
}

impl Outputs {
    /// One more output; returns what its component writes to. None for a port without data.
    pub(super) fn connect(
        &mut self,
        component: String,
        port: &PortDescription,
    ) -> Option<(Sender, Option<Arc<Wake>>)> {
        let data_type = port.data_type.as_ref()?;
        let (sender, receiver) = connection(QueuePolicy::Fifo, QUEUE, data_type.size);
        self.outputs.push(Output {
            component,
            port: port.name.clone(),
            layout_hash: data_type.layout_hash,
            receiver,
        });
        Some((sender, Some(Arc::clone(&self.wake))))
    }

    pub(super) fn offer(self, node: &Node, shared: &Arc<Shared>) -> Result<Sending, NodeError> {
        let robot = &shared.robot;
        let outputs = self.outputs.into_iter().map(|output| {
            let outlet = node.offer(robot, &output.component, &output.port)?;
            Ok((output, outlet))
        });
        Ok(Sending {
            wake: self.wake,
            outputs: outputs.collect::<Result<_, _>>()?,
            shared: Arc::clone(shared),
        })
    }
}

impl Sending {
    /// What ends the thread's sleep.
    pub(super) fn wake(&self) -> Arc<Wake> {
        Arc::clone(&self.wake)
    }

    /// Sends what arrives until it is to stop.
    pub(super) fn run(mut self) {
        let mut frame = Vec::new();
        while !self.shared.stopping.load(Ordering::Acquire) {
            let _asked = self.wake.take();
            self.send_all(&mut frame);
            self.wake.sleep(LOOK_PERIOD);
        }
    }

    fn send_all(&mut self, frame: &mut Vec<u8>) {
        for (output, outlet) in &mut self.outputs {
            while let Some(datum) = output.receiver.receive() {
                let header = Header {
                    layout_hash: output.layout_hash,
                    term: self.shared.term.load(Ordering::Relaxed),
                    incarnation: self.shared.incarnation,
                    stamp_ns: datum.stamp_ns(),
                };
                frame::encode(&header, datum.bytes(), frame);
                // A session that takes nothing has ended: the others see that this robot has gone.
                let _ended = outlet.send(frame);
            }
        }
    }
}
