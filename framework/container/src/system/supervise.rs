//! Puts the fault manager in charge of an assembled application: every rule finds its place.

mod actuators;
mod injections;
mod manager_ports;
mod models;
mod ports;
mod rhythm;
mod voters;

use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use crossbeam::channel::Receiver;
use fault_manager::{DetectorId, DetectorKind, FaultManager, Scope};
use system_model::process_model::ProcessModel;
use system_model::rules::{ComponentRules, FaultRules};
use system_model::specification::{ApplicationSpecification, Place};

use crate::assembly::{Assembly, AssemblyProblem};
use crate::component::{Component, Detectors, Environment, PortEnd};
use crate::lane::SETUP_TOKEN;
use crate::library::PortDescription;
use crate::replay::Score;
use crate::supervision::{Emergency, Monitors, Orders, Standbys, Supervisor};

use super::applications::{Applications, Part};

pub(super) use injections::inject;

/// Everything that the rules of one application are about. Components count through all of them.
struct Subjects<'start> {
    /// All applications as one.
    specification: &'start ApplicationSpecification,
    /// The components of the application that is looked at.
    members: Range<usize>,
    /// Its rules.
    rules: &'start FaultRules,
    models: &'start [(String, ProcessModel)],
    assembly: &'start Assembly,
    manager: &'start FaultManager,
    /// The recording that is played, if one is.
    score: Option<&'start Score>,
}

/// The shell around the fault manager, and the channel by which it asks for standbys.
///
/// # Errors
/// Rules that do not fit the libraries.
pub(super) fn supervise(
    applications: &Applications,
    assembly: &Assembly,
    environment: &Arc<Environment>,
) -> Result<(Supervisor, Receiver<usize>), Vec<AssemblyProblem>> {
    let parts = &applications.parts;
    let scope = |part: &Part| Scope {
        specification: part.application.specification.clone(),
        rules: part.application.rules.clone(),
    };
    let manager = FaultManager::new(parts.iter().map(scope).collect());
    let subjects = parts.iter().map(|part| Subjects {
        specification: &applications.specification,
        members: part.members.clone(),
        rules: &part.rules,
        models: &part.application.models,
        assembly,
        manager: &manager,
        score: environment.score.as_deref(),
    });
    let subjects: Vec<Subjects<'_>> = subjects.collect();
    let mut problems = Vec::new();
    let mut monitors = Monitors::default();
    let emergency = Emergency::new(subjects.iter().flat_map(actuators::find).collect());
    for subjects in &subjects {
        for index in subjects.members.clone() {
            subjects.instrument(index);
        }
        ports::watch(subjects, &emergency, &mut monitors, &mut problems);
        voters::insert(subjects, &mut problems);
        rhythm::watch(subjects, &mut monitors);
        models::watch(subjects, &mut monitors, &mut problems);
    }
    // They say for all applications at once who is connected.
    let outputs = subjects.first();
    let outputs = outputs.map(|it| manager_ports::connect(it, &mut problems));
    if !problems.is_empty() {
        return Err(problems);
    }
    let trees: usize = parts.iter().map(Part::trees).sum();
    let of_trees = (0..trees).map(|_| Arc::new(Orders::new(Arc::default())));
    let orders = (0..assembly.components.len())
        .map(|index| orders_of(assembly, index))
        .chain(of_trees)
        .collect();
    // In simulated time loading takes none.
    let keeps_own = !environment.clock.is_simulated();
    let standbys = assembly
        .factories
        .iter()
        .map(|factory| Standbys::new(Arc::clone(factory), keeps_own))
        .collect();
    let (supervisor, wanted) = Supervisor::new(
        Arc::clone(environment),
        manager,
        orders,
        standbys,
        assembly.statuses.clone(),
        emergency,
        monitors,
    );
    supervisor.set_outputs(outputs.unwrap_or_default());
    Ok((supervisor, wanted))
}

impl Subjects<'_> {
    /// The rules of a component.
    fn rules_of(&self, component: usize) -> Option<&ComponentRules> {
        self.rules.components.get(component)
    }

    /// Whether a component is played from a recording.
    fn is_played(&self, component: usize) -> bool {
        let name = &self.specification.components[component].name;
        self.score.is_some_and(|score| score.plays(name))
    }

    /// The name of a component, as rules use it.
    fn named(&self, component: usize) -> &str {
        let name = self.specification.components[component].name.as_str();
        // With several applications in one container names begin with that of the application.
        name.split_once('/')
            .filter(|_| self.members.len() < self.specification.components.len())
            .map_or(name, |(_, own)| own)
    }

    fn detector(&self, component: usize, kind: DetectorKind) -> Option<DetectorId> {
        self.manager.detector(component, &kind)
    }

    /// A port of a component, with its index.
    fn port(&self, component: usize, name: &str) -> Option<(usize, &PortDescription)> {
        let ports = self.assembly.interfaces.get(component)?;
        ports.iter().enumerate().find(|(_, port)| port.name == name)
    }

    fn with_component(&self, index: usize, change: impl FnOnce(&mut Component)) {
        if let Some(cell) = self.assembly.components.get(index)
            && let Some(mut component) = cell.enter(SETUP_TOKEN, Duration::ZERO)
        {
            change(&mut component);
        }
    }

    /// Faults that the component itself tells of, by an event or by its report service.
    fn watch_fault_events(&self, index: usize) {
        let rules = self.rules_of(index).map_or(&[][..], |it| &it.fault_events);
        for (number, rule) in rules.iter().enumerate() {
            let kind = DetectorKind::FaultEvent(Some(number));
            let Some(detector) = self.detector(index, kind) else {
                continue;
            };
            let port = rule.value.port.as_ref();
            let port = port.and_then(|port| self.port(index, port));
            self.with_component(index, |component| match port {
                Some((port, _)) => {
                    let end = component.services_mut().port_mut(port);
                    if let Some(PortEnd::EventOutput(output)) = end {
                        output.fault = Some(detector);
                    }
                }
                None => {
                    let name = rule.value.name.clone();
                    component.services_mut().name_fault(name, detector);
                }
            });
        }
    }

    fn instrument(&self, index: usize) {
        let detectors = (|| {
            Some(Detectors {
                component: index,
                exception: self.detector(index, DetectorKind::Exception)?,
                hang: self.detector(index, DetectorKind::Hang)?,
                reported: self.detector(index, DetectorKind::FaultEvent(None))?,
            })
        })();
        self.watch_fault_events(index);
        let resurrect = self.rules_of(index).and_then(|it| it.resurrect.as_ref());
        let backup = resurrect.and_then(|rule| rule.value.backup);
        // What is played has no memory.
        let backup = backup.filter(|_| !self.is_played(index));
        self.with_component(index, |component| {
            if let Some(detectors) = detectors {
                component.services_mut().set_detectors(detectors);
            }
            if let Some(period) = backup {
                component.keep_checkpoints(period);
            }
        });
    }
}

/// A rule that does not fit what a library says of itself.
fn misfit(place: &Place, message: String, help: String) -> AssemblyProblem {
    AssemblyProblem::Connection {
        place: place.clone(),
        message,
        help,
    }
}

fn orders_of(assembly: &Assembly, component: usize) -> Arc<Orders> {
    let runs = |member: &crate::executor::Member| usize::try_from(member.number) == Ok(component);
    let executor = assembly
        .executors
        .iter()
        .find(|executor| executor.members.iter().any(runs));
    // Every component is in an executor; one without would take no orders, and say so.
    executor.map_or_else(
        || Arc::new(Orders::new(Arc::default())),
        |executor| Arc::clone(&executor.orders),
    )
}
