//! Applications made of a few lines, and a container that does nothing but remember.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use fault_manager::{
    Action, ActionId, ActionOutcome, DetectorId, DetectorKind, Effect, Evidence, FaultId,
    FaultManager, Observation, PlannedAction, Scope, Symptom, Verdict,
};
use system_model::fault::FaultKind;
use system_model::profile::Located;
use system_model::rules::{
    ApplicationSeverity, ComponentRules, DependencyRule, DependencySeverity, Entity, FaultRule,
    FaultRules, Provider,
};
use system_model::specification::{
    ApplicationSpecification, ComponentSpecification, ExecutionKind, ExecutionSemantics, Place,
    SchedulingPolicy,
};

/// A value that stands nowhere in particular.
pub fn located<T>(value: T) -> Located<T> {
    Located {
        value,
        place: Place::default(),
    }
}

/// A periodic component without ports.
pub fn component(name: &str) -> ComponentSpecification {
    ComponentSpecification {
        name: name.to_owned(),
        type_name: name.to_owned(),
        profile: PathBuf::new(),
        place: Place::default(),
        library: String::new(),
        execution: ExecutionSemantics {
            kind: ExecutionKind::Periodic,
            period: Duration::from_millis(20),
            priority: 0,
            policy: SchedulingPolicy::Other,
        },
        properties: Vec::new(),
        ports: Vec::new(),
        node: String::new(),
    }
}

/// An application of these components, without rules.
pub fn application(name: &str, components: &[&str]) -> Scope {
    Scope {
        specification: ApplicationSpecification {
            name: name.to_owned(),
            file: PathBuf::new(),
            components: components.iter().map(|name| component(name)).collect(),
            connections: Vec::new(),
            manager_connections: Vec::new(),
            coordination: Vec::new(),
            world: None,
            trees: Vec::new(),
        },
        rules: FaultRules {
            application: name.to_owned(),
            components: components
                .iter()
                .map(|_| ComponentRules::default())
                .collect(),
            ..FaultRules::default()
        },
    }
}

/// The name of an entity, as a rule would write it.
pub fn provider(entity: Entity) -> Provider {
    let name = match &entity {
        Entity::Component(index) | Entity::Executor(index) => index.to_string(),
        Entity::Application(name) => name.clone(),
    };
    Provider { entity, name }
}

/// `dependent` needs so many of the providers.
pub fn needs(
    scope: &mut Scope,
    dependent: Entity,
    providers: &[Entity],
    need: usize,
    severity: DependencySeverity,
) {
    scope.rules.dependencies.push(located(DependencyRule {
        dependent: provider(dependent),
        providers: providers.iter().cloned().map(provider).collect(),
        need,
        severity,
    }));
}

/// So many resets within ten seconds, and what follows.
pub fn budget(retry_max: u32, severity: ApplicationSeverity) -> Option<Located<FaultRule>> {
    Some(located(FaultRule {
        retry_max,
        window: Duration::from_secs(10),
        backoff: Duration::ZERO,
        severity,
    }))
}

/// A fault manager and what it has asked for.
pub struct Bench {
    /// The subject.
    pub manager: FaultManager,
    /// Time of the next observation.
    pub now: Duration,
    /// Actions of the last observation.
    pub acts: Vec<PlannedAction>,
    /// Actions abandoned by the last observation.
    pub abandoned: Vec<ActionId>,
    /// Whether the last observation rearmed.
    pub rearmed: bool,
    /// The last record of every fault.
    pub records: BTreeMap<FaultId, Verdict>,
    /// Incarnation of each component.
    pub incarnations: Vec<u32>,
}

impl Bench {
    /// The applications run.
    pub fn new(scopes: Vec<Scope>) -> Self {
        let components = scopes
            .iter()
            .map(|scope| scope.specification.components.len() + scope.specification.trees.len());
        let mut bench = Self {
            incarnations: vec![1; components.sum()],
            manager: FaultManager::new(scopes),
            now: Duration::ZERO,
            acts: Vec::new(),
            abandoned: Vec::new(),
            rearmed: false,
            records: BTreeMap::new(),
        };
        bench.tell(Observation::Running);
        bench
    }

    /// Makes an observation.
    pub fn tell(&mut self, observation: Observation) {
        self.acts.clear();
        self.abandoned.clear();
        self.rearmed = false;
        for effect in self.manager.observe(self.now, observation) {
            match effect {
                Effect::Act(action) => self.acts.push(action),
                Effect::Abandon(id) => self.abandoned.push(id),
                Effect::Record(verdict) => {
                    self.records.insert(verdict.id, *verdict);
                }
                Effect::Rearm => self.rearmed = true,
            }
        }
    }

    /// Lets milliseconds pass, with a tick at their end.
    pub fn wait(&mut self, milliseconds: u64) {
        self.now += Duration::from_millis(milliseconds);
        self.tell(Observation::Tick);
    }

    /// A detector complains now.
    pub fn complain(
        &mut self,
        component: usize,
        kind: &DetectorKind,
        fault: FaultKind,
        runs: bool,
    ) {
        let symptom = self.symptom(component, kind, fault, runs);
        self.tell(Observation::Symptom(Box::new(symptom)));
    }

    /// What a detector would say now.
    pub fn symptom(
        &self,
        component: usize,
        kind: &DetectorKind,
        fault: FaultKind,
        runs: bool,
    ) -> Symptom {
        Symptom {
            detector: self.detector(component, kind),
            incarnation: self.incarnations[component],
            kind: fault,
            return_code: 0,
            at: self.now,
            runs,
            evidence: Evidence::Heartbeat {
                missed: 3,
                period_ms: 20.0,
            },
        }
    }

    /// A detector that there must be.
    pub fn detector(&self, component: usize, kind: &DetectorKind) -> DetectorId {
        self.manager
            .detector(component, kind)
            .expect("the component has the detector")
    }

    /// A component panics.
    pub fn crash(&mut self, component: usize) {
        self.complain(component, &DetectorKind::Exception, FaultKind::Panic, false);
    }

    /// An action ended well; a recovery brings a new incarnation.
    pub fn done(&mut self, action: &PlannedAction) {
        let incarnation = match action.action {
            Action::Reset { component, .. } | Action::Replace { component, .. } => {
                self.incarnations[component] += 1;
                self.incarnations[component]
            }
            _ => 0,
        };
        self.tell(Observation::Ended {
            action: action.id,
            outcome: ActionOutcome::Done {
                incarnation,
                note: String::new(),
            },
        });
    }

    /// An action failed.
    pub fn failed(&mut self, action: &PlannedAction) {
        self.tell(Observation::Ended {
            action: action.id,
            outcome: ActionOutcome::Failed {
                reason: "it would not".to_owned(),
            },
        });
    }

    /// A component completes a cycle.
    pub fn works(&mut self, component: usize) {
        self.tell(Observation::Works {
            component,
            incarnation: self.incarnations[component],
        });
    }

    /// The one action that the last observation asked for.
    pub fn act(&self) -> PlannedAction {
        assert_eq!(self.acts.len(), 1, "{:?}", self.acts);
        self.acts[0].clone()
    }

    /// What the last observation asked for, without numbers.
    pub fn actions(&self) -> Vec<Action> {
        self.acts.iter().map(|act| act.action.clone()).collect()
    }

    /// The last record of the newest fault.
    pub fn newest(&self) -> &Verdict {
        self.records
            .values()
            .next_back()
            .expect("there is a record")
    }
}
