//! From a specification to a system that could run: libraries loaded, ports compared and
//! connected, components put into executors. Nothing of any component has run when this is done,
//! and nothing is left half-made when it fails: all problems are listed.

mod connect;
mod executors;

use std::path::PathBuf;
use std::sync::Arc;

use system_model::rules::ComponentRules;
use system_model::specification::{
    ApplicationSpecification, ComponentSpecification, ExecutionKind, Place, PortDirection, PortKind,
};

use crate::component::{
    CallLimits, Calls, Component, ComponentCell, DataOutput, Environment, EventOutput, PortEnd,
    Services,
};
use crate::executor::Executor;
use crate::guard::Guarded;
use crate::library::{
    ComponentDescription, LibraryError, LibrarySearch, LoadedLibrary, PortDescription, probe,
};
use crate::status::ComponentStatus;

/// How libraries are found and loaded.
#[derive(Debug, Clone, Default)]
pub struct LibraryOptions {
    /// Where they are looked for, after the folders of the component's own profile.
    pub search: LibrarySearch,
    /// The executable that loads each library first in a process of its own; `None`: not done.
    pub probe: Option<PathBuf>,
}

/// What is wrong with an application, found before anything of it ran.
#[derive(Debug, thiserror::Error)]
pub enum AssemblyProblem {
    /// A library cannot be used.
    #[error("component '{component}' ({place}): {error}")]
    Library {
        /// Instance name.
        component: String,
        /// Where the application names it.
        place: Place,
        /// Why.
        error: Box<LibraryError>,
    },
    /// The library's ports are not those of the profile, or a connection does not fit.
    #[error("{place}: {message}\n  help: {help}")]
    Connection {
        /// Where it is written.
        place: Place,
        /// What is wrong.
        message: String,
        /// What to do.
        help: String,
    },
    /// The machine has no room for it.
    #[error("component '{component}': no stack for it: {error}")]
    Resources {
        /// Instance name.
        component: String,
        /// The system's words.
        error: std::io::Error,
    },
}

/// An application that could run.
pub struct Assembly {
    /// All components in document order.
    pub components: Vec<Arc<ComponentCell>>,
    /// What the container knows of them, in the same order.
    pub statuses: Vec<Arc<ComponentStatus>>,
    /// The executors; every component is in exactly one.
    pub executors: Vec<Executor>,
}

/// Assembles an application.
///
/// # Errors
/// All problems that were found.
pub fn assemble(
    specification: &ApplicationSpecification,
    options: &LibraryOptions,
    environment: &Arc<Environment>,
) -> Result<Assembly, Vec<AssemblyProblem>> {
    let libraries = load_all(specification, options)?;
    let mut problems = compare_ports(specification, &libraries);
    problems.extend(connect::check(specification, &libraries));
    if !problems.is_empty() {
        return Err(problems);
    }
    let mut components = Vec::new();
    let mut statuses = Vec::new();
    for (number, (component, library)) in
        specification.components.iter().zip(&libraries).enumerate()
    {
        let status = Arc::new(ComponentStatus::new(component.name.clone()));
        match instantiate(component, library, number, environment, &status) {
            Ok(cell) => components.push(Arc::new(cell)),
            Err(problem) => problems.push(problem),
        }
        statuses.push(status);
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let executors = executors::group(specification, &components);
    connect::connect(specification, &libraries, &components, &executors);
    Ok(Assembly {
        components,
        statuses,
        executors,
    })
}

/// Every instance gets a copy of its library of its own: see `LoadedLibrary`.
fn load_all(
    specification: &ApplicationSpecification,
    options: &LibraryOptions,
) -> Result<Vec<LoadedLibrary>, Vec<AssemblyProblem>> {
    let mut loaded = Vec::new();
    let mut problems = Vec::new();
    let mut probed: Vec<PathBuf> = Vec::new();
    for component in &specification.components {
        let beside_profile = component.profile.parent().map(PathBuf::from);
        let search = options.search.preceded_by(beside_profile);
        let result = search.find(&component.library).and_then(|path| {
            if let Some(executable) = &options.probe
                && !probed.contains(&path)
            {
                probe(executable, &path)?;
                probed.push(path.clone());
            }
            LoadedLibrary::load(&path)
        });
        match result {
            Ok(library) => loaded.push(library),
            Err(error) => problems.push(AssemblyProblem::Library {
                component: component.name.clone(),
                place: component.place.clone(),
                error: Box::new(error),
            }),
        }
    }
    if problems.is_empty() {
        Ok(loaded)
    } else {
        Err(problems)
    }
}

/// Compares what profiles declare with what libraries have.
fn compare_ports(
    specification: &ApplicationSpecification,
    libraries: &[LoadedLibrary],
) -> Vec<AssemblyProblem> {
    let mut problems = Vec::new();
    for (component, library) in specification.components.iter().zip(libraries) {
        for declared in &component.ports {
            let actual = find_port(&library.description, &declared.name);
            let mismatch = match actual {
                None => Some("the library has no such port".to_owned()),
                Some(actual) if actual.kind != declared.kind => Some(format!(
                    "in the library it is a {} port",
                    actual.kind.name()
                )),
                Some(actual) if actual.direction != declared.direction => {
                    Some("in the library it faces the other way".to_owned())
                }
                Some(actual) => wrong_type(&declared.data_type, actual),
            };
            if let Some(mismatch) = mismatch {
                problems.push(AssemblyProblem::Connection {
                    place: declared.place.clone(),
                    message: format!(
                        "port '{}' of component '{}': {mismatch}",
                        declared.name, component.name
                    ),
                    help: format!(
                        "the library has {}",
                        list(library.description.ports.iter().map(|port| &port.name))
                    ),
                });
            }
        }
    }
    problems
}

fn wrong_type(declared: &str, actual: &PortDescription) -> Option<String> {
    if actual.kind == PortKind::Service || declared.is_empty() {
        return None;
    }
    let name = actual
        .data_type
        .as_ref()
        .map_or("nothing", |data_type| data_type.name.as_str());
    (name != declared).then(|| {
        format!("the profile says it carries '{declared}', in the library it carries '{name}'")
    })
}

fn find_port<'library>(
    description: &'library ComponentDescription,
    name: &str,
) -> Option<&'library PortDescription> {
    description.ports.iter().find(|port| port.name == name)
}

fn list<Name: AsRef<str>>(names: impl Iterator<Item = Name>) -> String {
    let names: Vec<String> = names.map(|name| format!("'{}'", name.as_ref())).collect();
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    }
}

fn instantiate(
    component: &ComponentSpecification,
    library: &LoadedLibrary,
    number: usize,
    environment: &Arc<Environment>,
    status: &Arc<ComponentStatus>,
) -> Result<ComponentCell, AssemblyProblem> {
    let number = u32::try_from(number).unwrap_or(u32::MAX);
    let guarded =
        Guarded::new(library.description.callbacks, library.code, number).map_err(|error| {
            AssemblyProblem::Resources {
                component: component.name.clone(),
                error,
            }
        })?;
    let services = Services::new(
        Arc::from(component.name.as_str()),
        status.incarnation(),
        Arc::clone(environment),
        library.description.ports.iter().map(unconnected).collect(),
        component.properties.clone(),
    );
    let period = match component.execution.kind {
        ExecutionKind::Periodic | ExecutionKind::PeriodicShared => component.execution.period,
        ExecutionKind::Passive | ExecutionKind::Aperiodic => std::time::Duration::ZERO,
    };
    let mut instance = Component::new(guarded, services, Arc::clone(status), period);
    let limits = CallLimits::by_rules(&ComponentRules::default(), &component.execution);
    instance.set_limits(limits.by_clock(&environment.clock));
    Ok(ComponentCell::new(instance))
}

fn unconnected(port: &PortDescription) -> PortEnd {
    let size = port
        .data_type
        .as_ref()
        .map_or(0, |data_type| data_type.size);
    match (port.kind, port.direction) {
        (PortKind::Data, PortDirection::Input) => PortEnd::DataInput(None, size),
        (PortKind::Data, PortDirection::Output) => PortEnd::DataOutput(DataOutput {
            size,
            connections: Vec::new(),
        }),
        (PortKind::Event, PortDirection::Input) => PortEnd::EventInput,
        (PortKind::Event, PortDirection::Output) => PortEnd::EventOutput(EventOutput {
            size,
            connections: Vec::new(),
        }),
        (PortKind::Service, PortDirection::Output) => PortEnd::Required(Calls {
            methods: Vec::new(),
            provider: None,
        }),
        (PortKind::Service, PortDirection::Input) => PortEnd::Provided,
    }
}
