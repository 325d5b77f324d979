//! What comes in by the network: one gate for each input, whatever robots feed it.

use std::sync::Arc;

use robot_network::{Inlet, Node, NodeError};
use system_model::network::RemoteInput;
use system_model::specification::{
    ApplicationSpecification, ExecutionKind, PortReference, QueuePolicy,
};

use super::gate::{Entrance, Gate};
use super::shared::Shared;
use crate::assembly::Assembly;
use crate::library::PortDescription;
use crate::port::{Newest, Receiver};

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
                let entrance = entrance(application, assembly, target, port)?;
                let (gate, receiver) = Gate::new(entrance);
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
            source.gate.died(robot);
        }
    }
}

fn entrance(
    application: &ApplicationSpecification,
    assembly: &Assembly,
    target: &PortReference,
    port: &PortDescription,
) -> Option<Entrance> {
    let component = &application.components[target.component];
    let declared = component.ports.iter().find(|it| it.name == target.port);
    let (policy, length) = declared.map_or((QueuePolicy::Last, 1), |it| (it.queue, it.queue_size));
    let executor = assembly.executors.iter().find(|executor| {
        let mut members = executor.members.iter();
        members.any(|member| usize::try_from(member.number) == Ok(target.component))
    });
    let woken = executor.filter(|executor| executor.kind == ExecutionKind::Aperiodic);
    Some(Entrance {
        name: format!("{}.{}", component.name, target.port),
        data_type: port.data_type.clone()?,
        policy,
        length,
        wake: woken.map(|executor| Arc::clone(&executor.wake)),
        watched: None,
    })
}
