//! What the container assembles: one application, composites flattened, every name resolved.
//!
//! A specification is complete and consistent by construction: `system-profile` has checked every
//! reference, so the container validates only what the libraries themselves say.

use std::path::PathBuf;
use std::time::Duration;

use crate::mission::DeclaredTree;

/// A place in a file that a person wrote.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Place {
    /// The file, as the user named it or as it was found.
    pub file: PathBuf,
    /// Line, counted from 1; 0 where a whole file is meant.
    pub line: u32,
    /// Column in characters, counted from 1.
    pub column: u32,
}

impl std::fmt::Display for Place {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.line {
            0 => write!(formatter, "{}", self.file.display()),
            line => write!(formatter, "{}:{line}:{}", self.file.display(), self.column),
        }
    }
}

/// One application, ready to be assembled.
#[derive(Debug, Clone, PartialEq)]
pub struct ApplicationSpecification {
    /// The application's name.
    pub name: String,
    /// The file it was read from.
    pub file: PathBuf,
    /// All components, composites flattened, in document order.
    pub components: Vec<ComponentSpecification>,
    /// All connections between them.
    pub connections: Vec<ConnectionSpecification>,
    /// All connections with the fault manager.
    pub manager_connections: Vec<ManagerConnection>,
    /// `coordination/depends`: `(source, target)` as indices into `components`; the source runs only
    /// in cycles after the target has run.
    pub coordination: Vec<(usize, usize)>,
    /// The simulated world that the application drives in (`<world><reference>`), if any.
    pub world: Option<PathBuf>,
    /// Its behaviour trees, in document order.
    pub trees: Vec<DeclaredTree>,
}

/// One component instance.
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentSpecification {
    /// Instance name, unique in the application; members of a composite read `composite/member`.
    pub name: String,
    /// Name of the component type: the `name` of its profile.
    pub type_name: String,
    /// The component profile it was read from.
    pub profile: PathBuf,
    /// Where the application names it.
    pub place: Place,
    /// `execution_environment/library_name` as written; the container searches for the file.
    pub library: String,
    /// How it is executed.
    pub execution: ExecutionSemantics,
    /// Properties in document order, the subcomponent's own values last; later values win.
    pub properties: Vec<(String, String)>,
    /// Ports as the profile declares them.
    pub ports: Vec<PortSpecification>,
    /// `node_id`; empty means the local node.
    pub node: String,
}

/// How a component is run (facts sheet A1, A6).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExecutionSemantics {
    /// Which executor runs it.
    pub kind: ExecutionKind,
    /// Period of a periodic executor; zero for passive and aperiodic ones.
    pub period: Duration,
    /// Thread priority, 0 (lowest) to 99.
    pub priority: u8,
    /// Scheduling policy asked of the operating system.
    pub policy: SchedulingPolicy,
}

/// Which executor runs a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ExecutionKind {
    /// Never executed; its services and events are served.
    Passive,
    /// A thread of its own (`periodic`, `periodic-exclusive`).
    Periodic,
    /// Shares a thread with components of the same period and priority.
    PeriodicShared,
    /// Runs when a datum or an event arrives.
    Aperiodic,
}

/// `execution_semantics/policy`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SchedulingPolicy {
    /// `SCHED_OTHER`.
    #[default]
    Other,
    /// `SCHED_FIFO`.
    Fifo,
    /// `SCHED_RR`.
    RoundRobin,
}

/// One port as its profile declares it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PortSpecification {
    /// Port name, unique in the component.
    pub name: String,
    /// Data, event or service.
    pub kind: PortKind,
    /// Which way it faces.
    pub direction: PortDirection,
    /// The data type (data and event ports) or service type as written; empty where none is given.
    pub data_type: String,
    /// What an input keeps.
    pub queue: QueuePolicy,
    /// Queue length of FIFO and LIFO inputs, at least 1.
    pub queue_size: usize,
    /// Where the profile declares it.
    pub place: Place,
}

/// The three kinds of port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PortKind {
    /// Asynchronous values of one type.
    Data,
    /// Ordered notifications.
    Event,
    /// Calls.
    Service,
}

impl PortKind {
    /// The word used in profiles.
    pub fn name(self) -> &'static str {
        match self {
            Self::Data => "data",
            Self::Event => "event",
            Self::Service => "service",
        }
    }
}

/// Which way a port faces. A service port that is `required` is `Output` here: the call leaves
/// through it; a `provided` one is `Input`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PortDirection {
    /// `input` of data and event ports, `provided` of service ports.
    Input,
    /// `output` of data and event ports, `required` of service ports.
    Output,
}

/// What an input data port keeps (facts sheet A5).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum QueuePolicy {
    /// Bounded, drops the oldest.
    Fifo,
    /// Bounded, newest first.
    Lifo,
    /// Holds one; each new datum replaces it.
    #[default]
    Last,
}

/// A connection: data and events flow from source to target; calls go from source (required) to
/// target (provided).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConnectionSpecification {
    /// Kind of both ports.
    pub kind: PortKind,
    /// The output (or required) end.
    pub source: PortReference,
    /// The input (or provided) end.
    pub target: PortReference,
    /// Where the application declares it.
    pub place: Place,
}

/// As what connections name the fault manager; no component of an application is called so.
pub const FAULT_MANAGER: &str = "fault_manager";

/// A connection of a component's event port with the fault manager. Its events have no content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ManagerConnection {
    /// The fault manager's end.
    pub manager: ManagerPort,
    /// The component's.
    pub component: PortReference,
    /// Where the application declares it.
    pub place: Place,
}

/// The fault manager's event ports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ManagerPort {
    /// Output `fault`: a fault is confirmed, of whichever component.
    Fault,
    /// Output `emergency_stop`: the emergency stop is engaged.
    EmergencyStop,
    /// Input `fault`: the sender reports a fault of its own.
    ReportedFault,
}

impl ManagerPort {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Fault, Self::EmergencyStop, Self::ReportedFault];

    /// The word in connections.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fault | Self::ReportedFault => "fault",
            Self::EmergencyStop => "emergency_stop",
        }
    }

    /// Which way it faces, seen from the fault manager.
    pub fn direction(self) -> PortDirection {
        match self {
            Self::Fault | Self::EmergencyStop => PortDirection::Output,
            Self::ReportedFault => PortDirection::Input,
        }
    }
}

/// A port of a component of the application.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct PortReference {
    /// Index into `ApplicationSpecification::components`.
    pub component: usize,
    /// Name of the port.
    pub port: String,
}
