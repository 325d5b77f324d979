//! Root causes and consequences; what waits, and for what.

use std::time::Duration;

use fault_manager::{Action, Cause, Condition, DetectorKind, FaultState, Observation, Scope};
use system_model::fault::FaultKind;
use system_model::rules::{
    ApplicationSeverity, ComponentSeverity, DependencySeverity, Entity, FreshnessRule, Judgement,
    PortChecks, PortRules,
};
use system_model::specification::{
    ConnectionSpecification, Place, PortDirection, PortKind, PortReference,
};

use crate::support::{Bench, application, budget, located, needs};

const FRESHNESS: DetectorKind = DetectorKind::Freshness { port: 0 };

/// camera -> detector -> planner: the planner needs the detector by rule, the detector gets its
/// pictures over a connection and says when they are old.
fn chain() -> Scope {
    let mut scope = application("robot", &["camera", "detector", "planner"]);
    scope.specification.connections = vec![ConnectionSpecification {
        kind: PortKind::Data,
        source: PortReference {
            component: 0,
            port: "picture".to_owned(),
        },
        target: PortReference {
            component: 1,
            port: "input".to_owned(),
        },
        place: Place::default(),
    }];
    scope.rules.components[1].ports = vec![PortRules {
        port: "input".to_owned(),
        direction: PortDirection::Input,
        data_type: String::new(),
        checks: PortChecks {
            freshness: Some(located(FreshnessRule {
                maximum_age: Duration::from_millis(200),
                judgement: Judgement::default(),
            })),
            ..PortChecks::default()
        },
    }];
    let (planner, detector) = (Entity::Component(2), Entity::Component(1));
    needs(
        &mut scope,
        planner,
        &[detector],
        1,
        DependencySeverity::Ignore,
    );
    scope
}

fn resets(bench: &Bench) -> Vec<usize> {
    bench
        .acts
        .iter()
        .filter_map(|act| match act.action {
            Action::Reset { component, .. } => Some(component),
            _ => None,
        })
        .collect()
}

#[test]
fn a_stale_input_is_a_consequence_of_the_fault_of_its_source() {
    let mut bench = Bench::new(vec![chain()]);
    bench.crash(0);
    let (root, reset) = (bench.newest().id, bench.act());
    bench.complain(1, &FRESHNESS, FaultKind::Stale, true);
    assert_eq!(bench.newest().cause, Cause::ConsequenceOf(root));
    assert!(bench.acts.is_empty());
    bench.done(&reset);
    bench.works(0);
    let detector = bench.detector(1, &FRESHNESS);
    bench.tell(Observation::Passed(detector));
    assert_eq!(bench.newest().state, FaultState::Healed);

    bench.wait(999);
    bench.complain(1, &FRESHNESS, FaultKind::Stale, true);
    assert_eq!(
        bench.newest().cause,
        Cause::ConsequenceOf(root),
        "not long ago"
    );
    bench.wait(1);
    bench.complain(1, &FRESHNESS, FaultKind::Stale, true);
    assert_eq!(bench.newest().cause, Cause::Root, "too long ago");
    assert_eq!(resets(&bench), [1]);
}

#[test]
fn a_crash_of_a_component_says_nothing_of_its_data_source_but_of_what_it_needs() {
    let mut bench = Bench::new(vec![chain()]);
    bench.crash(0);
    bench.crash(1);
    assert_eq!(resets(&bench), [1], "no rule says that it needs the camera");
    let root = bench.newest().id;
    bench.crash(2);
    assert_eq!(bench.newest().cause, Cause::ConsequenceOf(root));
    assert_eq!(resets(&bench), []);
}

#[test]
fn a_consequence_in_error_is_judged_anew_when_its_cause_has_been_handled() {
    let mut bench = Bench::new(vec![chain()]);
    bench.crash(1);
    let (root, reset) = (bench.newest().id, bench.act());
    bench.wait(2);
    bench.crash(2);
    let consequence = bench.newest().id;
    assert_eq!(bench.manager.condition(2), Some(Condition::Waiting));
    bench.done(&reset);
    assert!(bench.acts.is_empty());
    bench.wait(3);
    bench.works(1);
    assert_eq!(resets(&bench), [2]);
    let old = &bench.records[&consequence];
    assert_eq!(old.cause, Cause::ConsequenceOf(root));
    assert_eq!(old.state, FaultState::Cleared);
    assert!(old.actions.is_empty());
    assert_eq!(old.plan, ["judged anew as fault 3"]);
    assert_eq!(bench.newest().cause, Cause::Root);
    assert_eq!(bench.newest().decision_us, 3_000, "so long it had to wait");
}

#[test]
fn a_consequence_in_error_is_judged_anew_when_its_cause_ends_in_a_stop() {
    let mut scope = chain();
    scope.rules.components[1].fault = budget(0, ApplicationSeverity::Ignore);
    let mut bench = Bench::new(vec![scope]);
    bench.crash(1);
    let stop = bench.act();
    bench.crash(2);
    assert!(bench.acts.is_empty());
    bench.done(&stop);
    assert_eq!(resets(&bench), [2]);
    let reset = bench.act();
    bench.done(&reset);
    bench.works(2);
    bench.wait(3_600_000);
    bench.complain(
        2,
        &DetectorKind::FaultEvent(None),
        FaultKind::Reported,
        true,
    );
    assert!(
        matches!(bench.newest().cause, Cause::ConsequenceOf(_)),
        "it lacks the detector still"
    );
    bench.crash(2);
    assert_eq!(resets(&bench), [2], "but it is not left in ERROR");
}

#[test]
fn a_consequence_that_goes_on_when_its_cause_is_over_becomes_a_root_cause() {
    let mut bench = Bench::new(vec![chain()]);
    bench.crash(0);
    let reset = bench.act();
    bench.complain(1, &FRESHNESS, FaultKind::Stale, true);
    bench.done(&reset);
    bench.works(0);
    bench.wait(500);
    bench.complain(1, &FRESHNESS, FaultKind::Stale, true);
    assert!(bench.acts.is_empty());
    bench.wait(500);
    bench.complain(1, &FRESHNESS, FaultKind::Stale, true);
    assert_eq!(resets(&bench), [1]);
    assert_eq!(bench.newest().cause, Cause::Root);
}

#[test]
fn an_emergency_is_never_held_back() {
    let mut scope = chain();
    scope.rules.components[2].severity = Some(located(ComponentSeverity::Emergency));
    let mut bench = Bench::new(vec![scope]);
    bench.crash(1);
    let (root, reset) = (bench.newest().id, bench.act());
    bench.crash(2);
    assert_eq!(bench.actions(), [Action::EmergencyStop]);
    assert_eq!(bench.newest().cause, Cause::ConsequenceOf(root));
    bench.failed(&reset);
    assert!(bench.acts.is_empty(), "the next attempt waits");
    assert_eq!(bench.manager.condition(1), Some(Condition::Waiting));
    let emergency = bench.newest().id;
    bench.tell(Observation::Clear(Some(root)));
    assert!(!bench.rearmed);
    bench.tell(Observation::Clear(Some(emergency)));
    assert!(bench.rearmed);
    assert_eq!(resets(&bench), [1], "the cause first");
    let reset = bench.act();
    bench.done(&reset);
    bench.works(1);
    assert_eq!(resets(&bench), [2]);
}

#[test]
fn an_emergency_stop_that_failed_is_tried_again_for_the_next_fault() {
    let mut scope = application("robot", &["driver", "other"]);
    for rules in &mut scope.rules.components {
        rules.severity = Some(located(ComponentSeverity::Emergency));
    }
    let report = DetectorKind::FaultEvent(None);
    let mut bench = Bench::new(vec![scope]);
    bench.complain(0, &report, FaultKind::Reported, true);
    let stop = bench.act();
    bench.complain(1, &report, FaultKind::Reported, true);
    assert!(bench.acts.is_empty(), "it is under way");
    bench.failed(&stop);
    bench.complain(1, &report, FaultKind::Reported, true);
    let again = bench.act();
    assert_eq!(again.action, Action::EmergencyStop);
    bench.wait(4_000);
    assert_eq!(bench.abandoned, [again.id], "overdue");
    assert!(bench.manager.is_emergency());
    bench.tell(Observation::Clear(None));
    assert!(bench.rearmed && bench.acts.is_empty(), "both run");
}

#[test]
fn a_crash_while_the_emergency_stop_is_under_way_is_not_lost() {
    let mut scope = application("robot", &["driver"]);
    scope.rules.components[0].fault = budget(0, ApplicationSeverity::Global);
    let mut bench = Bench::new(vec![scope]);
    bench.complain(0, &DetectorKind::Exception, FaultKind::Panic, true);
    let stop = bench.act();
    assert_eq!(stop.action, Action::EmergencyStop);
    bench.crash(0);
    assert_eq!(bench.manager.condition(0), Some(Condition::Waiting));
    bench.done(&stop);
    assert_eq!(bench.manager.condition(0), Some(Condition::Waiting));
}
