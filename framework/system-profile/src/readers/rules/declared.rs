//! Rules as they are written: typed, but with names that nobody has looked up.

use system_model::profile::Located;
use system_model::rules::{
    AdaptRule, ComponentRules, DependencySeverity, FaultRule, HeartbeatRule, OverrunRule,
    PortChecks, Preload, ProcessModelRule, VotingRule,
};
use system_model::specification::Place;

/// All rules of one file, or of all inline elements together.
#[derive(Debug, Default)]
pub(crate) struct DeclaredRules {
    pub(crate) application: Located<String>,
    /// The rules of the application itself.
    pub(crate) own: DeclaredApplication,
    pub(crate) components: Vec<DeclaredComponent>,
    pub(crate) executors: Vec<DeclaredExecutor>,
    pub(crate) nodes: Vec<(Located<String>, Located<HeartbeatRule>)>,
    /// Other applications, and the own one by name.
    pub(crate) applications: Vec<DeclaredApplication>,
    pub(crate) monitors: Vec<DeclaredMonitor>,
    pub(crate) votings: Vec<DeclaredVoting>,
    pub(crate) dependencies: Vec<DeclaredDependency>,
}

impl DeclaredRules {
    pub(crate) fn new(application: Located<String>) -> Self {
        Self {
            application,
            ..Self::default()
        }
    }

    /// Takes a component's rules; those that name other components too go to the whole.
    pub(crate) fn take(&mut self, mut component: DeclaredComponent) {
        self.dependencies.append(&mut component.dependencies);
        self.monitors.append(&mut component.monitors);
        self.votings.append(&mut component.votings);
        self.components.push(component);
    }
}

/// Rules of one component.
#[derive(Debug)]
pub(crate) struct DeclaredComponent {
    pub(crate) name: Located<String>,
    /// The element that holds the rules.
    pub(crate) place: Place,
    /// Without ports and secondaries.
    pub(crate) rules: ComponentRules,
    pub(crate) ports: Vec<(Located<String>, PortChecks)>,
    pub(crate) secondaries: Vec<DeclaredSecondary>,
    pub(crate) dependencies: Vec<DeclaredDependency>,
    pub(crate) monitors: Vec<DeclaredMonitor>,
    pub(crate) votings: Vec<DeclaredVoting>,
}

/// A secondary by the file of its profile.
#[derive(Debug, Clone)]
pub(crate) struct DeclaredSecondary {
    pub(crate) reference: Located<String>,
    pub(crate) preload: Preload,
}

/// Rules of one application.
#[derive(Debug, Default)]
pub(crate) struct DeclaredApplication {
    /// None for the application that the file is about.
    pub(crate) name: Option<Located<String>>,
    pub(crate) heartbeat: Option<Located<HeartbeatRule>>,
    pub(crate) adapt: Option<Located<AdaptRule>>,
    pub(crate) fault: Option<Located<FaultRule>>,
    /// An application has none; whoever writes one is told.
    pub(crate) secondaries: Vec<DeclaredSecondary>,
    pub(crate) dependencies: Vec<DeclaredDependency>,
}

/// Rules of one executor.
#[derive(Debug)]
pub(crate) struct DeclaredExecutor {
    pub(crate) name: Located<String>,
    pub(crate) overrun: Option<Located<OverrunRule>>,
    pub(crate) heartbeat: Option<Located<HeartbeatRule>>,
}

/// A data port by name.
#[derive(Debug, Clone)]
pub(crate) struct DeclaredEnd {
    pub(crate) component: Located<String>,
    pub(crate) port: Located<String>,
    pub(crate) field: Option<String>,
}

/// A process-model monitor.
#[derive(Debug)]
pub(crate) struct DeclaredMonitor {
    pub(crate) name: Located<String>,
    pub(crate) rule: Located<ProcessModelRule>,
    pub(crate) inputs: Vec<DeclaredEnd>,
    pub(crate) outputs: Vec<DeclaredEnd>,
}

/// One source of a voter.
#[derive(Debug)]
pub(crate) struct DeclaredSource {
    pub(crate) end: DeclaredEnd,
    pub(crate) weight: Option<f64>,
}

/// A voter.
#[derive(Debug)]
pub(crate) struct DeclaredVoting {
    pub(crate) name: Located<String>,
    pub(crate) rule: Located<VotingRule>,
    pub(crate) sources: Vec<DeclaredSource>,
    pub(crate) output: Option<DeclaredEnd>,
}

/// A dependency.
#[derive(Debug, Clone)]
pub(crate) struct DeclaredDependency {
    pub(crate) place: Place,
    pub(crate) dependent: DeclaredName,
    pub(crate) references: Vec<DeclaredName>,
    pub(crate) need: usize,
    pub(crate) severity: DependencySeverity,
}

/// The name of a component, an executor or an application.
#[derive(Debug, Clone)]
pub(crate) struct DeclaredName {
    pub(crate) name: Located<String>,
    pub(crate) kind: Option<EntityKind>,
}

/// What a name is the name of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EntityKind {
    Component,
    Executor,
    Application,
}
