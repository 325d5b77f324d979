//! What the fault manager is told.

use std::time::Duration;

use system_model::fault::FaultKind;
use system_model::rules::Judgement;
use system_model::specification::Place;

use crate::evidence::Evidence;
use crate::plan::ActionId;
use crate::verdict::FaultId;

/// Names a detector; an index into the detectors of the fault manager.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct DetectorId(pub usize);

/// Something that can raise symptoms, as a rule or a default has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Detector {
    /// The component that is to blame.
    pub component: usize,
    /// What it looks at.
    pub kind: DetectorKind,
    /// How its symptoms become a fault.
    pub judgement: Judgement,
    /// The rule; none for a default.
    pub place: Option<Place>,
}

/// What a detector looks at. Indices count within the rules of the component.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum DetectorKind {
    /// Runtime exceptions: traps, panics, exits, failures returned. One for each component; the
    /// narrowest `exception` rule decides the severity of each.
    Exception,
    /// `watchdog`. One for each component.
    Hang,
    /// `overrun` of the component or of its executor.
    Overrun,
    /// `heartbeat` of the component, of its executor, its application or its node.
    Heartbeat,
    /// `memory`.
    Memory,
    /// `validity`, by index in `ComponentRules::ports` and then in `PortChecks::validity`.
    Validity {
        /// Index of the port's rules.
        port: usize,
        /// Index of the rule.
        rule: usize,
    },
    /// `freshness` of an input port, by index in `ComponentRules::ports`.
    Freshness {
        /// Index of the port's rules.
        port: usize,
    },
    /// `rate_of_change`.
    RateOfChange {
        /// Index of the port's rules.
        port: usize,
        /// Index of the rule.
        rule: usize,
    },
    /// `stuck`.
    Stuck {
        /// Index of the port's rules.
        port: usize,
        /// Index of the rule.
        rule: usize,
    },
    /// `fault_event`, by index in `ComponentRules::fault_events`. A component without such a rule
    /// has one for whatever it reports through its report service: `None`.
    FaultEvent(Option<usize>),
    /// `process_model`, by index in `FaultRules::monitors`; the component is the one at which the
    /// process begins.
    ProcessModel {
        /// Index of the monitor.
        monitor: usize,
    },
    /// One source of a voter, by index in `FaultRules::votings` and in its sources.
    Voting {
        /// Index of the voter.
        voting: usize,
        /// Index of the source.
        source: usize,
    },
}

/// Something that was observed.
#[derive(Debug, Clone, PartialEq)]
pub enum Observation {
    /// All components have been started: rules that are not `armed="always"` begin to act.
    Running,
    /// A detector found something wrong.
    Symptom(Box<Symptom>),
    /// A detector that had complained finds that all is well again.
    Passed(DetectorId),
    /// An action has ended.
    Ended {
        /// Which.
        action: ActionId,
        /// How.
        outcome: ActionOutcome,
    },
    /// A component completed its first cycle after an action: it works again.
    Works {
        /// Index of the component.
        component: usize,
        /// Its incarnation.
        incarnation: u32,
    },
    /// An operator ends a fault that has healed or is latched; without a number, all of them, and
    /// the emergency stop.
    Clear(Option<FaultId>),
    /// An operator orders something for a component; what makes no sense is ignored
    /// ([`crate::FaultManager::refusal`] says why).
    Ordered {
        /// Index of the component.
        component: usize,
        /// What.
        order: OperatorOrder,
    },
    /// A behaviour tree orders something for a component, as an operator would.
    OrderedByTree {
        /// The tree's index, behind those of all components.
        tree: usize,
        /// Index of the component.
        component: usize,
        /// What.
        order: OperatorOrder,
    },
    /// Nothing but that time has passed.
    Tick,
}

/// What an operator may order for a component.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum OperatorOrder {
    /// Reset it; one that was stopped works again by that.
    Reset,
    /// Put a secondary in its place.
    Replace {
        /// Index in its rules' `secondaries`; `None`: the next one on the ladder.
        secondary: Option<usize>,
    },
    /// Stop it, and what needs it.
    Stop,
}

/// What a detector saw.
#[derive(Debug, Clone, PartialEq)]
pub struct Symptom {
    /// Which detector.
    pub detector: DetectorId,
    /// Incarnation of the component.
    pub incarnation: u32,
    /// What kind of fault it would be.
    pub kind: FaultKind,
    /// What the callback returned, for [`FaultKind::ErrorReturn`]; 0 else.
    pub return_code: u32,
    /// When it manifested itself, by the clock of the application.
    pub at: Duration,
    /// Whether the component still runs. One that does not is in ERROR and must be recovered.
    pub runs: bool,
    /// What was seen.
    pub evidence: Evidence,
}

/// How an action ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ActionOutcome {
    /// As wished; the note says what a person may want to know (which checkpoint was restored).
    Done {
        /// Incarnation of the component afterwards.
        incarnation: u32,
        /// For a person; may be empty.
        note: String,
    },
    /// Not.
    Failed {
        /// Why.
        reason: String,
    },
}
