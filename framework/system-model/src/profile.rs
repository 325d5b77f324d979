//! What each kind of profile says, one file at a time, before references between files are resolved.

use std::path::PathBuf;
use std::time::Duration;

use crate::mission::DeclaredTree;
use crate::specification::{ExecutionSemantics, Place, PortDirection, PortKind, PortSpecification};

/// A value and the place it was read from.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Located<T> {
    /// The value.
    pub value: T,
    /// Where it stands.
    pub place: Place,
}

/// A profile of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Profile {
    /// `component_profile`.
    Component(Box<ComponentProfile>),
    /// `package_profile`, formerly `application_profile`.
    Application(ApplicationProfile),
    /// `composite_component_profile`.
    Composite(CompositeProfile),
    /// `service_port_type_profile`.
    ServiceTypes(ServiceTypeProfile),
    /// `data_type`.
    DataTypes(DataTypeProfile),
    /// `system_config`, also `system_profile`.
    System(SystemProfile),
    /// `OPRoSProject`.
    Project(ProjectFile),
}

/// What every profile may say of itself.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Header {
    /// The file it was read from.
    pub file: PathBuf,
    /// The profile's name.
    pub name: Located<String>,
    /// Identifier given by the tool that wrote the profile.
    pub id: Option<String>,
    /// Version as written.
    pub version: Option<String>,
    /// Free text.
    pub description: Option<String>,
}

/// `component_profile`: one component type.
#[derive(Debug, Clone, PartialEq)]
pub struct ComponentProfile {
    /// Name, identifier, version, description.
    pub header: Header,
    /// What the component was built for.
    pub environment: ExecutionEnvironment,
    /// How it is executed.
    pub execution: ExecutionSemantics,
    /// `instance_creation`, formerly `creation_type`; informative.
    pub instance_creation: Option<String>,
    /// `lifecycle_type`; informative, every component is started.
    pub lifecycle_type: Option<String>,
    /// Properties in document order; later values win.
    pub properties: Vec<Property>,
    /// Files that describe the data types of its ports.
    pub data_type_files: Vec<Located<String>>,
    /// Files that describe the service types of its ports.
    pub service_type_files: Vec<Located<String>>,
    /// Ports in document order.
    pub ports: Vec<PortProfile>,
}

/// `execution_environment`: what a component was built for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ExecutionEnvironment {
    /// Operating systems it is meant for.
    pub operating_systems: Vec<OperatingSystem>,
    /// Processor it is meant for.
    pub cpu: Option<String>,
    /// `dll` or `so`.
    pub library_type: Option<String>,
    /// File name of the library as written.
    pub library_name: Option<Located<String>>,
    /// Programming language.
    pub implementation_language: Option<String>,
    /// Compiler.
    pub compiler: Option<String>,
}

/// `os` of an execution environment.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct OperatingSystem {
    /// Name as written.
    pub name: String,
    /// Version as written.
    pub version: String,
}

/// A property: a text handed to the component before it is initialised.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Property {
    /// Name.
    pub name: Located<String>,
    /// Type as written; informative.
    pub data_type: String,
    /// Value as written.
    pub value: String,
}

/// A port and the file that describes its type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PortProfile {
    /// The port itself.
    pub port: PortSpecification,
    /// File that describes the data or service type.
    pub reference: Option<Located<String>>,
}

/// `package_profile`: one application.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ApplicationProfile {
    /// Name, identifier, version, description.
    pub header: Header,
    /// Components and composites, in document order.
    pub subcomponents: Vec<Subcomponent>,
    /// Connections between them.
    pub connections: Vec<PortConnection>,
    /// Who runs only after whom.
    pub coordination: Vec<CoordinationRule>,
    /// File of the simulated world that the application drives in.
    pub world: Option<Located<String>>,
    /// How the robot enters the network.
    pub network: Option<Box<NetworkProfile>>,
    /// Behaviour trees, in document order.
    pub trees: Vec<TreeReference>,
}

/// `tree`: a behaviour tree that acts on the application's components.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TreeReference {
    /// File of the tree.
    pub file: Located<String>,
    /// ID of the tree in it; without it the one that the file names.
    pub main: Option<Located<String>>,
    /// All else.
    pub declared: DeclaredTree,
}

/// `network`: how a robot enters the network, and which ports lead into it.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkProfile {
    /// Name of the robot.
    pub robot: Located<String>,
    /// Addresses that it listens at.
    pub listen: Vec<String>,
    /// Addresses of other robots.
    pub connect: Vec<String>,
    /// Whether other robots are looked for by multicast.
    pub scouting: bool,
    /// Who is silent for so long is dead.
    pub silence_limit: Duration,
    /// How connections are secured.
    pub tls: Option<TlsProfile>,
    /// Robots that may speak.
    pub allowed: Vec<Located<String>>,
    /// Folder with sealed packages of components, as written.
    pub packages: Option<String>,
    /// Outputs that other robots may listen to.
    pub offers: Vec<ConnectionEnd>,
    /// Inputs that other robots feed.
    pub connections: Vec<RemoteConnection>,
    /// Components that other robots send.
    pub fetches: Vec<FetchProfile>,
}

/// `fetch`: a component that another robot sends if this one lacks it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FetchProfile {
    /// The component, by the name of its package; its profile is `COMPONENT.xml`.
    pub component: Located<String>,
    /// The robot that has it.
    pub robot: Located<String>,
    /// File with the public keys that are trusted, as written.
    pub key: Located<String>,
    /// How long the start waits for it.
    pub limit: Duration,
}

/// `tls`: files that connections are secured with, as written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TlsProfile {
    /// The robot's certificate.
    pub certificate: Located<String>,
    /// Its private key.
    pub private_key: Located<String>,
    /// Certificate of the authority that has signed the certificates of all robots.
    pub authority: Located<String>,
}

/// `remote_connection`: an input that another robot feeds.
#[derive(Debug, Clone, PartialEq)]
pub struct RemoteConnection {
    /// The other robot.
    pub robot: Located<String>,
    /// An output of it.
    pub source: ConnectionEnd,
    /// An input of this robot.
    pub target: ConnectionEnd,
}

/// `composite_component_profile`: components that are used as one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CompositeProfile {
    /// Name, identifier, version, description.
    pub header: Header,
    /// Components and composites, in document order.
    pub subcomponents: Vec<Subcomponent>,
    /// Connections between them.
    pub connections: Vec<PortConnection>,
    /// Who runs only after whom.
    pub coordination: Vec<CoordinationRule>,
    /// Ports of members that can be connected from outside.
    pub exports: Vec<ExportPort>,
}

/// One instance in an application or composite.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Subcomponent {
    /// Instance name.
    pub name: Located<String>,
    /// File of the component's or composite's profile.
    pub reference: Located<String>,
    /// Node it belongs to; empty means the local one.
    pub node: String,
    /// Properties that win over those of the profile.
    pub properties: Vec<Property>,
}

/// A connection as an application or composite declares it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PortConnection {
    /// Kind of both ports.
    pub kind: Located<PortKind>,
    /// The output or required end.
    pub source: ConnectionEnd,
    /// The input or provided end.
    pub target: ConnectionEnd,
}

/// One end of a connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConnectionEnd {
    /// Instance name.
    pub component: Located<String>,
    /// Port name.
    pub port: Located<String>,
}

/// `coordination/depends`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CoordinationRule {
    /// Runs only in cycles after the target has run.
    pub source: Located<String>,
    /// What is waited for.
    pub target: Located<String>,
}

/// A port of a member that a composite offers as its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportPort {
    /// Name from outside.
    pub name: Located<String>,
    /// The member and its port.
    pub member: ConnectionEnd,
    /// Kind of the port.
    pub kind: Located<PortKind>,
    /// Which way it faces.
    pub direction: Located<PortDirection>,
}

/// `service_port_type_profile`: types of service ports.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ServiceTypeProfile {
    /// The file it was read from.
    pub file: PathBuf,
    /// Types in document order.
    pub types: Vec<ServiceType>,
}

/// One type of service port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServiceType {
    /// Name of the type.
    pub name: Located<String>,
    /// Its methods.
    pub methods: Vec<ServiceMethod>,
}

/// One method of a service.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServiceMethod {
    /// Name.
    pub name: Located<String>,
    /// Type as written.
    pub return_type: String,
    /// Whether the caller waits.
    pub call: CallType,
    /// Parameters in document order.
    pub parameters: Vec<ServiceParameter>,
}

/// Whether the caller of a service method waits for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CallType {
    /// The caller waits.
    #[default]
    Blocking,
    /// The call is queued.
    Nonblocking,
}

/// One parameter of a service method.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServiceParameter {
    /// Position, counted from 1, as written.
    pub index: String,
    /// Name.
    pub name: String,
    /// Type as written.
    pub data_type: String,
    /// Default value as written.
    pub default: Option<String>,
}

/// `data_type`: structures that data ports carry.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct DataTypeProfile {
    /// The file it was read from.
    pub file: PathBuf,
    /// Structures in document order.
    pub structures: Vec<Structure>,
}

/// One structure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Structure {
    /// Name.
    pub name: Located<String>,
    /// Fields in document order.
    pub fields: Vec<Field>,
}

/// One field of a structure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Name.
    pub name: Located<String>,
    /// Type as written.
    pub data_type: String,
    /// Default value as written.
    pub default: Option<String>,
}

/// A named setting of a system file, text as written.
pub type Setting = (String, String);

/// `system_config`: the engine's own settings.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SystemProfile {
    /// The file it was read from.
    pub file: PathBuf,
    /// `system_props`.
    pub properties: Vec<Setting>,
    /// `logger_factory`.
    pub loggers: Vec<Logger>,
    /// `package_deployer`: which applications are started.
    pub deployment: Deployment,
    /// Name of this node.
    pub local_node: Option<Located<String>>,
    /// The nodes that this one knows.
    pub nodes: Vec<NodeAddress>,
    /// Threads that serve remote calls.
    pub io_workers: Option<u32>,
    /// Threads that run nonblocking calls, least and most.
    pub nonblocking_workers: Option<(u32, u32)>,
    /// `io_manager`: where the node listens.
    pub channels: Vec<Channel>,
    /// `mwadaptor_manager`.
    pub middleware: Vec<Setting>,
}

/// One logger of a system file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Logger {
    /// Name.
    pub name: String,
    /// `file`, `cout` or `cerr`.
    pub sink: String,
    /// Whether it writes at all.
    pub enabled: bool,
    /// Level, file and directory.
    pub settings: Vec<Setting>,
}

/// `package_deployer`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Deployment {
    /// Which applications are loaded at the start.
    pub load: LoadPolicy,
    /// The list for [`LoadPolicy::List`].
    pub applications: Vec<Located<String>>,
}

/// `load.type` of a package deployer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum LoadPolicy {
    /// None.
    #[default]
    None,
    /// All that are deployed.
    All,
    /// Those that are listed, in order.
    List,
}

/// A node that a system file knows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NodeAddress {
    /// Identifier, an opaque text.
    pub id: Located<String>,
    /// Protocol as written.
    pub protocol: String,
    /// Address, port and backlog.
    pub settings: Vec<Setting>,
}

/// One channel of the `io_manager`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Identifier.
    pub id: Located<String>,
    /// Protocol as written.
    pub protocol: String,
    /// `server` or `client`.
    pub role: String,
    /// Whether it is opened.
    pub enabled: bool,
    /// Address, port, handlers.
    pub settings: Vec<Setting>,
}

/// `OPRoSProject`: a file of the drawing tool, not a profile.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ProjectFile {
    /// The file it was read from.
    pub file: PathBuf,
    /// Project name.
    pub name: Located<String>,
    /// Folder of the sources.
    pub source_folder: String,
    /// Folder of the binaries.
    pub binary_folder: String,
    /// Programming language.
    pub language: String,
    /// Workspace folder.
    pub location: String,
    /// Components of the project.
    pub components: Vec<String>,
}
