//! From a specification to a system that could run: libraries loaded, ports compared and
//! connected, components put into executors. Nothing of any component has run when this is done,
//! and nothing is left half-made when it fails: all problems are listed.

mod compare;
mod connect;
mod executors;
mod factory;
mod libraries;
mod secondary;

use std::path::PathBuf;
use std::sync::Arc;

use system_model::rules::{ComponentRules, FaultRules, IsolationTier, Preload};
use system_model::specification::{
    ApplicationSpecification, ComponentSpecification, Place, PortKind,
};

pub use connect::Link;
pub(crate) use connect::{EVENT_QUEUE, wake_of};
pub use factory::{Factory, Variant};
use libraries::Libraries;

use crate::component::{ComponentCell, Environment};
use crate::executor::Executor;
use crate::host::Hosts;
use crate::library::{
    ComponentDescription, LibraryError, LibrarySearch, LoadedLibrary, PortDescription,
};
use crate::status::ComponentStatus;

/// How libraries are found and loaded.
#[derive(Debug, Clone, Default)]
pub struct LibraryOptions {
    /// Where they are looked for, after the folders of the component's own profile.
    pub search: LibrarySearch,
    /// The executable `steadfast`: loads each library first in a process of its own, and runs the
    /// components that a rule puts in one. `None`: neither can be done.
    pub executable: Option<PathBuf>,
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
    #[error(
        "component '{component}': {error}\n  help: see the limits of this user and machine: memory, open files, address space"
    )]
    Resources {
        /// Instance name.
        component: String,
        /// Why.
        error: String,
    },
}

/// An application that could run.
pub struct Assembly {
    /// All components in document order.
    pub components: Vec<Arc<ComponentCell>>,
    /// What the container knows of them, in the same order.
    pub statuses: Vec<Arc<ComponentStatus>>,
    /// Where their successors come from, in the same order.
    pub factories: Vec<Arc<Factory>>,
    /// The executors; every component is in exactly one.
    pub executors: Vec<Executor>,
    /// The types of all data ports, by component and port.
    pub interfaces: Vec<Vec<PortDescription>>,
    /// The connections of data ports.
    pub links: Vec<Link>,
}

/// Assembles an application.
///
/// # Errors
/// All problems that were found.
pub fn assemble(
    specification: &ApplicationSpecification,
    rules: &FaultRules,
    options: &LibraryOptions,
    environment: &Arc<Environment>,
) -> Result<Assembly, Vec<AssemblyProblem>> {
    assemble_together(specification, &[0], rules, options, environment)
}

/// Assembles several applications that are written as one; `firsts` says with which component each
/// of them begins. No two of them share an executor.
///
/// # Errors
/// All problems that were found.
pub fn assemble_together(
    specification: &ApplicationSpecification,
    firsts: &[usize],
    rules: &FaultRules,
    options: &LibraryOptions,
    environment: &Arc<Environment>,
) -> Result<Assembly, Vec<AssemblyProblem>> {
    let mut libraries = Libraries::new(options);
    let primaries = libraries.load_all(&specification.components);
    let secondaries = secondaries(specification, rules, &mut libraries);
    let mut problems = libraries.problems;
    let primaries: Vec<LoadedLibrary> = primaries.into_iter().flatten().collect();
    if problems.is_empty() {
        for (component, library) in specification.components.iter().zip(&primaries) {
            problems.extend(compare_ports(component, library));
        }
        problems.extend(compare::check(specification, &primaries));
        problems.extend(secondary::check(specification, &primaries, &secondaries));
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let in_hosts = |rules: &ComponentRules| {
        let isolation = rules.isolation.as_ref();
        isolation.is_some_and(|rule| rule.value.tier == IsolationTier::Process)
    };
    let wanted = rules.components.iter().any(in_hosts);
    let hosts = Hosts::new(options.executable.as_deref().filter(|_| wanted));
    let factories = factories(
        specification,
        rules,
        &primaries,
        secondaries,
        environment,
        &hosts,
    );
    let mut components = Vec::new();
    let mut statuses = Vec::new();
    for (factory, library) in factories.iter().zip(&primaries) {
        let name = &factory.variants()[0].specification.name;
        let status = Arc::new(ComponentStatus::new(name.clone()));
        let guarded = factory.isolation() == IsolationTier::Guarded;
        let library = guarded.then_some(library);
        match factory.instantiate(0, library, Arc::clone(&status)) {
            Ok(component) => components.push(Arc::new(ComponentCell::new(component))),
            Err(error) => problems.push(AssemblyProblem::Resources {
                component: name.clone(),
                error,
            }),
        }
        statuses.push(status);
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let executors = executors::group(specification, firsts, &components);
    connect::introduce(&components, &executors);
    let links = connect::connect(specification, &primaries, &components, &executors);
    Ok(Assembly {
        components,
        statuses,
        factories,
        executors,
        links,
        interfaces: primaries
            .into_iter()
            .map(|library| library.description.ports)
            .collect(),
    })
}

/// The secondaries of every component, each loaded once so that it is known to be usable.
fn secondaries<'rules>(
    specification: &ApplicationSpecification,
    rules: &'rules FaultRules,
    libraries: &mut Libraries<'_>,
) -> Vec<Vec<secondary::Candidate<'rules>>> {
    let of = |index: usize| {
        rules
            .components
            .get(index)
            .map_or(&[][..], |it| &it.secondaries)
    };
    (0..specification.components.len())
        .map(|index| {
            let candidates = of(index).iter().filter_map(|rule| {
                let library = libraries.look_at(&rule.specification)?;
                Some(secondary::Candidate { rule, library })
            });
            candidates.collect()
        })
        .collect()
}

fn factories(
    specification: &ApplicationSpecification,
    rules: &FaultRules,
    primaries: &[LoadedLibrary],
    secondaries: Vec<Vec<secondary::Candidate<'_>>>,
    environment: &Arc<Environment>,
    hosts: &Arc<Hosts>,
) -> Vec<Arc<Factory>> {
    let components = specification.components.iter().zip(primaries);
    let all = components.zip(secondaries).enumerate();
    all.map(|(number, ((component, library), secondaries))| {
        let rules = rules.components.get(number).cloned().unwrap_or_default();
        let standby = rules.standby.as_ref().map(|rule| rule.value);
        let mut variants = vec![Variant {
            specification: component.clone(),
            path: library.path.clone(),
            description: library.description.clone(),
            preload: standby.unwrap_or(Preload::Cold),
        }];
        variants.extend(secondaries.into_iter().map(|candidate| Variant {
            specification: candidate.rule.specification.clone(),
            path: candidate.library.path,
            description: candidate.library.description,
            preload: candidate.rule.preload,
        }));
        let environment = Arc::clone(environment);
        Arc::new(Factory::new(
            number,
            variants,
            rules,
            environment,
            Arc::clone(hosts),
        ))
    })
    .collect()
}

/// Compares what profiles declare with what libraries have.
fn compare_ports(
    component: &ComponentSpecification,
    library: &LoadedLibrary,
) -> Vec<AssemblyProblem> {
    let mut problems = Vec::new();
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
