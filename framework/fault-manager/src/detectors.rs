//! Which detectors there are, and by which terms each symptom is judged.

use system_model::profile::Located;
use system_model::rules::{
    Arming, ComponentRules, ComponentSeverity, Confirmation, ExceptionClass, ExceptionRule,
    ExecutorRules, FaultRules, HeartbeatRule, Judgement, MonitorRule, OverrunRule, PortRules,
};
use system_model::specification::{ApplicationSpecification, Place, PortDirection};

use crate::observation::{Detector, DetectorId, DetectorKind, Symptom};
use crate::system::{Component, Scope, System};

/// All detectors, in the order of components and of their rules.
#[derive(Debug)]
pub(crate) struct Detectors {
    pub all: Vec<Detector>,
    /// Those of each component.
    by_component: Vec<Vec<DetectorId>>,
}

/// By what a symptom is judged.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Terms {
    pub severity: ComponentSeverity,
    pub confirmation: Confirmation,
    pub latched: bool,
    pub place: Option<Place>,
    pub arming: Arming,
}

impl Detectors {
    /// One for every rule; runtime exceptions, hangs and reports of every component always.
    pub fn new(scopes: &[Scope], system: &System) -> Self {
        let mut detectors = Self {
            all: Vec::new(),
            by_component: vec![Vec::new(); system.components.len()],
        };
        for (application, scope) in scopes.iter().enumerate() {
            let members = system.applications[application].members.clone();
            for index in members.clone() {
                detectors.add_defaults(index, &system.components[index].rules);
                detectors.add_conduct(index, members.start, &scope.rules, system);
                detectors.add_ports(index, &system.components[index].rules);
            }
            detectors.add_helpers(members.start, scope);
        }
        for application in &system.applications {
            for tree in application.trees.clone() {
                detectors.add_defaults(tree, &system.components[tree].rules);
            }
        }
        detectors
    }

    /// The detector of a component, if there is one.
    pub fn find(&self, component: usize, kind: &DetectorKind) -> Option<DetectorId> {
        let own = self.by_component.get(component)?;
        own.iter().copied().find(|id| self.all[id.0].kind == *kind)
    }

    /// By what a symptom of a detector is judged.
    pub fn terms(&self, system: &System, symptom: &Symptom) -> Terms {
        let detector = &self.all[symptom.detector.0];
        let rules = &system.components[detector.component].rules;
        let exception = match detector.kind {
            DetectorKind::Exception => narrowest_exception(rules, symptom),
            DetectorKind::Hang if rules.watchdog.is_none() => narrowest_exception(rules, symptom),
            _ => None,
        };
        let judgement = exception.map_or(detector.judgement, |rule| rule.value.judgement);
        let severity = match detector.kind {
            DetectorKind::Exception => None,
            _ => detector.judgement.severity,
        };
        Terms {
            severity: severity.unwrap_or_else(|| match detector.kind {
                DetectorKind::Exception | DetectorKind::Hang => {
                    rules.exception_severity(symptom.kind, symptom.return_code)
                }
                _ => rules.default_severity(),
            }),
            confirmation: rules.confirmation(&judgement),
            latched: judgement.latched,
            place: exception.map_or(detector.place.clone(), |rule| Some(rule.place.clone())),
            arming: judgement.arming,
        }
    }

    fn add(&mut self, component: usize, kind: DetectorKind, rule: Option<(Judgement, &Place)>) {
        let Some(own) = self.by_component.get_mut(component) else {
            return;
        };
        own.push(DetectorId(self.all.len()));
        self.all.push(Detector {
            component,
            kind,
            judgement: rule.map(|(judgement, _)| judgement).unwrap_or_default(),
            place: rule.map(|(_, place)| place.clone()),
        });
    }

    fn add_defaults(&mut self, component: usize, rules: &ComponentRules) {
        let any = rules
            .exceptions
            .iter()
            .find(|rule| rule.value.class == ExceptionClass::Any);
        let any = any.map(|rule| (rule.value.judgement, &rule.place));
        self.add(component, DetectorKind::Exception, any);
        let watchdog = rules.watchdog.as_ref();
        let watchdog = watchdog.map(|rule| (rule.value.judgement, &rule.place));
        self.add(component, DetectorKind::Hang, watchdog);
        self.add(component, DetectorKind::FaultEvent(None), None);
        for (index, rule) in rules.fault_events.iter().enumerate() {
            let kind = DetectorKind::FaultEvent(Some(index));
            self.add(component, kind, Some((rule.value.judgement, &rule.place)));
        }
    }

    /// Overruns and heartbeats: the narrowest rule counts, the component's own before that of its
    /// executor, its application, its node. Memory is each component's own.
    fn add_conduct(&mut self, index: usize, first: usize, rules: &FaultRules, system: &System) {
        let component = &system.components[index];
        if let Some(rule) = overrun_rule(index, first, rules, system) {
            let judged = Some((rule.value.judgement, &rule.place));
            self.add(index, DetectorKind::Overrun, judged);
        }
        if let Some(rule) = heartbeat_rule(index, first, rules, system) {
            let judged = Some((rule.value.judgement, &rule.place));
            self.add(index, DetectorKind::Heartbeat, judged);
        }
        if let Some(rule) = &component.rules.memory {
            let judged = Some((rule.value.judgement, &rule.place));
            self.add(index, DetectorKind::Memory, judged);
        }
    }

    fn add_ports(&mut self, component: usize, rules: &ComponentRules) {
        for (port, rules) in rules.ports.iter().enumerate() {
            self.add_port(component, port, rules);
        }
    }

    fn add_port(&mut self, component: usize, port: usize, rules: &PortRules) {
        let checks = &rules.checks;
        for (index, rule) in checks.validity.iter().enumerate() {
            let kind = DetectorKind::Validity { port, rule: index };
            self.add(component, kind, Some((rule.value.judgement, &rule.place)));
        }
        if let Some(rule) = &checks.freshness {
            let kind = DetectorKind::Freshness { port };
            self.add(component, kind, Some((rule.value.judgement, &rule.place)));
        }
        for (index, rule) in checks.rate_of_change.iter().enumerate() {
            let kind = DetectorKind::RateOfChange { port, rule: index };
            self.add(component, kind, Some((rule.value.judgement, &rule.place)));
        }
        for (index, rule) in checks.stuck.iter().enumerate() {
            let kind = DetectorKind::Stuck { port, rule: index };
            self.add(component, kind, Some((rule.value.judgement, &rule.place)));
        }
    }

    /// Process models blame the component at which the process begins, voters each of their sources.
    fn add_helpers(&mut self, first: usize, scope: &Scope) {
        let rules = &scope.rules;
        for (monitor, rule) in rules.monitors.iter().enumerate() {
            if let Some(component) = monitored(&scope.specification, rule) {
                let judged = Some((rule.rule.value.judgement, &rule.rule.place));
                let kind = DetectorKind::ProcessModel { monitor };
                self.add(first + component, kind, judged);
            }
        }
        for (voting, rule) in rules.votings.iter().enumerate() {
            for (source, end) in rule.sources.iter().enumerate() {
                let judged = Some((rule.rule.value.judgement, &rule.rule.place));
                let kind = DetectorKind::Voting { voting, source };
                self.add(first + end.port.component, kind, judged);
            }
        }
    }
}

/// The component that a process model is about: the one at which the process begins, which takes the
/// first input; where the model gets what somebody else sends, the one of the first output.
fn monitored(specification: &ApplicationSpecification, rule: &MonitorRule) -> Option<usize> {
    let taker = rule.inputs.iter().find(|input| {
        let component = specification.components.get(input.component);
        let ports = component.map_or(&[][..], |component| &component.ports);
        let port = ports.iter().find(|port| port.name == input.port);
        port.is_some_and(|port| port.direction == PortDirection::Input)
    });
    let blamed = taker.or(rule.outputs.first())?;
    Some(blamed.component)
}

/// The rule about overruns of a component: its own before that of its executor. `first` is the first
/// component of its application, whose `rules` these are.
pub(crate) fn overrun_rule<'a>(
    index: usize,
    first: usize,
    rules: &'a FaultRules,
    system: &'a System,
) -> Option<&'a Located<OverrunRule>> {
    let own = system.components[index].rules.overrun.as_ref();
    let executor = executor_rules(index, first, rules, system);
    own.or_else(|| executor.and_then(|rule| rule.overrun.as_ref()))
}

/// The rule about the heartbeat of a component: its own before that of its executor, of its
/// application, of its node.
pub(crate) fn heartbeat_rule<'a>(
    index: usize,
    first: usize,
    rules: &'a FaultRules,
    system: &'a System,
) -> Option<&'a Located<HeartbeatRule>> {
    let component = &system.components[index];
    let executor = executor_rules(index, first, rules, system);
    let own = component.rules.heartbeat.as_ref();
    own.or_else(|| executor.and_then(|rule| rule.heartbeat.as_ref()))
        .or_else(|| inherited_heartbeat(rules, component))
}

fn executor_rules<'a>(
    index: usize,
    first: usize,
    rules: &'a FaultRules,
    system: &System,
) -> Option<&'a ExecutorRules> {
    rules.executors.iter().find(|rule| {
        let leader = system.components.get(first + rule.first_component);
        leader.is_some_and(|leader| leader.executor == system.components[index].executor)
    })
}

/// The heartbeat of the application or of the node, for a component that works in periods.
fn inherited_heartbeat<'a>(
    rules: &'a FaultRules,
    component: &Component,
) -> Option<&'a Located<HeartbeatRule>> {
    let node = rules.nodes.iter().find(|(name, _)| *name == component.node);
    let rule = rules.heartbeat.as_ref().or(node.map(|(_, rule)| rule));
    rule.filter(|_| component.periodic)
}

/// The rule by which `ComponentRules::exception_severity` decides.
fn narrowest_exception<'a>(
    rules: &'a ComponentRules,
    symptom: &Symptom,
) -> Option<&'a Located<ExceptionRule>> {
    let matching = rules
        .exceptions
        .iter()
        .filter(|rule| rule.value.class.includes(symptom.kind, symptom.return_code));
    matching.max_by_key(|rule| rule.value.class.narrowness())
}
