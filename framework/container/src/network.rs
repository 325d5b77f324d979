//! This container among those of other robots: what leaves by the network, what comes in by it, and
//! who is alive there.
//!
//! Outputs that are offered have one more connection, to a thread that sends what arrives there;
//! so a component that writes pays what it pays for any other reader. What comes is put into the
//! connection of an input by the network's own thread, if the fence of that input lets it pass. When
//! a robot dies what it has sent counts as if it had come at the beginning of the run: its dependents
//! are judged by their own rules.

mod answers;
mod gate;
mod inputs;
mod outputs;
mod shared;
mod task_line;
mod team;

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crossbeam::channel::{Receiver as Channel, bounded};
use robot_network::package::Machine;
use robot_network::{Node, NodeError, OpenOptions};
use system_model::network::NetworkSpecification;
use system_model::specification::{ApplicationSpecification, PortReference};
use system_model::task::TaskSpecification;

use crate::adaptation::Passage;
use crate::assembly::Assembly;
use crate::component::{Environment, PortEnd};
use crate::event_log::{Event, EventLog};
use crate::lane::SETUP_TOKEN;
use crate::library::PortDescription;
use crate::system::StartError;
use crate::wake::Wake;
use answers::Holdings;
pub use gate::Entrance;
use inputs::RemoteInputs;
use outputs::{Outputs, Ways};
use shared::Shared;
use task_line::{Gates, TaskLine};
use team::Team;

/// Verdicts that may wait to be told to other robots; what finds no room is on record here.
const VERDICTS: usize = 256;

/// The place in the network of the application of this number, and the verdicts that go there.
pub struct Place {
    application: usize,
    specification: NetworkSpecification,
    verdicts: Channel<(u64, Event)>,
}

/// Lets the network hear the verdicts of a log, if an application, given by its number, is in one.
pub fn hear(
    events: EventLog,
    network: Option<(usize, NetworkSpecification)>,
) -> (EventLog, Option<Place>) {
    let (listener, verdicts) = bounded(VERDICTS);
    let events = events.heard_by(network.is_some().then_some(listener));
    let place = network.map(|(application, specification)| Place {
        application,
        specification,
        verdicts,
    });
    (events, place)
}

/// Connects the ports of an application that is in a network; `firsts` says with which component of
/// the assembly each application begins.
pub fn connect(
    place: Option<Place>,
    firsts: &[usize],
    application: &ApplicationSpecification,
    assembly: &Assembly,
) -> Option<NetworkPorts> {
    let place = place?;
    let first = firsts.get(place.application).copied().unwrap_or_default();
    Some(NetworkPorts::connect(place, first, application, assembly))
}

/// Enters the network, if there are ports that lead into one.
///
/// # Errors
/// When the network refuses.
pub fn enter(
    ports: Option<NetworkPorts>,
    environment: &Arc<Environment>,
) -> Result<Option<Network>, StartError> {
    let entered = ports.map(|ports| ports.enter(environment));
    entered.transpose().map_err(StartError::Network)
}

/// The ports that lead into the network, connected, before anything of it is entered.
pub struct NetworkPorts {
    first: usize,
    specification: NetworkSpecification,
    verdicts: Channel<(u64, Event)>,
    outputs: Outputs,
    inputs: RemoteInputs,
    holdings: Holdings,
}

/// This container in the network.
pub struct Network {
    stopping: Arc<AtomicBool>,
    wake: Arc<Wake>,
    threads: Vec<JoinHandle<()>>,
    /// First component of the application that is in it.
    first: usize,
    node: Arc<Node>,
    shared: Arc<Shared>,
    ways: Ways,
}

impl NetworkPorts {
    /// Connects the ports. The specification counts components from `first` of the assembly's on.
    fn connect(
        place: Place,
        first: usize,
        application: &ApplicationSpecification,
        assembly: &Assembly,
    ) -> Self {
        let mut specification = place.specification;
        let inputs = specification
            .remote_inputs
            .iter_mut()
            .map(|it| &mut it.target);
        for end in specification.offers.iter_mut().chain(inputs) {
            end.component += first;
        }
        let name = |end: &PortReference| application.components[end.component].name.clone();
        let mut outputs = Outputs::default();
        for end in &specification.offers {
            if let Some((index, port)) = port(assembly, end) {
                let connected = outputs.connect(name(end), port);
                with_port(assembly, end, index, |end| {
                    if let (PortEnd::DataOutput(output), Some(connection)) = (end, connected) {
                        output.connections.push(connection);
                    }
                });
            }
        }
        let mut inputs = RemoteInputs::default();
        for remote in &specification.remote_inputs {
            let end = &remote.target;
            if let Some((index, port)) = port(assembly, end) {
                let receiver = inputs.connect(application, assembly, remote, port);
                with_port(assembly, end, index, |end| {
                    if let (PortEnd::DataInput(input), Some((receiver, newest))) = (end, receiver) {
                        input.source = Some(receiver);
                        input.newest_from_afar = Some(newest);
                    }
                });
            }
        }
        Self {
            first,
            holdings: Holdings::new(&specification, application, assembly),
            specification,
            verdicts: place.verdicts,
            outputs,
            inputs,
        }
    }

    /// Enters the network.
    ///
    /// # Errors
    /// When an address cannot be had, or the machine has no thread left.
    fn enter(self, environment: &Arc<Environment>) -> Result<Network, NodeError> {
        let incarnation = incarnation();
        let specification = self.specification;
        let node = Node::open(
            &OpenOptions {
                robot: specification.robot.clone(),
                incarnation,
                listen: specification.listen,
                connect: specification.connect,
                scouting: specification.scouting,
                silence_limit: specification.silence_limit,
                security: specification.security,
            },
            self.holdings,
        )?;
        let shared = Arc::new(Shared {
            robot: specification.robot,
            incarnation,
            term: AtomicU64::new(0),
            stopping: Arc::default(),
            environment: Arc::clone(environment),
            gates: Gates::default(),
            tasks: Mutex::default(),
            team: Mutex::default(),
            wakes: Mutex::default(),
        });
        let node = Arc::new(node);
        let sending = self.outputs.offer(&node, &shared)?;
        let inputs = self.inputs.listen(&node, &shared)?;
        let mut network = Network {
            stopping: Arc::clone(&shared.stopping),
            wake: sending.wake(),
            threads: Vec::new(),
            first: self.first,
            node: Arc::clone(&node),
            shared: Arc::clone(&shared),
            ways: sending.ways(),
        };
        let team = Team::new(
            node,
            inputs,
            self.verdicts,
            shared,
            specification.silence_limit,
        );
        network.start("network-send", move || sending.run())?;
        network.start("network-team", move || team.run())?;
        Ok(network)
    }
}

/// The machine that this container runs on, as packages name it.
pub fn this_machine() -> Machine {
    Machine {
        architecture: format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
        abi: component_abi::ABI_MAJOR,
    }
}

impl Network {
    /// Name of this robot, and the first component of the application that is in the network.
    pub fn robot(&self) -> (&str, usize) {
        (&self.shared.robot, self.first)
    }

    /// The way to other robots for a task.
    ///
    /// # Errors
    /// When the network does not take it.
    pub fn passage(&self, task: &TaskSpecification) -> Result<Box<dyn Passage>, NodeError> {
        let line = TaskLine::new(&self.node, &self.shared, self.ways.clone(), task)?;
        Ok(Box::new(line))
    }

    fn start(&mut self, name: &str, run: impl FnOnce() + Send + 'static) -> Result<(), NodeError> {
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(run);
        let thread = thread.map_err(|error| NodeError::Open {
            reason: error.to_string(),
        })?;
        self.threads.push(thread);
        Ok(())
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        self.stopping.store(true, Ordering::Release);
        self.wake.wake();
        for thread in self.threads.drain(..) {
            // Each looks for the wish to stop several times a second; a panic has been printed.
            let _panicked = thread.join();
        }
    }
}

/// Nanoseconds since 1970: later lives have higher numbers, unless the machine's clock was put back
/// in between.
fn incarnation() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(1, |time| u64::try_from(time.as_nanos()).unwrap_or(u64::MAX))
}

fn port<'assembly>(
    assembly: &'assembly Assembly,
    end: &PortReference,
) -> Option<(usize, &'assembly PortDescription)> {
    let ports = assembly.interfaces.get(end.component)?;
    ports
        .iter()
        .enumerate()
        .find(|(_, port)| port.name == end.port)
}

fn with_port(
    assembly: &Assembly,
    end: &PortReference,
    index: usize,
    change: impl FnOnce(&mut PortEnd),
) {
    if let Some(mut component) =
        assembly.components[end.component].enter(SETUP_TOKEN, Duration::ZERO)
        && let Some(port) = component.services_mut().port_mut(index)
    {
        change(port);
    }
}

/// The library's file of a component.
fn library_file(assembly: &Assembly, component: usize) -> Option<PathBuf> {
    let variants = assembly.factories.get(component)?.variants();
    variants.first().map(|variant| variant.path.clone())
}
