//! Arming, healing, latching, the queue during a recovery.

use std::time::Duration;

use fault_manager::{
    Action, Cause, Condition, Detector, DetectorKind, FaultManager, FaultState, Observation, Scope,
};
use system_model::fault::FaultKind;
use system_model::rules::{
    Arming, ComponentSeverity, Confirmation, HeartbeatRule, Judgement, MemoryRule, OverrunRule,
};

use crate::support::{Bench, application, located};

/// The detector that most cases are about.
pub const OVERRUN: DetectorKind = DetectorKind::Overrun;

/// One component whose overruns are judged so.
pub fn overruns(judgement: Judgement) -> Scope {
    let mut scope = application("robot", &["planner"]);
    scope.rules.components[0].overrun = Some(located(OverrunRule {
        tolerated: 0,
        within: Duration::from_secs(1),
        judgement,
    }));
    scope
}

/// So severe, after so many symptoms.
pub fn judged(severity: ComponentSeverity, count: u32, within_ms: Option<u64>) -> Judgement {
    Judgement {
        confirmation: Some(Confirmation {
            count,
            within: within_ms.map(Duration::from_millis),
        }),
        severity: Some(severity),
        ..Judgement::default()
    }
}

#[test]
fn a_fault_heals_is_over_after_a_quiet_time_and_comes_again_as_another() {
    let judgement = judged(ComponentSeverity::Ignore, 1, None);
    let mut bench = Bench::new(vec![overruns(judgement)]);
    let detector = bench.detector(0, &OVERRUN);
    bench.complain(0, &OVERRUN, FaultKind::Overrun, true);
    let first = bench.newest().id;
    bench.complain(0, &OVERRUN, FaultKind::Overrun, true);
    assert_eq!(bench.records.len(), 1, "a repeated symptom is no new fault");
    bench.tell(Observation::Passed(detector));
    assert_eq!(bench.records[&first].state, FaultState::Healed);
    assert_eq!(bench.records[&first].symptoms, 2);
    bench.wait(10);
    bench.complain(0, &OVERRUN, FaultKind::Overrun, true);
    assert_eq!(bench.records[&first].state, FaultState::Cleared);
    assert_eq!(bench.newest().state, FaultState::Confirmed);
    assert_ne!(bench.newest().id, first);
    bench.tell(Observation::Passed(detector));
    bench.wait(1_000);
    assert_eq!(bench.newest().state, FaultState::Cleared);
}

#[test]
fn a_latched_fault_is_handled_but_ends_only_by_a_clear() {
    let judgement = Judgement {
        latched: true,
        ..judged(ComponentSeverity::Reset, 1, None)
    };
    for all in [false, true] {
        let mut bench = Bench::new(vec![overruns(judgement)]);
        let detector = bench.detector(0, &OVERRUN);
        for _ in 0..2 {
            bench.complain(0, &OVERRUN, FaultKind::Overrun, true);
            let reset = bench.act();
            bench.done(&reset);
            bench.works(0);
            bench.tell(Observation::Passed(detector));
            bench.wait(5_000);
        }
        let verdict = bench.newest().clone();
        assert_eq!(verdict.state, FaultState::Confirmed);
        assert_eq!(verdict.actions.len(), 2, "the same fault, handled twice");
        let clear = if all { None } else { Some(verdict.id) };
        bench.tell(Observation::Clear(clear));
        assert_eq!(bench.newest().state, FaultState::Cleared);
        assert!(!bench.rearmed, "there was no emergency stop");
    }
}

#[test]
fn an_occurrence_that_was_ignored_is_over_when_it_does_not_come_again() {
    let mut scope = application("robot", &["planner"]);
    scope.rules.components[0].severity = Some(located(ComponentSeverity::Ignore));
    let mut bench = Bench::new(vec![scope]);
    let report = DetectorKind::FaultEvent(None);
    bench.complain(0, &report, FaultKind::Reported, true);
    bench.wait(600);
    bench.complain(0, &report, FaultKind::Reported, true);
    bench.wait(600);
    assert_eq!(bench.newest().state, FaultState::Confirmed);
    bench.wait(400);
    assert_eq!(bench.newest().state, FaultState::Healed);
}

#[test]
fn before_the_application_runs_failures_are_kept_and_other_symptoms_are_not() {
    let always = Judgement {
        arming: Arming::Always,
        ..judged(ComponentSeverity::Stop, 1, None)
    };
    for (judgement, acts) in [(Judgement::default(), 0), (always, 1)] {
        let mut bench = Bench::new(vec![overruns(judgement)]);
        bench.manager = FaultManager::new(vec![overruns(judgement)]);
        bench.complain(0, &OVERRUN, FaultKind::Overrun, true);
        assert_eq!(bench.acts.len(), acts);
        bench.tell(Observation::Running);
        assert!(bench.acts.is_empty());
    }
    let mut bench = Bench::new(vec![overruns(Judgement::default())]);
    bench.manager = FaultManager::new(vec![overruns(Judgement::default())]);
    bench.crash(0);
    assert!(bench.acts.is_empty());
    bench.tell(Observation::Running);
    assert!(matches!(bench.act().action, Action::Reset { .. }));
}

#[test]
fn what_comes_during_a_recovery_is_judged_when_it_has_ended() {
    let judgement = judged(ComponentSeverity::Reset, 1, None);
    let mut bench = Bench::new(vec![overruns(judgement)]);
    bench.crash(0);
    let reset = bench.act();
    let owner = bench.newest().id;
    bench.complain(0, &OVERRUN, FaultKind::Overrun, true);
    assert_eq!(bench.records.len(), 1, "queued");
    bench.done(&reset);
    assert_eq!(
        bench.newest().cause,
        Cause::ConsequenceOf(owner),
        "of the old instance"
    );
    bench.complain(0, &OVERRUN, FaultKind::Overrun, true);
    assert!(bench.acts.is_empty(), "queued");
    bench.works(0);
    assert_eq!(bench.newest().cause, Cause::Root, "of the new instance");
    assert!(matches!(bench.act().action, Action::Reset { .. }));
    let healed = bench
        .records
        .values()
        .filter(|one| one.state == FaultState::Healed);
    assert_eq!(
        healed.count(),
        1,
        "the crash; the old overrun gave way to the new"
    );
}

#[test]
fn what_is_too_much_for_the_queue_is_counted_and_a_failure_is_not_lost() {
    let mut bench = Bench::new(vec![overruns(Judgement::default())]);
    bench.crash(0);
    let reset = bench.act();
    bench.incarnations[0] = 2;
    for _ in 0..40 {
        bench.complain(0, &OVERRUN, FaultKind::Overrun, true);
    }
    bench.crash(0);
    bench.incarnations[0] = 1;
    bench.done(&reset);
    let verdict = bench.records.values().next().expect("a record");
    assert_eq!(
        verdict.symptoms,
        1 + 8 + 1 + 1,
        "8 too many, then the newest, then the failure"
    );
    assert_eq!(verdict.actions[0].outcome, "failed");
    assert_eq!(bench.manager.condition(0), Some(Condition::Recovering));
}

#[test]
fn everything_has_its_detectors() {
    let mut scope = overruns(Judgement::default());
    scope
        .specification
        .components
        .push(crate::support::component("camera"));
    scope.rules.heartbeat = Some(located(HeartbeatRule {
        period: Duration::from_secs(1),
        missed: 3,
        judgement: Judgement::default(),
    }));
    scope.rules.components[0].memory = Some(located(MemoryRule {
        limit_bytes: 1 << 20,
        judgement: Judgement::default(),
    }));
    let manager = FaultManager::new(vec![application("other", &["clock"]), scope]);
    let found: Vec<(usize, DetectorKind)> = manager
        .detectors()
        .iter()
        .map(
            |Detector {
                 component, kind, ..
             }| (*component, kind.clone()),
        )
        .collect();
    let mut expected = Vec::new();
    for component in 0..3 {
        expected.push((component, DetectorKind::Exception));
        expected.push((component, DetectorKind::Hang));
        expected.push((component, DetectorKind::FaultEvent(None)));
        if component == 1 {
            expected.push((component, DetectorKind::Overrun));
        }
        if component > 0 {
            expected.push((component, DetectorKind::Heartbeat));
        }
        if component == 1 {
            expected.push((component, DetectorKind::Memory));
        }
    }
    assert_eq!(found, expected);
    for (index, (component, kind)) in found.iter().enumerate() {
        assert_eq!(
            manager.detector(*component, kind).map(|id| id.0),
            Some(index)
        );
    }
    assert_eq!(manager.detector(0, &DetectorKind::Overrun), None);
    assert_eq!(manager.detector(9, &DetectorKind::Hang), None);
}
