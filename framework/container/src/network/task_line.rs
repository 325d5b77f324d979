//! A task that robots do together, in the network: what they tell each other, and data of its links.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use crossbeam::channel::{Receiver as Channel, bounded};
use robot_network::task::{TaskContent, TaskMessage};
use robot_network::{Inlet, Node, NodeError};
use system_model::data_type::DataType;
use system_model::task::{RobotIndex, TaskSpecification};

use super::gate::{Entrance, Gate};
use super::outputs::Ways;
use super::shared::Shared;
use crate::adaptation::{Hop, Passage, Teammates, description};
use crate::port::{ConnectionId, Newest, Receiver, Sender};
use crate::wake::Wake;

/// Messages that may wait: a decision on a thousand candidates asks and answers no faster than it is
/// worked off; what finds no room has no answer, which is a candidate out.
const MESSAGES: usize = 1024;

/// Foreign tasks that are put on record; more say nothing new.
const FOREIGN_TASKS: usize = 64;

/// The ways into inputs that links of tasks have now.
#[derive(Default)]
pub(super) struct Gates(Mutex<GatesByName>);

/// By whom data come, and the link's name.
type GatesByName = BTreeMap<(String, String), (Arc<Gate>, ConnectionId)>;

/// This container's end of a task.
pub(super) struct TaskLine {
    node: Weak<Node>,
    shared: Arc<Shared>,
    ways: Ways,
    /// Tells the task apart.
    task: String,
    /// Names of its robots.
    robots: Vec<String>,
    messages: Channel<(String, TaskMessage)>,
    wake: Arc<Wake>,
    /// What leads out.
    out: Vec<(Hop, ConnectionId)>,
    _inlets: [Inlet; 2],
}

impl TaskLine {
    /// Listens for what concerns a task.
    pub(super) fn new(
        node: &Arc<Node>,
        shared: &Arc<Shared>,
        ways: Ways,
        task: &TaskSpecification,
    ) -> Result<Self, NodeError> {
        let fingerprint = robot_network::task::fingerprint(&description(task));
        let (sender, messages) = bounded(MESSAGES);
        let wake = shared.wake_of_tasks();
        shared.tasks().own.insert(fingerprint.clone());
        let (own, told, at) = (fingerprint.clone(), Arc::clone(&wake), Arc::clone(shared));
        let tasks = node.listen_to_tasks(&shared.robot, move |robot, message| match message {
            Ok(message) if message.task == own => {
                // Full: whoever waits for an answer has a deadline.
                let _lost = sender.try_send((robot.to_owned(), message));
                told.wake();
            }
            Ok(message) => at.look_at_task(robot, &message.task),
            Err(error) => at.record(robot, "unintelligible", error.to_string()),
        })?;
        let (own, at) = (format!("{fingerprint}/"), Arc::clone(shared));
        let flows = node.listen_to_flows(&shared.robot, move |robot, name, frame| {
            if !name.starts_with(&own) {
                return;
            }
            let gates = at.gates.lock();
            let gate = gates.get(&(robot.to_owned(), name.to_owned()));
            let gate = gate.map(|(gate, _)| Arc::clone(gate));
            drop(gates);
            if let Some(gate) = gate {
                gate.take(robot, frame, &at);
            }
        })?;
        Ok(Self {
            node: Arc::downgrade(node),
            shared: Arc::clone(shared),
            ways,
            task: fingerprint,
            robots: task.robots.iter().map(|it| it.name.clone()).collect(),
            messages,
            wake,
            out: Vec::new(),
            _inlets: [tasks, flows],
        })
    }

    fn key(&self, hop: &Hop) -> (String, String) {
        let (from, to) = (hop.from.component, hop.to.component);
        let name = format!("{}/{}/{from}/{to}", self.task, hop.link);
        (self.robots[hop.from.robot].clone(), name)
    }

    fn robot(&self, name: &str) -> Option<RobotIndex> {
        self.robots.iter().position(|it| it == name)
    }
}

impl Passage for TaskLine {
    fn send_out(&mut self, hop: &Hop, data_type: &DataType) -> Result<(Sender, Arc<Wake>), String> {
        let (own, name) = self.key(hop);
        let node = self.node.upgrade().ok_or("the network has been left")?;
        let outlet = node.flow_to(&own, &self.robots[hop.to.robot], &name);
        let outlet = outlet.map_err(|error| error.to_string())?;
        let (sender, wake) = self
            .ways
            .open(data_type.layout_hash, data_type.size, outlet);
        self.out.push((*hop, sender.id()));
        Ok((sender, wake))
    }

    fn let_in(&mut self, hop: &Hop, entrance: Entrance) -> Receiver {
        let (gate, receiver) = Gate::new(entrance);
        let entry = (Arc::new(gate), receiver.id());
        self.shared.gates.lock().insert(self.key(hop), entry);
        receiver
    }

    fn newest_ns(&self, hop: &Hop) -> Option<u64> {
        let gates = self.shared.gates.lock();
        gates.get(&self.key(hop))?.0.came_ns()
    }

    fn watched(&self, connection: &ConnectionId) -> Option<Arc<Newest>> {
        let gates = self.shared.gates.lock();
        let (gate, _) = gates.values().find(|(_, id)| id == connection)?;
        Some(Arc::clone(&gate.newest))
    }

    fn close(&mut self, hop: &Hop) -> Option<ConnectionId> {
        let position = self.out.iter().position(|(it, _)| it == hop);
        if let Some(position) = position {
            let (_, connection) = self.out.swap_remove(position);
            self.ways.close(connection.clone());
            return Some(connection);
        }
        self.shared.gates.lock().remove(&self.key(hop));
        None
    }

    fn tell(&mut self, robot: RobotIndex, content: TaskContent) {
        let message = TaskMessage {
            task: self.task.clone(),
            term: self.shared.term.load(Ordering::Relaxed),
            incarnation: self.shared.incarnation,
            content,
        };
        let told = self
            .node
            .upgrade()
            .map(|node| node.tell(&self.shared.robot, &self.robots[robot], &message));
        if let Some(Err(error)) = told {
            let robot = &self.robots[robot];
            self.shared.record(robot, "unreachable", error.to_string());
        }
    }

    fn heard(&mut self) -> Option<(RobotIndex, TaskMessage)> {
        loop {
            let (robot, message) = self.messages.try_recv().ok()?;
            if let Some(robot) = self.robot(&robot) {
                return Some((robot, message));
            }
        }
    }

    fn team(&self) -> Teammates {
        let team = self.shared.team();
        let alive = team.alive.iter().filter_map(|name| self.robot(name));
        Teammates {
            decider: team.decider.as_ref().and_then(|name| self.robot(name)),
            term: self.shared.term.load(Ordering::Relaxed),
            alive: alive.collect(),
        }
    }

    fn wake(&self) -> Arc<Wake> {
        Arc::clone(&self.wake)
    }
}

/// Tasks that this container's robot does, and those of others that it has put on record.
#[derive(Default)]
pub(super) struct Tasks {
    own: BTreeSet<String>,
    foreign: BTreeSet<(String, String)>,
}

impl Shared {
    fn tasks(&self) -> MutexGuard<'_, Tasks> {
        self.tasks.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts on record that a robot does a task that is not one of this robot's, once all of these are
    /// known: mostly one of the two has another edition of the file.
    fn look_at_task(&self, robot: &str, task: &str) {
        if self.team().decider.is_none() {
            return;
        }
        let mut tasks = self.tasks();
        let has_room = tasks.foreign.len() < FOREIGN_TASKS;
        let foreign = (robot.to_owned(), task.to_owned());
        if !tasks.own.contains(task) && has_room && tasks.foreign.insert(foreign) {
            drop(tasks);
            let message = "it does a task that is none of this robot's; where it should be the same, give \
                           both robots the same task file";
            self.record(robot, "foreign_task", message.to_owned());
        }
    }
}

impl Gates {
    fn lock(&self) -> MutexGuard<'_, GatesByName> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A robot is dead.
    pub(super) fn died(&self, robot: &str) {
        let gates = self.lock();
        let of = gates.iter().filter(|((from, _), _)| from == robot);
        for (_, (gate, _)) in of {
            gate.died(robot);
        }
    }
}
