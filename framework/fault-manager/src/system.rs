//! The applications as the fault manager knows them: components numbered one after the other, each
//! with its rules.

use std::ops::Range;
use std::time::Duration;

use system_model::mission::DeclaredTree;
use system_model::profile::Located;
use system_model::rules::{
    ApplicationSeverity, ComponentRules, DEFAULT_PERIODLESS_DEADLINE, DEFAULT_STARTUP, FaultRule,
    FaultRules,
};
use system_model::specification::{
    ApplicationSpecification, ComponentSpecification, ExecutionKind,
};

/// One application and its rules.
#[derive(Debug, Clone, PartialEq)]
pub struct Scope {
    /// What is assembled.
    pub specification: ApplicationSpecification,
    /// What is watched, and what is done about it.
    pub rules: FaultRules,
}

/// All applications of a container. Behind the components of all of them come their behaviour trees,
/// which are components to the fault manager: they fail, are begun anew and stopped.
#[derive(Debug)]
pub(crate) struct System {
    pub components: Vec<Component>,
    pub applications: Vec<Application>,
    /// Components that share an executor, by their global indices.
    pub executors: Vec<Vec<usize>>,
}

/// One application.
#[derive(Debug)]
pub(crate) struct Application {
    pub name: String,
    /// Its components' global indices.
    pub members: Range<usize>,
    /// Its behaviour trees' global indices.
    pub trees: Range<usize>,
}

/// One component.
#[derive(Debug)]
pub(crate) struct Component {
    pub name: String,
    pub node: String,
    pub application: usize,
    /// Index into the executors of the system.
    pub executor: usize,
    /// Whether it runs in periods of its own accord. Only then a completed cycle must follow a
    /// recovery, and an inherited heartbeat says something.
    pub periodic: bool,
    pub rules: ComponentRules,
    /// Its own rule, or the application's, or the default.
    pub fault: FaultRule,
    /// How long a recovery may take, first cycle included.
    pub recovery_deadline: Duration,
}

impl System {
    /// Numbers the components of all applications.
    pub fn new(scopes: &[Scope]) -> Self {
        let mut system = Self {
            components: Vec::new(),
            applications: Vec::new(),
            executors: Vec::new(),
        };
        for scope in scopes {
            system.add(scope);
        }
        for (application, scope) in scopes.iter().enumerate() {
            system.add_trees(application, &scope.specification.trees);
        }
        system
    }

    /// The tree of an application by its name, as rules use it.
    pub fn tree(&self, application: usize, name: &str) -> Option<usize> {
        let application = &self.applications[application];
        let is_it = |tree: &usize| {
            let own = self.components[*tree].name.as_str();
            // With several applications in one container names begin with that of the application.
            let short = own.strip_prefix(application.name.as_str());
            own == name || short.and_then(|it| it.strip_prefix('/')) == Some(name)
        };
        application.trees.clone().find(is_it)
    }

    fn add(&mut self, scope: &Scope) {
        let application = self.applications.len();
        let first = self.components.len();
        let first_executor = self.executors.len();
        let specification = &scope.specification;
        for (index, component) in specification.components.iter().enumerate() {
            let shared = (first_executor..self.executors.len()).find(|executor| {
                let leader = self.executors[*executor][0] - first;
                run_together(&specification.components[leader], component)
            });
            let executor = shared.unwrap_or_else(|| {
                self.executors.push(Vec::new());
                self.executors.len() - 1
            });
            self.executors[executor].push(first + index);
            self.components
                .push(Component::new(scope, index, application, executor));
        }
        self.applications.push(Application {
            name: specification.name.clone(),
            members: first..self.components.len(),
            trees: 0..0,
        });
    }

    /// The trees of an application, each as a component that nobody but the container runs.
    fn add_trees(&mut self, application: usize, trees: &[DeclaredTree]) {
        let first = self.components.len();
        for tree in trees {
            self.executors.push(vec![self.components.len()]);
            let executor = self.executors.len() - 1;
            self.components
                .push(Component::of_tree(tree, application, executor));
        }
        self.applications[application].trees = first..self.components.len();
    }
}

impl Component {
    fn new(scope: &Scope, index: usize, application: usize, executor: usize) -> Self {
        let specification = &scope.specification.components[index];
        let rules = scope
            .rules
            .components
            .get(index)
            .cloned()
            .unwrap_or_default();
        let fault = rules.fault.as_ref().or(scope.rules.fault.as_ref());
        let waits_for_another = scope
            .specification
            .coordination
            .iter()
            .any(|(source, _)| *source == index);
        Self {
            name: specification.name.clone(),
            node: specification.node.clone(),
            application,
            executor,
            periodic: matches!(
                specification.execution.kind,
                ExecutionKind::Periodic | ExecutionKind::PeriodicShared
            ) && !waits_for_another,
            fault: fault.map(|rule| rule.value).unwrap_or_default(),
            recovery_deadline: recovery_deadline(&rules, specification),
            rules,
        }
    }
}

impl Component {
    /// A behaviour tree: its executor ticks it, and a reset begins it anew.
    fn of_tree(tree: &DeclaredTree, application: usize, executor: usize) -> Self {
        let rules = ComponentRules {
            severity: Some(Located {
                value: tree.severity,
                place: tree.place.clone(),
            }),
            ..ComponentRules::default()
        };
        Self {
            name: tree.name.clone(),
            node: String::new(),
            application,
            executor,
            periodic: false,
            rules,
            fault: FaultRule {
                retry_max: tree.retry_max,
                severity: ApplicationSeverity::Global,
                ..FaultRule::default()
            },
            // An order is taken between two ticks.
            recovery_deadline: (tree.tick + tree.tick_deadline)
                .saturating_add(DEFAULT_PERIODLESS_DEADLINE),
        }
    }
}

/// What `recovery/@deadline` says. Without it: bringing the component up may take as long as its
/// watchdog allows at start, and its first cycle begins one period later at most and may then take
/// until it is a hang.
fn recovery_deadline(rules: &ComponentRules, specification: &ComponentSpecification) -> Duration {
    if let Some(rule) = &rules.recovery {
        return rule.value.deadline;
    }
    let startup = rules
        .watchdog
        .as_ref()
        .map_or(DEFAULT_STARTUP, |rule| rule.value.startup);
    let execution = &specification.execution;
    let first_cycle = execution
        .period
        .saturating_add(rules.watchdog_deadline(execution));
    startup.saturating_add(first_cycle.max(DEFAULT_PERIODLESS_DEADLINE))
}

/// Whether the container runs both in one executor.
fn run_together(one: &ComponentSpecification, other: &ComponentSpecification) -> bool {
    let (one, other) = (&one.execution, &other.execution);
    one.kind == other.kind
        && match one.kind {
            ExecutionKind::PeriodicShared => {
                one.period == other.period
                    && one.priority == other.priority
                    && one.policy == other.policy
            }
            ExecutionKind::Passive => true,
            ExecutionKind::Periodic | ExecutionKind::Aperiodic => false,
        }
}
