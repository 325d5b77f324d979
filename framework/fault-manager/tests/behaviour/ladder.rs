//! Reset, replacement, stop, emergency stop.

use std::time::Duration;

use fault_manager::{Action, Cause, Condition, FaultState, Observation};
use system_model::rules::{
    ApplicationSeverity, ComponentSeverity, Preload, RecoveryRule, ResurrectRule, Secondary,
};

use crate::support::{Bench, application, budget, component, located};

fn reset(component: usize) -> Action {
    Action::Reset {
        component,
        checkpoint_before: None,
    }
}

#[test]
fn a_crash_is_recovered_by_a_reset_and_heals_when_the_component_works() {
    let mut bench = Bench::new(vec![application("robot", &["planner"])]);
    bench.now = Duration::from_millis(100);
    bench.crash(0);
    let action = bench.act();
    assert_eq!(action.action, reset(0));
    assert_eq!(bench.manager.condition(0), Some(Condition::Recovering));
    let verdict = bench.newest();
    assert_eq!(verdict.state, FaultState::Confirmed);
    assert_eq!(verdict.plan, ["reset planner (1 of 3 within 60 s)"]);
    assert_eq!(verdict.handling_us, None);

    bench.now = Duration::from_millis(101);
    bench.done(&action);
    assert_eq!(bench.newest().actions[0].outcome, "done");
    bench.now = Duration::from_millis(103);
    bench.works(0);
    assert_eq!(bench.newest().state, FaultState::Healed);
    assert_eq!(bench.newest().handling_us, Some(3_000));
    assert_eq!(bench.manager.condition(0), Some(Condition::Working));

    bench.wait(1_000);
    assert_eq!(bench.newest().state, FaultState::Cleared);
    assert_eq!(bench.manager.due(), None, "nothing is left to wait for");
}

#[test]
fn the_ladder_ends_with_what_the_application_says() {
    let cases = [
        (
            ApplicationSeverity::Ignore,
            vec![Action::Stop { component: 0 }],
        ),
        (
            ApplicationSeverity::Local,
            vec![Action::Stop { component: 0 }, Action::Stop { component: 1 }],
        ),
        (ApplicationSeverity::Global, vec![Action::EmergencyStop]),
    ];
    for (severity, end) in cases {
        let mut scope = application("robot", &["planner", "camera"]);
        scope.rules.components[0].fault = budget(2, severity);
        scope.rules.components[0].secondaries = vec![Secondary {
            specification: component("simple_planner"),
            preload: Preload::Cold,
        }];
        let replace = Action::Replace {
            component: 0,
            secondary: 0,
            checkpoint_before: None,
        };
        let ladder = [reset(0), reset(0), replace, reset(0), reset(0)];
        let mut bench = Bench::new(vec![scope]);
        for rung in ladder {
            bench.crash(0);
            let action = bench.act();
            assert_eq!(action.action, rung);
            bench.done(&action);
            bench.works(0);
        }
        bench.crash(0);
        assert_eq!(bench.actions(), end, "{severity:?}");
        let global = severity == ApplicationSeverity::Global;
        assert_eq!(bench.manager.is_emergency(), global);
    }
}

#[test]
fn an_attempt_that_fails_or_is_overdue_climbs_within_the_same_verdict() {
    let mut scope = application("robot", &["planner"]);
    scope.rules.components[0].fault = budget(4, ApplicationSeverity::Ignore);
    scope.rules.components[0].recovery = Some(located(RecoveryRule {
        deadline: Duration::from_millis(20),
    }));
    let mut bench = Bench::new(vec![scope]);
    bench.crash(0);
    let first = bench.act();
    assert_eq!(first.deadline, Some(Duration::from_millis(20)));
    bench.failed(&first);
    let second = bench.act();
    assert_eq!(bench.manager.due(), Some(Duration::from_millis(20)));
    bench.wait(20);
    assert_eq!(bench.abandoned, [second.id]);
    let third = bench.act();
    bench.done(&second);
    assert!(bench.acts.is_empty(), "it was abandoned");
    bench.done(&third);
    bench.wait(20);
    let fourth = bench.act();
    bench.done(&fourth);
    bench.crash(0);
    let stop = bench.act();
    assert_eq!(stop.action, Action::Stop { component: 0 });
    bench.done(&stop);
    let outcomes: Vec<&str> = bench
        .newest()
        .actions
        .iter()
        .map(|action| action.outcome)
        .collect();
    assert_eq!(outcomes, ["failed", "overdue", "overdue", "failed", "done"]);
    assert_eq!(bench.records.len(), 1);
    assert_eq!(bench.manager.condition(0), Some(Condition::Stopped));
}

#[test]
fn a_stop_that_fails_is_followed_by_destruction() {
    for late in [false, true] {
        let mut scope = application("robot", &["planner"]);
        scope.rules.components[0].severity = Some(located(ComponentSeverity::Stop));
        let mut bench = Bench::new(vec![scope]);
        bench.crash(0);
        let stop = bench.act();
        assert_eq!(stop.action, Action::Stop { component: 0 });
        if late {
            bench.wait(4_000);
        } else {
            bench.failed(&stop);
        }
        let destroy = bench.act();
        assert_eq!(destroy.action, Action::Destroy { component: 0 });
        bench.failed(&destroy);
        assert!(bench.acts.is_empty());
        assert_eq!(bench.manager.condition(0), Some(Condition::Destroyed));
        assert!(bench.newest().handling_us.is_some());
    }
}

#[test]
fn a_checkpoint_from_before_the_first_symptom_is_wanted_where_there_is_a_backup() {
    let mut scope = application("robot", &["planner"]);
    scope.rules.components[0].resurrect = Some(located(ResurrectRule {
        reset: true,
        backup: Some(Duration::from_millis(50)),
        persist: None,
    }));
    let mut bench = Bench::new(vec![scope]);
    bench.now = Duration::from_millis(7);
    bench.crash(0);
    let before = Some(Duration::from_millis(7));
    let expected = Action::Reset {
        component: 0,
        checkpoint_before: before,
    };
    assert_eq!(bench.act().action, expected);
}

#[test]
fn an_emergency_stops_at_once_and_what_is_in_error_is_recovered_after_the_clear() {
    let mut scope = application("robot", &["driver", "planner"]);
    scope.rules.components[0].severity = Some(located(ComponentSeverity::Emergency));
    let mut bench = Bench::new(vec![scope]);
    bench.crash(0);
    let stop = bench.act();
    assert_eq!(stop.action, Action::EmergencyStop);
    assert!(bench.manager.is_emergency());
    bench.done(&stop);
    bench.crash(1);
    assert!(bench.acts.is_empty(), "no recovery begins now");
    assert_eq!(bench.manager.condition(1), Some(Condition::Waiting));
    bench.tell(Observation::Clear(None));
    assert!(bench.rearmed);
    assert!(!bench.manager.is_emergency());
    assert_eq!(bench.actions(), [reset(0), reset(1)]);
    assert_eq!(bench.newest().cause, Cause::Root);
}
