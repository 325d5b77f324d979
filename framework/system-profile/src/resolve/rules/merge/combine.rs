//! Two sets of rules made one, kind by kind.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::hash::Hash;

use system_model::profile::Located;
use system_model::rules::{
    ComponentRules, DependencyRule, ExecutorRules, HeartbeatRule, MonitorRule, PortChecks,
    VotingSpecification,
};
use system_model::specification::Place;

use super::{Merged, MergedComponent};
use crate::problem::Severity;
use crate::readers::rules::DeclaredSecondary;
use crate::resolve::Assembly;

/// What becomes of two rules about the same thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    /// The newer one wins.
    Override,
    /// They must say the same.
    Conflict,
}

/// Adds newer rules to older ones.
#[derive(Debug)]
pub(super) struct Combine<'a> {
    assembly: &'a Assembly<'a>,
    mode: Mode,
}

impl<'a> Combine<'a> {
    pub(super) fn new(assembly: &'a Assembly<'a>, mode: Mode) -> Self {
        Self { assembly, mode }
    }

    pub(super) fn all(&self, older: &mut Merged, newer: Merged) {
        self.slot("fault", &mut older.fault, newer.fault);
        self.slot("heartbeat", &mut older.heartbeat, newer.heartbeat);
        self.slot("adapt", &mut older.adapt, newer.adapt);
        for (older, newer) in older.components.iter_mut().zip(newer.components) {
            self.component(older, newer);
        }
        self.executors(&mut older.executors, newer.executors);
        self.nodes(&mut older.nodes, newer.nodes);
        self.dependencies(&mut older.dependencies, newer.dependencies);
        self.monitors(&mut older.monitors, newer.monitors);
        self.votings(&mut older.votings, newer.votings);
    }

    pub(super) fn component(&self, older: &mut MergedComponent, newer: MergedComponent) {
        self.budget(older, &newer.rules, newer.secondaries);
        self.rules(&mut older.rules, newer.rules);
        let known = older.ports.iter().enumerate();
        let mut positions: HashMap<String, usize> = known
            .map(|(position, (name, _))| (name.value.clone(), position))
            .collect();
        for (name, checks) in newer.ports {
            let position = *positions.entry(name.value.clone()).or_insert_with(|| {
                older.ports.push((name, PortChecks::default()));
                older.ports.len() - 1
            });
            self.checks(&mut older.ports[position].1, checks);
        }
    }

    /// Secondaries stand in a `fault` and go with it.
    fn budget(
        &self,
        older: &mut MergedComponent,
        newer: &ComponentRules,
        secondaries: Vec<DeclaredSecondary>,
    ) {
        let Some(fault) = &newer.fault else {
            return;
        };
        let names = |list: &[DeclaredSecondary]| {
            let names = list.iter();
            names
                .map(|secondary| (secondary.reference.value.clone(), secondary.preload))
                .collect::<Vec<_>>()
        };
        match &older.rules.fault {
            Some(first) if self.mode == Mode::Conflict => {
                if names(&older.secondaries) != names(&secondaries) {
                    self.report("list of secondaries", &first.place, &fault.place);
                }
            }
            _ => older.secondaries = secondaries,
        }
    }

    fn rules(&self, older: &mut ComponentRules, newer: ComponentRules) {
        self.slot("severity", &mut older.severity, newer.severity);
        self.slot("confirm", &mut older.confirmation, newer.confirmation);
        self.list(
            "exception",
            &mut older.exceptions,
            newer.exceptions,
            |rule| rule.class,
        );
        self.list(
            "fault_event",
            &mut older.fault_events,
            newer.fault_events,
            |rule| (rule.name.clone(), rule.port.clone()),
        );
        self.slot("watchdog", &mut older.watchdog, newer.watchdog);
        self.slot("overrun", &mut older.overrun, newer.overrun);
        self.slot("heartbeat", &mut older.heartbeat, newer.heartbeat);
        self.slot("memory", &mut older.memory, newer.memory);
        self.slot("resurrect", &mut older.resurrect, newer.resurrect);
        self.slot("fault", &mut older.fault, newer.fault);
        self.slot("standby", &mut older.standby, newer.standby);
        self.slot("recovery", &mut older.recovery, newer.recovery);
        self.slot("actuator", &mut older.actuator, newer.actuator);
        self.slot("isolation", &mut older.isolation, newer.isolation);
        self.slot("adapt", &mut older.adapt, newer.adapt);
        self.slot("handle", &mut older.handle, newer.handle);
    }

    fn checks(&self, older: &mut PortChecks, newer: PortChecks) {
        self.list("validity", &mut older.validity, newer.validity, |rule| {
            rule.field.clone()
        });
        self.slot("freshness", &mut older.freshness, newer.freshness);
        self.list(
            "rate_of_change",
            &mut older.rate_of_change,
            newer.rate_of_change,
            |rule| rule.field.clone(),
        );
        self.list("stuck", &mut older.stuck, newer.stuck, |rule| {
            rule.field.clone()
        });
        self.list(
            "safe_value",
            &mut older.safe_values,
            newer.safe_values,
            |value| value.field.clone(),
        );
    }

    pub(super) fn executors(&self, older: &mut Vec<ExecutorRules>, newer: Vec<ExecutorRules>) {
        for rules in newer {
            let first = rules.first_component;
            match older
                .iter_mut()
                .find(|other| other.first_component == first)
            {
                Some(other) => {
                    self.slot("overrun", &mut other.overrun, rules.overrun);
                    self.slot("heartbeat", &mut other.heartbeat, rules.heartbeat);
                }
                None => older.push(rules),
            }
        }
    }

    pub(super) fn nodes(
        &self,
        older: &mut Vec<(String, Located<HeartbeatRule>)>,
        newer: Vec<(String, Located<HeartbeatRule>)>,
    ) {
        let same = |a: &(_, Located<HeartbeatRule>), b: &(_, Located<HeartbeatRule>)| {
            a.1.value == b.1.value
        };
        self.keyed(
            "heartbeat",
            older,
            newer,
            |rule| rule.0.clone(),
            |rule| &rule.1.place,
            same,
        );
    }

    pub(super) fn dependencies(
        &self,
        older: &mut Vec<Located<DependencyRule>>,
        newer: Vec<Located<DependencyRule>>,
    ) {
        self.list("dependency", older, newer, |rule| {
            let mut providers: Vec<_> = rule.providers.iter().map(|p| p.entity.clone()).collect();
            providers.sort();
            (rule.dependent.entity.clone(), providers)
        });
    }

    pub(super) fn monitors(&self, older: &mut Vec<MonitorRule>, newer: Vec<MonitorRule>) {
        let same = |a: &MonitorRule, b: &MonitorRule| {
            a.rule.value == b.rule.value && a.inputs == b.inputs && a.outputs == b.outputs
        };
        let name = |monitor: &MonitorRule| monitor.name.clone();
        self.keyed(
            "process_model",
            older,
            newer,
            name,
            |monitor| &monitor.rule.place,
            same,
        );
    }

    pub(super) fn votings(
        &self,
        older: &mut Vec<VotingSpecification>,
        newer: Vec<VotingSpecification>,
    ) {
        let same = |a: &VotingSpecification, b: &VotingSpecification| {
            a.rule.value == b.rule.value && a.sources == b.sources && a.output == b.output
        };
        let name = |voting: &VotingSpecification| voting.name.clone();
        self.keyed(
            "voting",
            older,
            newer,
            name,
            |voting| &voting.rule.place,
            same,
        );
    }

    /// A rule of which there is one.
    pub(super) fn slot<T: PartialEq>(
        &self,
        what: &str,
        older: &mut Option<Located<T>>,
        newer: Option<Located<T>>,
    ) {
        let Some(newer) = newer else {
            return;
        };
        match older {
            Some(first) if self.mode == Mode::Conflict => {
                if first.value != newer.value {
                    self.report(&format!("<{what}>"), &first.place, &newer.place);
                }
            }
            _ => *older = Some(newer),
        }
    }

    /// A rule of which there is one for each key.
    fn list<T: PartialEq, K: Hash + Eq>(
        &self,
        what: &str,
        older: &mut Vec<Located<T>>,
        newer: Vec<Located<T>>,
        key: impl Fn(&T) -> K,
    ) {
        let same = |a: &Located<T>, b: &Located<T>| a.value == b.value;
        self.keyed(
            what,
            older,
            newer,
            |rule| key(&rule.value),
            |rule| &rule.place,
            same,
        );
    }

    fn keyed<T, K: Hash + Eq>(
        &self,
        what: &str,
        older: &mut Vec<T>,
        newer: Vec<T>,
        key: impl Fn(&T) -> K,
        place: impl Fn(&T) -> &Place,
        same: impl Fn(&T, &T) -> bool,
    ) {
        let known = older.iter().enumerate();
        let mut positions: HashMap<K, usize> = known
            .map(|(position, rule)| (key(rule), position))
            .collect();
        for rule in newer {
            match positions.entry(key(&rule)) {
                Entry::Vacant(entry) => {
                    entry.insert(older.len());
                    older.push(rule);
                }
                Entry::Occupied(entry) => {
                    let first = &mut older[*entry.get()];
                    match self.mode {
                        Mode::Override => *first = rule,
                        Mode::Conflict if same(first, &rule) => {}
                        Mode::Conflict => {
                            self.report(&format!("<{what}>"), place(first), place(&rule));
                        }
                    }
                }
            }
        }
    }

    fn report(&self, what: &str, first: &Place, second: &Place) {
        self.assembly.report_at(
            Severity::Error,
            second,
            format!("this {what} contradicts the one at {first}"),
            format!("two rules about the same thing; remove this one or that at {first}"),
        );
    }
}
