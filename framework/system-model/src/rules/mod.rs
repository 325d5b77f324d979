//! What counts as a fault, how much it matters and what is done about it: the rules of one
//! application, every name resolved.
//!
//! Every rule is [`Located`]: a verdict names the line that it was judged by. A value that no file
//! gives is a constant of this module, with its reason.

mod detection;
mod diagnosis;
mod handling;
mod monitor;

pub use detection::{
    Arming, Confirmation, DEFAULT_DEADLINE_PERIODS, DEFAULT_HEARTBEATS_MISSED,
    DEFAULT_PERIODLESS_DEADLINE, DEFAULT_STARTUP, ExceptionClass, ExceptionRule, FaultEventRule,
    FreshnessRule, HeartbeatRule, Judgement, MemoryRule, OverrunRule, RateOfChangeRule,
    ReturnCodes, StuckRule, ValidityRule, WatchdogRule,
};
pub use diagnosis::{
    ApplicationSeverity, ComponentSeverity, DependencyRule, DependencySeverity, Entity, Provider,
};
pub use handling::{
    ActuatorRule, AdaptRule, DEFAULT_FAULT_WINDOW, DEFAULT_HANDLE_DEADLINE,
    DEFAULT_PERSISTED_MAX_AGE, DEFAULT_RETRY_MAX, FaultRule, HandleRule, IsolationRule,
    IsolationTier, MAX_RETRY_MAX, MAX_SAFE_STATE_BYTES, Preload, ProcessLimits, RecoveryRule,
    ResurrectRule, SafeStateRule, SafeValue, Secondary, StopCategory, declared_replacement_cost,
    declared_reset_cost,
};
pub use monitor::{
    DecisionRule, MonitorRule, ProcessModelRule, RulePort, VotingMethod, VotingRule, VotingSource,
    VotingSpecification,
};

use std::time::Duration;

use crate::fault::FaultKind;
use crate::profile::Located;
use crate::specification::{ExecutionSemantics, PortDirection};

/// All rules of one application.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FaultRules {
    /// The application's name.
    pub application: String,
    /// What is done for a component that has no `fault` of its own.
    pub fault: Option<Located<FaultRule>>,
    /// The application's own heartbeat.
    pub heartbeat: Option<Located<HeartbeatRule>>,
    /// The task that is watched over.
    pub adapt: Option<Located<AdaptRule>>,
    /// One entry for each of `ApplicationSpecification::components`, in the same order.
    pub components: Vec<ComponentRules>,
    /// Rules of executors.
    pub executors: Vec<ExecutorRules>,
    /// Heartbeats of nodes, by the name of the node.
    pub nodes: Vec<(String, Located<HeartbeatRule>)>,
    /// Who needs whom.
    pub dependencies: Vec<Located<DependencyRule>>,
    /// Process-model monitors.
    pub monitors: Vec<MonitorRule>,
    /// Voters.
    pub votings: Vec<VotingSpecification>,
}

/// All rules of one component.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ComponentRules {
    /// How much a fault of the component matters where the detecting rule does not say.
    pub severity: Option<Located<ComponentSeverity>>,
    /// Debounce of the component's rules that have none of their own.
    pub confirmation: Option<Located<Confirmation>>,
    /// What to do on which runtime exception.
    pub exceptions: Vec<Located<ExceptionRule>>,
    /// Faults that the component reports of itself.
    pub fault_events: Vec<Located<FaultEventRule>>,
    /// Hangs.
    pub watchdog: Option<Located<WatchdogRule>>,
    /// Period overruns.
    pub overrun: Option<Located<OverrunRule>>,
    /// Liveness of the work itself.
    pub heartbeat: Option<Located<HeartbeatRule>>,
    /// Memory that is allocated and not freed.
    pub memory: Option<Located<MemoryRule>>,
    /// Rules of its ports; a port without rules has no entry.
    pub ports: Vec<PortRules>,
    /// Recovery in place.
    pub resurrect: Option<Located<ResurrectRule>>,
    /// Budget of recoveries, and what follows when it is used up.
    pub fault: Option<Located<FaultRule>>,
    /// How much of another instance of the component itself is prepared; none: nothing is.
    pub standby: Option<Located<Preload>>,
    /// What takes the component's place, in order.
    pub secondaries: Vec<Secondary>,
    /// How long a recovery may take.
    pub recovery: Option<Located<RecoveryRule>>,
    /// That the component moves something, and how that is stopped.
    pub actuator: Option<Located<ActuatorRule>>,
    /// Where the component runs.
    pub isolation: Option<Located<IsolationRule>>,
    /// When all recovery is exhausted, the task is to go on without the component.
    pub adapt: Option<Located<AdaptRule>>,
    /// When all recovery is exhausted, a behaviour tree handles the fault.
    pub handle: Option<Located<HandleRule>>,
}

/// All rules of one port.
#[derive(Debug, Clone, PartialEq)]
pub struct PortRules {
    /// Name of the port.
    pub port: String,
    /// Which way it faces.
    pub direction: PortDirection,
    /// Name of its data type as the profile declares it; its fields are known only to the library.
    pub data_type: String,
    /// The rules.
    pub checks: PortChecks,
}

/// What is checked of a port's data.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PortChecks {
    /// Intervals, one for each field.
    pub validity: Vec<Located<ValidityRule>>,
    /// Age of the newest datum.
    pub freshness: Option<Located<FreshnessRule>>,
    /// Jumps, one for each field.
    pub rate_of_change: Vec<Located<RateOfChangeRule>>,
    /// Frozen values, one for each field.
    pub stuck: Vec<Located<StuckRule>>,
    /// What the port reads when its data are stale, and in an emergency stop.
    pub safe_values: Vec<Located<SafeValue>>,
}

/// All rules of one executor.
#[derive(Debug, Clone, PartialEq)]
pub struct ExecutorRules {
    /// Index of the first of the components that it runs; an executor bears that one's name.
    pub first_component: usize,
    /// Period overruns.
    pub overrun: Option<Located<OverrunRule>>,
    /// Liveness of its cycle.
    pub heartbeat: Option<Located<HeartbeatRule>>,
}

impl ComponentRules {
    /// The severity of a runtime exception: that of the rule that names it most narrowly, else the
    /// component's, else [`ComponentSeverity::Reset`].
    pub fn exception_severity(&self, kind: FaultKind, return_code: u32) -> ComponentSeverity {
        let matching = self
            .exceptions
            .iter()
            .filter(|rule| rule.value.class.includes(kind, return_code));
        let narrowest = matching.max_by_key(|rule| rule.value.class.narrowness());
        narrowest
            .and_then(|rule| rule.value.judgement.severity)
            .unwrap_or_else(|| self.default_severity())
    }

    /// The severity of a fault whose rule does not say.
    pub fn default_severity(&self) -> ComponentSeverity {
        let own = self.severity.as_ref().map(|severity| severity.value);
        own.unwrap_or_default()
    }

    /// When a callback of the component is a hang.
    pub fn watchdog_deadline(&self, execution: &ExecutionSemantics) -> Duration {
        let own = self.watchdog.as_ref().and_then(|rule| rule.value.deadline);
        own.unwrap_or(match execution.period {
            Duration::ZERO => DEFAULT_PERIODLESS_DEADLINE,
            period => period.saturating_mul(DEFAULT_DEADLINE_PERIODS),
        })
    }

    /// The debounce of a rule of the component.
    pub fn confirmation(&self, judgement: &Judgement) -> Confirmation {
        let own = self.confirmation.as_ref().map(|rule| rule.value);
        judgement.confirmation.or(own).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specification::{ExecutionKind, Place, SchedulingPolicy};

    fn exception(class: ExceptionClass, severity: ComponentSeverity) -> Located<ExceptionRule> {
        Located {
            value: ExceptionRule {
                class,
                judgement: Judgement {
                    severity: Some(severity),
                    ..Judgement::default()
                },
            },
            place: Place::default(),
        }
    }

    #[test]
    fn the_narrowest_exception_rule_decides() {
        use ComponentSeverity::{Emergency, Ignore, Reset, Stop};
        let mut rules = ComponentRules::default();
        assert_eq!(rules.exception_severity(FaultKind::Panic, 0), Reset);
        rules.exceptions = vec![
            exception(ExceptionClass::ReturnCodes(ReturnCodes::Code(500)), Ignore),
            exception(ExceptionClass::ReturnCodes(ReturnCodes::Callee), Stop),
            exception(ExceptionClass::Any, Emergency),
        ];
        assert_eq!(rules.exception_severity(FaultKind::Panic, 0), Emergency);
        assert_eq!(
            rules.exception_severity(FaultKind::ErrorReturn, 500),
            Ignore
        );
        assert_eq!(rules.exception_severity(FaultKind::ErrorReturn, 502), Stop);
        assert_eq!(
            rules.exception_severity(FaultKind::ErrorReturn, 400),
            Emergency
        );
    }

    #[test]
    fn a_component_without_a_period_has_a_deadline_too() {
        let mut execution = ExecutionSemantics {
            kind: ExecutionKind::Periodic,
            period: Duration::from_millis(20),
            priority: 0,
            policy: SchedulingPolicy::Other,
        };
        let rules = ComponentRules::default();
        assert_eq!(
            rules.watchdog_deadline(&execution),
            Duration::from_millis(60)
        );
        execution.period = Duration::ZERO;
        assert_eq!(
            rules.watchdog_deadline(&execution),
            DEFAULT_PERIODLESS_DEADLINE
        );
    }
}
