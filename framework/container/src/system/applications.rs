//! Several applications in one container: one list of components, each application's own behind
//! those of the one before it.

mod shift;

use std::ops::Range;
use std::sync::Arc;

use crate::adaptation::AttachedTask;
use crate::world::Drives;
use behavior_tree::Plan;
use system_model::injection::Injection;
use system_model::process_model::ProcessModel;
use system_model::profile::Located;
use system_model::rules::{DependencyRule, Entity, FaultRules};
use system_model::specification::{ApplicationSpecification, ComponentSpecification};

/// One application as it was loaded; everything in it counts components within the application.
#[derive(Debug, Clone)]
pub struct Application {
    /// What it is made of.
    pub specification: ApplicationSpecification,
    /// What counts as a fault and what is done about it; none: the defaults.
    pub rules: FaultRules,
    /// The process models that the rules name, by the name that they use.
    pub models: Vec<(String, ProcessModel)>,
    /// The plans of its behaviour trees, in the order of the specification.
    pub plans: Vec<Arc<Plan>>,
    /// Faults that are made on purpose.
    pub injections: Vec<Injection>,
    /// The task that it is to do, and is watched over.
    pub task: Option<AttachedTask>,
}

/// All applications together.
#[derive(Debug)]
pub(super) struct Applications {
    /// As if they were one; where there are several, their components read
    /// `application/component`.
    pub(super) specification: ApplicationSpecification,
    /// The rules of all components, in the order of the specification; nothing else is in it.
    pub(super) rules: FaultRules,
    /// Injections, with components of the specification.
    pub(super) injections: Vec<Injection>,
    /// Each for itself.
    pub(super) parts: Vec<Part>,
}

/// One of them.
#[derive(Debug)]
pub(super) struct Part {
    /// Its components in the list of all.
    pub(super) members: Range<usize>,
    /// The application under the names that its components have in the list of all; indices count
    /// within it.
    pub(super) application: Application,
    /// Its rules, with components of the list of all: those of other applications have none here.
    pub(super) rules: FaultRules,
}

impl Part {
    /// How many behaviour trees the application has.
    pub(super) fn trees(&self) -> usize {
        self.application.specification.trees.len()
    }
}

impl Applications {
    /// Puts applications together. Their names differ.
    pub(super) fn new(applications: Vec<Application>) -> Self {
        let several = applications.len() > 1;
        let mut all = Self {
            specification: together(&applications),
            rules: FaultRules::default(),
            injections: Vec::new(),
            parts: Vec::new(),
        };
        for mut application in applications {
            if several {
                rename(&mut application);
            }
            all.forget_repeated_dependencies(&mut application.rules);
            all.add(application);
        }
        all
    }

    /// Where each application begins in the list of all components.
    pub(super) fn firsts(&self) -> Vec<usize> {
        self.parts.iter().map(|part| part.members.start).collect()
    }

    /// The name of each application, and its components in the list of all.
    pub(super) fn names(&self) -> Vec<(String, Range<usize>)> {
        let parts = self.parts.iter();
        let named = |part: &Part| {
            let name = part.application.specification.name.clone();
            (name, part.members.clone())
        };
        parts.map(named).collect()
    }

    /// What each has of a world.
    pub(super) fn drives(&self) -> Vec<Drives<'_>> {
        let parts = self.parts.iter();
        let with_specification = parts.map(|part| (part, &part.application.specification));
        let drives = with_specification.map(|(part, specification)| Drives {
            application: &specification.name,
            first: part.members.start,
            file: specification.world.as_deref(),
        });
        drives.collect()
    }

    fn add(&mut self, application: Application) {
        let first = self.specification.components.len();
        let components = &application.specification.components;
        let members = first..first + components.len();
        self.specification.components.extend_from_slice(components);
        for connection in &application.specification.connections {
            let mut connection = connection.clone();
            connection.source.component += first;
            connection.target.component += first;
            self.specification.connections.push(connection);
        }
        for connection in &application.specification.manager_connections {
            let mut connection = connection.clone();
            connection.component.component += first;
            self.specification.manager_connections.push(connection);
        }
        let edges = application.specification.coordination.iter();
        let edges = edges.map(|(source, target)| (first + source, first + target));
        self.specification.coordination.extend(edges);
        let injections = application.injections.iter();
        self.injections
            .extend(injections.map(|one| shift::injection(one, first)));
        let mut own = application.rules.components.clone();
        own.resize_with(members.len(), Default::default);
        self.rules.components.extend(own);
        self.parts.push(Part {
            rules: shift::rules(&application.rules, first),
            members,
            application,
        });
    }

    /// What a system file says of applications is among the rules of each of them.
    fn forget_repeated_dependencies(&self, rules: &mut FaultRules) {
        let known = |rule: &Located<DependencyRule>| {
            let parts = self.parts.iter();
            let mut known = parts.flat_map(|part| &part.application.rules.dependencies);
            is_between_applications(&rule.value) && known.any(|other| other == rule)
        };
        rules.dependencies.retain(|rule| !known(rule));
    }
}

fn is_between_applications(rule: &DependencyRule) -> bool {
    let mut entities = std::iter::once(&rule.dependent).chain(&rule.providers);
    entities.all(|one| matches!(one.entity, Entity::Application(_)))
}

/// Without components: name, file and world.
fn together(applications: &[Application]) -> ApplicationSpecification {
    let specifications = || applications.iter().map(|one| &one.specification);
    let names: Vec<&str> = specifications().map(|one| one.name.as_str()).collect();
    ApplicationSpecification {
        name: names.join("+"),
        file: specifications()
            .next()
            .map_or_else(Default::default, |one| one.file.clone()),
        components: Vec::new(),
        connections: Vec::new(),
        manager_connections: Vec::new(),
        coordination: Vec::new(),
        world: specifications().find_map(|one| one.world.clone()),
        trees: Vec::new(),
    }
}

/// `application/component`, also for those that may take a component's place.
fn rename(application: &mut Application) {
    let prefix = application.specification.name.clone();
    let rename = |component: &mut ComponentSpecification| {
        component.name = format!("{prefix}/{}", component.name);
    };
    application
        .specification
        .components
        .iter_mut()
        .for_each(rename);
    for tree in &mut application.specification.trees {
        tree.name = format!("{prefix}/{}", tree.name);
    }
    let rules = application.rules.components.iter_mut();
    let secondaries = rules.flat_map(|rules| &mut rules.secondaries);
    secondaries.for_each(|secondary| rename(&mut secondary.specification));
}

#[cfg(test)]
mod tests {
    use system_model::rules::{DependencySeverity, Provider};
    use system_model::specification::Place;

    use super::*;

    fn needs(dependent: Entity, provider: &str) -> Located<DependencyRule> {
        let end = |entity: Entity, name: &str| Provider {
            entity,
            name: name.to_owned(),
        };
        Located {
            value: DependencyRule {
                dependent: end(dependent, "dependent"),
                providers: vec![end(Entity::Application(provider.to_owned()), provider)],
                need: 1,
                severity: DependencySeverity::Stop,
            },
            place: Place::default(),
        }
    }

    fn application(name: &str) -> Application {
        let between = needs(Entity::Application("mapping".to_owned()), "localisation");
        Application {
            specification: ApplicationSpecification {
                name: name.to_owned(),
                file: "application.xml".into(),
                components: Vec::new(),
                connections: Vec::new(),
                manager_connections: Vec::new(),
                coordination: Vec::new(),
                world: (name == "mapping").then(|| "world.xml".into()),
                trees: Vec::new(),
            },
            rules: FaultRules {
                dependencies: vec![between, needs(Entity::Component(0), "localisation")],
                ..FaultRules::default()
            },
            models: Vec::new(),
            plans: Vec::new(),
            injections: Vec::new(),
            task: None,
        }
    }

    #[test]
    fn what_all_of_them_say_of_applications_counts_once() {
        let all = Applications::new(["localisation", "mapping"].map(application).into());
        let dependencies = all.parts.iter();
        let dependencies = dependencies.map(|it| it.application.rules.dependencies.len());
        assert_eq!(dependencies.collect::<Vec<_>>(), [2, 1]);
        assert_eq!(all.specification.name, "localisation+mapping");
        assert_eq!(all.specification.world, Some("world.xml".into()));
        assert_eq!(all.firsts(), [0, 0]);
    }
}
