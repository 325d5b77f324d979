//! What comes in by the network: one gate for each input, whatever robots feed it.

use std::collections::BTreeSet;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};

use robot_network::{Fence, Inlet, Node, NodeError, frame};
use system_model::network::RemoteInput;
use system_model::specification::{
    ApplicationSpecification, ExecutionKind, PortReference, QueuePolicy,
};

use super::Shared;
use crate::assembly::Assembly;
use crate::library::PortDescription;
use crate::port::{Newest, Receiver, Sender, connection};
use crate::wake::Wake;

/// All data that come by the network are those of one writer: the fence knows the lives of robots.
const INCARNATION: u32 = 1;

/// Refusals that are put on record for one input; more say nothing new.
const REFUSALS_MAXIMUM: usize = 16;

/// As if it had come at the beginning of the run; 0 would mean that nothing has come yet.
const ANCIENT_NS: u64 = 1;

/// Inputs that other robots feed.
#[derive(Default)]
pub(super) struct RemoteInputs {
    gates: Vec<(PortReference, Arc<Gate>)>,
    sources: Vec<Source>,
}

struct Source {
    robot: String,
    component: String,
    port: String,
    gate: Arc<Gate>,
}

/// The way into one input.
struct Gate {
    /// As `component.port`, for a person.
    name: String,
    layout_hash: u64,
    size: usize,
    newest: Arc<Newest>,
    /// What wakes the reader, if data do.
    wake: Option<Arc<Wake>>,
    entry: Mutex<Entry>,
}

struct Entry {
    fence: Fence,
    sender: Sender,
    /// Whom and why it has refused.
    refused: BTreeSet<String>,
}

/// Inputs that are listened for.
pub(super) struct Listening {
    sources: Vec<Source>,
    _inlets: Vec<Inlet>,
}

impl RemoteInputs {
    /// One more source of an input; what its component reads from, if it is the first. None for a
    /// port without data.
    pub(super) fn connect(
        &mut self,
        application: &ApplicationSpecification,
        assembly: &Assembly,
        remote: &RemoteInput,
        port: &PortDescription,
    ) -> Option<(Receiver, Arc<Newest>)> {
        let target = &remote.target;
        let known = self.gates.iter().find(|(end, _)| end == target);
        let (gate, first) = match known {
            Some((_, gate)) => (Arc::clone(gate), None),
            None => {
                let (gate, receiver) = Gate::new(application, assembly, target, port)?;
                let gate = Arc::new(gate);
                self.gates.push((target.clone(), Arc::clone(&gate)));
                let newest = Arc::clone(&gate.newest);
                (gate, Some((receiver, newest)))
            }
        };
        self.sources.push(Source {
            robot: remote.robot.clone(),
            component: remote.component.clone(),
            port: remote.port.clone(),
            gate,
        });
        first
    }

    pub(super) fn listen(self, node: &Node, shared: &Arc<Shared>) -> Result<Listening, NodeError> {
        let inlets = self.sources.iter().map(|source| {
            let (gate, shared) = (Arc::clone(&source.gate), Arc::clone(shared));
            let robot = source.robot.clone();
            let from = (&*source.robot, &*source.component, &*source.port);
            node.listen(from, move |frame| gate.take(&robot, frame, &shared))
        });
        Ok(Listening {
            _inlets: inlets.collect::<Result<_, _>>()?,
            sources: self.sources,
        })
    }
}

impl Listening {
    /// A robot is dead: what it has sent counts as if it had come at the beginning of the run,
    /// unless the input obeys another robot.
    pub(super) fn died(&self, robot: &str) {
        for source in self.sources.iter().filter(|source| source.robot == robot) {
            let mut entry = source
                .gate
                .entry
                .lock()
                .unwrap_or_else(PoisonError::into_inner);
            if entry.fence.died(robot) {
                // Nothing can come between: whoever sends holds the lock.
                source.gate.newest.store(ANCIENT_NS, Ordering::Relaxed);
            }
        }
    }
}

impl Gate {
    fn new(
        application: &ApplicationSpecification,
        assembly: &Assembly,
        target: &PortReference,
        port: &PortDescription,
    ) -> Option<(Self, Receiver)> {
        let data_type = port.data_type.as_ref()?;
        let component = &application.components[target.component];
        let declared = component.ports.iter().find(|it| it.name == target.port);
        let (policy, queue_size) =
            declared.map_or((QueuePolicy::Last, 1), |it| (it.queue, it.queue_size));
        let (mut sender, receiver) = connection(policy, queue_size, data_type.size);
        let executor = assembly.executors.iter().find(|executor| {
            let mut members = executor.members.iter();
            members.any(|member| usize::try_from(member.number) == Ok(target.component))
        });
        let woken = executor.filter(|executor| executor.kind == ExecutionKind::Aperiodic);
        let gate = Self {
            name: format!("{}.{}", component.name, target.port),
            layout_hash: data_type.layout_hash,
            size: data_type.size,
            newest: sender.watch(),
            wake: woken.map(|executor| Arc::clone(&executor.wake)),
            entry: Mutex::new(Entry {
                fence: Fence::default(),
                sender,
                refused: BTreeSet::new(),
            }),
        };
        Some((gate, receiver))
    }

    /// Lets a frame through to the component, or puts on record why not.
    fn take(&self, robot: &str, bytes: &[u8], shared: &Shared) {
        let mut entry = self.entry.lock().unwrap_or_else(PoisonError::into_inner);
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
}
