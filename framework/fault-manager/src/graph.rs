//! Who needs whom: what else must stop when something is down, who is upstream of whom, and in which
//! order to stop. Ahn et al. (2012), section 3.3 and Figure 8.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use system_model::rules::{DependencyRule, DependencySeverity, Entity, FaultRules};
use system_model::specification::PortKind;

use crate::system::{Scope, System};

/// Something that can need or be needed, by global index.
#[derive(Debug, Clone, Copy)]
enum Node {
    Component(usize),
    Executor(usize),
    Application(usize),
}

#[derive(Debug)]
struct Dependency {
    dependent: Node,
    providers: Vec<Node>,
    need: usize,
    severity: DependencySeverity,
    /// What is needed, for a person.
    wanted: String,
}

/// The dependency rules of all applications, and where data come from.
#[derive(Debug)]
pub(crate) struct Graph {
    executors: Vec<Vec<usize>>,
    applications: Vec<Range<usize>>,
    dependencies: Vec<Dependency>,
    /// Components whose data reach an input port.
    sources: BTreeMap<(usize, String), Vec<usize>>,
}

/// How far a component is down. The order is that of severity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Level {
    Up,
    Stopped,
    Destroyed,
}

/// Why a component must come down too.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Demand {
    pub level: Level,
    /// What it needs and does not have.
    pub wanted: String,
}

impl Graph {
    /// Resolves the dependency rules and connections of all applications.
    pub fn new(scopes: &[Scope], system: &System) -> Self {
        let mut graph = Self {
            executors: system.executors.clone(),
            applications: system
                .applications
                .iter()
                .map(|application| application.members.clone())
                .collect(),
            dependencies: Vec::new(),
            sources: BTreeMap::new(),
        };
        for (application, scope) in scopes.iter().enumerate() {
            let first = system.applications[application].members.start;
            graph.add_sources(first, scope);
            for rule in &scope.rules.dependencies {
                graph.add_dependency(system, first, &rule.value);
            }
        }
        graph
    }

    fn add_sources(&mut self, first: usize, scope: &Scope) {
        for connection in &scope.specification.connections {
            if connection.kind == PortKind::Data {
                let target = (
                    first + connection.target.component,
                    connection.target.port.clone(),
                );
                let sources = self.sources.entry(target).or_default();
                sources.push(first + connection.source.component);
            }
        }
        self.add_voters(first, &scope.rules);
    }

    /// A voted input gets its data from all sources of the voter.
    fn add_voters(&mut self, first: usize, rules: &FaultRules) {
        for voting in &rules.votings {
            let target = (first + voting.output.component, voting.output.port.clone());
            let sources = self.sources.entry(target).or_default();
            sources.extend(voting.sources.iter().map(|end| first + end.port.component));
        }
    }

    fn add_dependency(&mut self, system: &System, first: usize, rule: &DependencyRule) {
        let node = |entity: &Entity| match entity {
            Entity::Component(index) => Some(Node::Component(first + index)),
            Entity::Executor(leader) => {
                let leader = system.components.get(first + leader)?;
                Some(Node::Executor(leader.executor))
            }
            Entity::Application(name) => {
                let named = |application: &crate::system::Application| application.name == *name;
                Some(Node::Application(
                    system.applications.iter().position(named)?,
                ))
            }
        };
        let providers: Vec<Node> = rule
            .providers
            .iter()
            .filter_map(|provider| node(&provider.entity))
            .collect();
        let Some(dependent) = node(&rule.dependent.entity) else {
            return;
        };
        let names: Vec<&str> = rule.providers.iter().map(|one| one.name.as_str()).collect();
        let wanted = match names.as_slice() {
            [only] => (*only).to_owned(),
            names if rule.need >= names.len() => names.join(" and "),
            names => format!("{} of {}", rule.need, names.join(", ")),
        };
        self.dependencies.push(Dependency {
            dependent,
            need: rule.need.min(providers.len()),
            providers,
            severity: rule.severity,
            wanted,
        });
    }

    /// What must come down because of what is down, transitively; `levels` of the components grow by
    /// it.
    pub fn spread(&self, levels: &mut [Level]) -> BTreeMap<usize, Demand> {
        let mut demands = BTreeMap::new();
        let mut grown = true;
        while grown {
            grown = false;
            for dependency in &self.dependencies {
                let level = match dependency.severity {
                    DependencySeverity::Ignore => continue,
                    DependencySeverity::Stop => Level::Stopped,
                    DependencySeverity::Destroy => Level::Destroyed,
                };
                let healthy = |node: &&Node| !self.is_down(**node, levels);
                if dependency.providers.iter().filter(healthy).count() >= dependency.need {
                    continue;
                }
                for member in self.members(dependency.dependent) {
                    if levels[member] < level {
                        levels[member] = level;
                        let wanted = dependency.wanted.clone();
                        demands.insert(member, Demand { level, wanted });
                        grown = true;
                    }
                }
            }
        }
        demands
    }

    /// Components that a component needs, directly or through others, each with the number of steps
    /// to it, nearest first. With an input port also those that its data come from.
    pub fn upstream(&self, component: usize, port: Option<&str>) -> Vec<(usize, usize)> {
        let mut seen = BTreeSet::from([component]);
        let mut layer = self.providers(component);
        if let Some(port) = port {
            let end = (component, port.to_owned());
            layer.extend(self.sources.get(&end).into_iter().flatten());
        }
        let mut found = Vec::new();
        for steps in 1.. {
            layer.retain(|provider| seen.insert(*provider));
            if layer.is_empty() {
                break;
            }
            found.extend(layer.iter().map(|provider| (steps, *provider)));
            let next = layer.iter().flat_map(|provider| self.providers(*provider));
            layer = next.collect();
        }
        found
    }

    /// Dependents before what they need; among equals the lower index first.
    pub fn stop_order(&self, components: &BTreeSet<usize>) -> Vec<usize> {
        let mut needed_by: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for component in components {
            for (_, provider) in self.upstream(*component, None) {
                needed_by.entry(provider).or_default().insert(*component);
            }
        }
        let mut left = components.clone();
        let mut order = Vec::new();
        while let Some(first) = left.first().copied() {
            let free = |component: &usize| {
                let dependents = needed_by.get(component);
                dependents.is_none_or(|dependents| dependents.is_disjoint(&left))
            };
            // A circle has no end to begin at; `check` refuses it, and any order will do.
            let next = left.iter().copied().find(|one| free(one)).unwrap_or(first);
            left.remove(&next);
            order.push(next);
        }
        order
    }

    /// What a component needs directly, as a member of its executor and application too.
    fn providers(&self, component: usize) -> BTreeSet<usize> {
        let own = self.dependencies.iter().filter(|dependency| {
            self.members(dependency.dependent)
                .any(|one| one == component)
        });
        own.flat_map(|dependency| &dependency.providers)
            .flat_map(|provider| self.members(*provider))
            .collect()
    }

    fn members(&self, node: Node) -> Box<dyn Iterator<Item = usize> + '_> {
        match node {
            Node::Component(component) => Box::new(std::iter::once(component)),
            Node::Executor(executor) => Box::new(self.executors[executor].iter().copied()),
            Node::Application(application) => Box::new(self.applications[application].clone()),
        }
    }

    /// A component or an executor is down with any of its members, an application with all of them:
    /// that is how it is stopped as a whole.
    fn is_down(&self, node: Node, levels: &[Level]) -> bool {
        let mut down = self.members(node).map(|member| levels[member] > Level::Up);
        match node {
            Node::Component(_) | Node::Executor(_) => down.any(|down| down),
            Node::Application(application) => {
                !self.applications[application].is_empty() && down.all(|down| down)
            }
        }
    }
}
