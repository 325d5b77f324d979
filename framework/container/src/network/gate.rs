//! The way from the network into one input.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use robot_network::{Fence, frame};
use system_model::data_type::DataType;
use system_model::specification::QueuePolicy;

use super::shared::Shared;
use crate::port::{Newest, Receiver, Sender, connection};
use crate::wake::Wake;

/// All data that come by the network are those of one writer: the fence knows the lives of robots.
const INCARNATION: u32 = 1;

/// Refusals that are put on record for one input; more say nothing new.
const REFUSALS_MAXIMUM: usize = 16;

/// As if it had come at the beginning of the run; 0 would mean that nothing has come yet.
const ANCIENT_NS: u64 = 1;

/// An input that gets its data from another robot.
pub struct Entrance {
    /// As `component.port`, for a person.
    pub name: String,
    /// What comes in.
    pub data_type: DataType,
    /// What is kept.
    pub policy: QueuePolicy,
    /// How many data are kept.
    pub length: usize,
    /// What wakes the reader, if data do.
    pub wake: Option<Arc<Wake>>,
    /// Where to leave the time of the newest datum, if somebody asks for it already.
    pub watched: Option<Arc<Newest>>,
}

/// The way into one input.
pub(super) struct Gate {
    name: String,
    layout_hash: u64,
    size: usize,
    /// Where the time of the newest datum is left.
    pub(super) newest: Arc<Newest>,
    /// When the newest came by this way, in nanoseconds of the container's clock; 0 before the first.
    came_ns: AtomicU64,
    wake: Option<Arc<Wake>>,
    entry: Mutex<Entry>,
}

struct Entry {
    fence: Fence,
    sender: Sender,
    /// Whom and why it has refused.
    refused: BTreeSet<String>,
}

impl Gate {
    /// A gate, and what is received behind it.
    pub(super) fn new(entrance: Entrance) -> (Self, Receiver) {
        let Entrance {
            policy,
            length,
            data_type,
            ..
        } = entrance;
        let (mut sender, receiver) = connection(policy, length, data_type.size);
        let newest = match entrance.watched {
            Some(watched) => {
                sender.watch_by(Arc::clone(&watched));
                watched
            }
            None => sender.watch(),
        };
        let gate = Self {
            name: entrance.name,
            layout_hash: data_type.layout_hash,
            size: data_type.size,
            newest,
            came_ns: AtomicU64::new(0),
            wake: entrance.wake,
            entry: Mutex::new(Entry {
                fence: Fence::default(),
                sender,
                refused: BTreeSet::new(),
            }),
        };
        (gate, receiver)
    }

    /// Lets a frame through to the component, or puts on record why not.
    pub(super) fn take(&self, robot: &str, bytes: &[u8], shared: &Shared) {
        let mut entry = self.entry();
        let taken = frame::decode(bytes, self.layout_hash, self.size)
            .map_err(|error| error.to_string())
            .and_then(|(header, datum)| {
                let admitted = entry.fence.admit(header.term, robot, header.incarnation);
                admitted.map(|()| datum).map_err(|error| error.to_string())
            });
        match taken {
            Ok(datum) => {
                let now_ns = shared.environment.clock.now_ns();
                entry.sender.send(now_ns, INCARNATION, |place| {
                    place.copy_from_slice(datum);
                    true
                });
                self.came_ns.store(now_ns, Ordering::Relaxed);
                drop(entry);
                if let Some(wake) = &self.wake {
                    wake.wake();
                }
            }
            Err(reason) => {
                let is_new =
                    entry.refused.len() < REFUSALS_MAXIMUM && entry.refused.insert(reason.clone());
                drop(entry);
                if is_new {
                    shared.record(
                        robot,
                        "refused",
                        format!("data for {}: {reason}", self.name),
                    );
                }
            }
        }
    }

    /// A robot is dead: what it has sent counts as if it had come at the beginning of the run,
    /// unless the input obeys another robot.
    pub(super) fn died(&self, robot: &str) {
        let mut entry = self.entry();
        if entry.fence.died(robot) {
            // Nothing can come between: whoever sends holds the lock.
            self.newest.store(ANCIENT_NS, Ordering::Relaxed);
        }
    }

    /// When the newest datum came by this way, in nanoseconds of the container's clock.
    pub(super) fn came_ns(&self) -> Option<u64> {
        let came_ns = self.came_ns.load(Ordering::Relaxed);
        (came_ns > 0).then_some(came_ns)
    }

    fn entry(&self) -> MutexGuard<'_, Entry> {
        self.entry.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
