//! What is watched of a component, in sentences: each detector that the fault manager has, with what
//! its faults come to.

mod symptoms;

use std::time::Duration;

use fault_manager::{Detector, DetectorKind, Scope};
use serde::Serialize;
use symptoms::{class, heartbeat, model, of_port, overrun};
use system_model::rules::{
    Arming, ComponentRules, ComponentSeverity, DEFAULT_STARTUP, ExceptionClass, HeartbeatRule,
    Judgement, OverrunRule,
};
use system_model::specification::Place;

/// One thing that is watched.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Watched {
    /// What counts as a symptom.
    pub symptom: String,
    /// When symptoms are a fault; empty if the first one is.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub confirmation: String,
    /// What is done about the fault.
    pub then: &'static str,
    /// `ignore`, `reset`, `stop` or `emergency`.
    pub severity: &'static str,
    /// The rule; none for a default.
    pub rule: Option<String>,
}

/// The component whose detectors are put into words.
pub struct Subject<'a> {
    /// Its application.
    pub scope: &'a Scope,
    /// Its index in that.
    pub component: usize,
}

impl Subject<'_> {
    /// What a detector watches; several sentences where several rules share it.
    pub fn watched(&self, detector: &Detector) -> Vec<Watched> {
        let Some(symptom) = self.symptom(&detector.kind) else {
            return Vec::new();
        };
        let rules = self.rules();
        let mut all = vec![
            self.entry(
                symptom,
                &detector.judgement,
                match detector.kind {
                    DetectorKind::Exception => rules.exception_severity(FAULT_OF_NO_CLASS, 0),
                    DetectorKind::Hang => hang_severity(rules, &detector.judgement),
                    _ => detector
                        .judgement
                        .severity
                        .unwrap_or(rules.default_severity()),
                },
                detector.place.as_ref(),
            ),
        ];
        if detector.kind == DetectorKind::Exception {
            let narrower = rules.exceptions.iter();
            let narrower = narrower.filter(|rule| rule.value.class != ExceptionClass::Any);
            all.extend(narrower.map(|rule| {
                let judgement = &rule.value.judgement;
                let severity = judgement.severity.unwrap_or(rules.default_severity());
                self.entry(
                    class(rule.value.class),
                    judgement,
                    severity,
                    Some(&rule.place),
                )
            }));
        }
        all
    }

    fn entry(
        &self,
        symptom: String,
        judgement: &Judgement,
        severity: ComponentSeverity,
        place: Option<&Place>,
    ) -> Watched {
        let confirmation = self.rules().confirmation(judgement);
        let mut conditions = Vec::new();
        match (confirmation.count, confirmation.within) {
            (1, _) => {}
            (count, Some(within)) => {
                conditions.push(format!("{count} times within {}", time(within)))
            }
            (count, None) => conditions.push(format!("{count} times in a row")),
        }
        if judgement.arming == Arming::Always {
            conditions.push("already while the application is brought up".to_owned());
        }
        if judgement.latched {
            conditions.push("until an operator clears it".to_owned());
        }
        Watched {
            symptom,
            confirmation: conditions.join(", "),
            then: consequence(severity),
            severity: severity_name(severity),
            rule: place.map(ToString::to_string),
        }
    }

    fn rules(&self) -> &ComponentRules {
        &self.scope.rules.components[self.component]
    }

    fn symptom(&self, kind: &DetectorKind) -> Option<String> {
        let rules = self.rules();
        Some(match kind {
            DetectorKind::Exception => {
                "It panics, traps, exits, or a callback of it returns a failure".to_owned()
            }
            DetectorKind::Hang => self.hang(),
            DetectorKind::FaultEvent(None) => "It reports a fault of its own".to_owned(),
            DetectorKind::FaultEvent(Some(index)) => {
                let rule = &rules.fault_events.get(*index)?.value;
                match &rule.port {
                    Some(port) => format!("It raises the event {} at its port {port}", rule.name),
                    None => format!("It reports {}", rule.name),
                }
            }
            DetectorKind::Overrun => overrun(self.overrun()?),
            DetectorKind::Heartbeat => heartbeat(self.heartbeat()?),
            DetectorKind::Memory => {
                let limit = rules.memory.as_ref()?.value.limit_bytes / 1024;
                format!("It has allocated more than {limit} KB and not freed them")
            }
            DetectorKind::ProcessModel { monitor } => {
                model(self.scope, self.scope.rules.monitors.get(*monitor)?)
            }
            DetectorKind::Voting { voting, .. } => {
                let rule = self.scope.rules.votings.get(*voting)?;
                format!(
                    "It differs by more than {} from what {} has voted, and others do not",
                    rule.rule.value.tolerance, rule.name
                )
            }
            DetectorKind::Validity { port, .. }
            | DetectorKind::Freshness { port }
            | DetectorKind::RateOfChange { port, .. }
            | DetectorKind::Stuck { port, .. } => of_port(rules.ports.get(*port)?, kind)?,
        })
    }

    fn hang(&self) -> String {
        let specification = &self.scope.specification.components[self.component];
        let limit = self.rules().watchdog_deadline(&specification.execution);
        let watchdog = self.rules().watchdog.as_ref();
        let startup = watchdog.map_or(DEFAULT_STARTUP, |rule| rule.value.startup);
        format!(
            "A callback of it does not return within {} ({} while it is brought up)",
            time(limit),
            time(startup)
        )
    }

    fn overrun(&self) -> Option<&OverrunRule> {
        let own = self.rules().overrun.as_ref();
        let inherited = self.scope.rules.executors.iter();
        let mut inherited = inherited.filter_map(|rule| rule.overrun.as_ref());
        own.or_else(|| inherited.next()).map(|rule| &rule.value)
    }

    fn heartbeat(&self) -> Option<&HeartbeatRule> {
        let all = &self.scope.rules;
        let executors = all
            .executors
            .iter()
            .filter_map(|rule| rule.heartbeat.as_ref());
        let nodes = all.nodes.iter().map(|(_, rule)| rule);
        let own = self.rules().heartbeat.iter();
        let mut candidates = own.chain(executors).chain(&all.heartbeat).chain(nodes);
        candidates.next().map(|rule| &rule.value)
    }
}

/// A kind for which there is hardly a rule of its own: what `any` comes to.
const FAULT_OF_NO_CLASS: system_model::fault::FaultKind = system_model::fault::FaultKind::HostEnded;

fn hang_severity(rules: &ComponentRules, judgement: &Judgement) -> ComponentSeverity {
    let own = judgement.severity;
    own.unwrap_or_else(|| rules.exception_severity(system_model::fault::FaultKind::Hang, 0))
}

fn severity_name(severity: ComponentSeverity) -> &'static str {
    match severity {
        ComponentSeverity::Ignore => "ignore",
        ComponentSeverity::Reset => "reset",
        ComponentSeverity::Stop => "stop",
        ComponentSeverity::Emergency => "emergency",
    }
}

fn consequence(severity: ComponentSeverity) -> &'static str {
    match severity {
        ComponentSeverity::Ignore => "it is recorded, nothing else",
        ComponentSeverity::Reset => "it is recovered by the ladder below",
        ComponentSeverity::Stop => "it is stopped, and what needs it",
        ComponentSeverity::Emergency => "emergency stop at once",
    }
}

/// `20 ms`, `1.5 s`, `2 min`.
pub fn time(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    match seconds {
        _ if seconds < 1e-3 => format!("{} us", seconds * 1e6),
        _ if seconds < 1.0 => format!("{} ms", seconds * 1e3),
        _ if seconds >= 120.0 && time.as_secs().is_multiple_of(60) => {
            format!("{} min", time.as_secs() / 60)
        }
        _ => format!("{seconds} s"),
    }
}
