//! What leaves by the network.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use crossbeam::channel::{Receiver as Channel, Sender as ChannelSender, unbounded};
use robot_network::frame::{self, Header};
use robot_network::{Node, NodeError, Outlet};
use system_model::specification::QueuePolicy;

use super::shared::Shared;
use crate::library::PortDescription;
use crate::port::{ConnectionId, Receiver, Sender, connection};
use crate::wake::Wake;

/// Data that may wait to be sent: a second and a half of a port that is written a hundred times a
/// second while the network stands still.
const QUEUE: usize = 16;

/// How often the thread looks whether it is to stop.
const LOOK_PERIOD: Duration = Duration::from_millis(100);

/// Outputs that other robots may listen to.
pub(super) struct Outputs {
    outputs: Vec<(String, String, Way)>,
    ways: Ways,
    orders: Channel<Order>,
}

/// The way of one output into the network, without its place there.
struct Way {
    layout_hash: u64,
    receiver: Receiver,
}

enum Order {
    Add(Box<(Way, Outlet)>),
    Remove(ConnectionId),
}

/// By which more ways are opened and closed while the container runs.
#[derive(Clone)]
pub(super) struct Ways {
    wake: Arc<Wake>,
    /// Without a bound: there are no more orders than changes of what runs, and each is taken within
    /// a tenth of a second.
    orders: ChannelSender<Order>,
}

/// The outputs with their places in the network.
pub(super) struct Sending {
    ways: Ways,
    outputs: Vec<(Way, Outlet)>,
    orders: Channel<Order>,
    shared: Arc<Shared>,
}

impl Ways {
    /// Opens a way to a place; what is written to the sender goes there, and the wake tells of it.
    pub(super) fn open(
        &self,
        layout_hash: u64,
        size: usize,
        outlet: Outlet,
    ) -> (Sender, Arc<Wake>) {
        let (sender, receiver) = connection(QueuePolicy::Fifo, QUEUE, size);
        let way = Way {
            layout_hash,
            receiver,
        };
        self.order(Order::Add(Box::new((way, outlet))));
        (sender, Arc::clone(&self.wake))
    }

    /// Nothing goes by this way any more.
    pub(super) fn close(&self, connection: ConnectionId) {
        self.order(Order::Remove(connection));
    }

    fn order(&self, order: Order) {
        // The thread ends with the container.
        let _ended = self.orders.send(order);
        self.wake.wake();
    }
}

impl Default for Outputs {
    fn default() -> Self {
        let (sender, orders) = unbounded();
        let ways = Ways {
            wake: Arc::default(),
            orders: sender,
        };
        Self {
            outputs: Vec::new(),
            ways,
            orders,
        }
    }
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
        let way = Way {
            layout_hash: data_type.layout_hash,
            receiver,
        };
        self.outputs.push((component, port.name.clone(), way));
        Some((sender, Some(Arc::clone(&self.ways.wake))))
    }

    pub(super) fn offer(self, node: &Node, shared: &Arc<Shared>) -> Result<Sending, NodeError> {
        let robot = &shared.robot;
        let outputs = self.outputs.into_iter().map(|(component, port, way)| {
            let outlet = node.offer(robot, &component, &port)?;
            Ok((way, outlet))
        });
        Ok(Sending {
            ways: self.ways,
            outputs: outputs.collect::<Result<_, _>>()?,
            orders: self.orders,
            shared: Arc::clone(shared),
        })
    }
}

impl Sending {
    /// What ends the thread's sleep.
    pub(super) fn wake(&self) -> Arc<Wake> {
        Arc::clone(&self.ways.wake)
    }

    /// By which more ways are opened.
    pub(super) fn ways(&self) -> Ways {
        self.ways.clone()
    }

    /// Sends what arrives until it is to stop.
    pub(super) fn run(mut self) {
        let mut frame = Vec::new();
        while !self.shared.stopping.load(Ordering::Acquire) {
            let _asked = self.ways.wake.take();
            self.take_orders();
            self.send_all(&mut frame);
            self.ways.wake.sleep(LOOK_PERIOD);
        }
    }

    fn take_orders(&mut self) {
        for order in self.orders.try_iter() {
            match order {
                Order::Add(added) => self.outputs.push(*added),
                Order::Remove(id) => self.outputs.retain(|(way, _)| way.receiver.id() != id),
            }
        }
    }

    fn send_all(&mut self, frame: &mut Vec<u8>) {
        for (way, outlet) in &mut self.outputs {
            while let Some(datum) = way.receiver.receive() {
                let header = Header {
                    layout_hash: way.layout_hash,
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
