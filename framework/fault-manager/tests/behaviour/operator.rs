//! What an operator orders.

use fault_manager::{
    Action, Cause, Condition, Evidence, FaultState, Observation, OperatorOrder, Scope,
};
use system_model::fault::FaultKind;
use system_model::rules::{
    ApplicationSeverity, ComponentSeverity, DependencySeverity, Entity, Preload, Secondary,
};

use crate::support::{Bench, application, budget, component, located, needs};

const RESET: Action = Action::Reset {
    component: 0,
    checkpoint_before: None,
};

/// `planner` needs `camera`, which has two secondaries.
fn robot() -> Scope {
    let mut scope = application("robot", &["camera", "planner"]);
    let secondary = |name: &str| Secondary {
        specification: component(name),
        preload: Preload::Cold,
    };
    let camera = &mut scope.rules.components[0];
    camera.secondaries = vec![secondary("spare"), secondary("other")];
    camera.fault = budget(1, ApplicationSeverity::Ignore);
    let (dependent, provider) = (Entity::Component(1), Entity::Component(0));
    needs(
        &mut scope,
        dependent,
        &[provider],
        1,
        DependencySeverity::Stop,
    );
    scope
}

fn replace(secondary: usize) -> Action {
    Action::Replace {
        component: 0,
        secondary,
        checkpoint_before: None,
    }
}

fn order(bench: &mut Bench, component: usize, order: OperatorOrder) {
    let refusal = bench.manager.refusal(component, order);
    assert_eq!(refusal, None, "{order:?}");
    bench.tell(Observation::Ordered { component, order });
}

#[test]
fn a_reset_is_a_verdict_of_its_own_and_heals_when_the_component_works() {
    let mut bench = Bench::new(vec![robot()]);
    order(&mut bench, 0, OperatorOrder::Reset);
    let act = bench.act();
    assert_eq!(act.action, RESET);
    let verdict = bench.newest();
    assert_eq!(verdict.kind, FaultKind::OperatorOrder.name());
    assert_eq!(verdict.cause, Cause::Root);
    assert_eq!(verdict.rule, None);
    let words = "reset camera".to_owned();
    assert_eq!(verdict.plan, [words.as_str()]);
    assert_eq!(
        verdict.evidence,
        Evidence::Order {
            order: words,
            by: None
        }
    );
    bench.done(&act);
    assert_eq!(bench.newest().state, FaultState::Confirmed);
    bench.works(0);
    assert_eq!(bench.newest().state, FaultState::Healed);
    assert_eq!(bench.manager.condition(0), Some(Condition::Working));
}

/// It costs none of the budget, and begins it anew.
#[test]
fn what_is_ordered_does_not_count_on_the_ladder_but_its_failure_climbs_it() {
    let mut bench = Bench::new(vec![robot()]);
    for _ in 0..5 {
        order(&mut bench, 0, OperatorOrder::Reset);
        let act = bench.act();
        bench.done(&act);
        bench.works(0);
    }
    bench.crash(0);
    assert_eq!(bench.act().action, RESET, "the budget of one is there");
    let act = bench.act();
    bench.done(&act);
    bench.works(0);
    order(&mut bench, 0, OperatorOrder::Reset);
    let mut tried = Vec::new();
    while let [act] = &bench.acts[..] {
        let act = act.clone();
        tried.push(act.action.clone());
        bench.failed(&act);
        if tried.len() == 4 {
            break;
        }
    }
    assert_eq!(tried, [RESET, RESET, replace(0), replace(1)]);
    assert_eq!(bench.manager.condition(1), Some(Condition::Stopped));
}

#[test]
fn a_secondary_is_chosen_or_the_next_one_in_turn() {
    let mut bench = Bench::new(vec![robot()]);
    for (secondary, expected) in [(None, 0), (None, 1), (None, 0), (Some(1), 1), (Some(0), 0)] {
        order(&mut bench, 0, OperatorOrder::Replace { secondary });
        let act = bench.act();
        assert_eq!(act.action, replace(expected), "{secondary:?}");
        bench.done(&act);
        bench.works(0);
        assert_eq!(bench.newest().state, FaultState::Healed);
    }
}

#[test]
fn who_is_stopped_takes_along_what_needs_it_and_both_come_back() {
    let mut bench = Bench::new(vec![robot()]);
    order(&mut bench, 0, OperatorOrder::Stop);
    let stopped = [Action::Stop { component: 1 }, Action::Stop { component: 0 }];
    assert_eq!(bench.actions(), stopped);
    let stop = bench.newest().id;
    for act in bench.acts.clone() {
        bench.done(&act);
    }
    let refused = bench.manager.refusal(1, OperatorOrder::Reset);
    assert_eq!(
        refused.as_deref(),
        Some("planner needs 0; reset that first")
    );
    bench.wait(60_000);
    assert_eq!(bench.records[&stop].state, FaultState::Confirmed);
    order(&mut bench, 0, OperatorOrder::Reset);
    let act = bench.act();
    bench.done(&act);
    bench.works(0);
    assert_eq!(bench.records[&stop].state, FaultState::Healed);
    assert_eq!(bench.manager.condition(1), Some(Condition::Stopped));
    order(&mut bench, 1, OperatorOrder::Reset);
    let act = bench.act();
    bench.done(&act);
    bench.works(1);
    assert_eq!(bench.manager.condition(1), Some(Condition::Working));
}

/// What the rules have taken down an operator may bring back, and the fault behind it is over then.
#[test]
fn who_was_stopped_by_a_rule_works_again_by_an_order() {
    let mut scope = robot();
    scope.rules.components[0].severity = Some(located(ComponentSeverity::Stop));
    let mut bench = Bench::new(vec![scope]);
    bench.crash(0);
    let fault = bench.newest().id;
    for act in bench.acts.clone() {
        bench.done(&act);
    }
    assert_eq!(bench.manager.condition(0), Some(Condition::Stopped));
    order(&mut bench, 0, OperatorOrder::Reset);
    let act = bench.act();
    bench.done(&act);
    bench.works(0);
    assert_eq!(bench.records[&fault].state, FaultState::Healed);
    assert_eq!(bench.manager.condition(0), Some(Condition::Working));
}

#[test]
fn what_makes_no_sense_is_refused_and_changes_nothing() {
    let refused = |bench: &mut Bench, component, order, why: &str| {
        let reason = bench.manager.refusal(component, order);
        let reason = reason.unwrap_or_else(|| panic!("{order:?} is not refused"));
        assert!(reason.contains(why), "{reason}");
        bench.tell(Observation::Ordered { component, order });
        assert!(bench.acts.is_empty(), "{order:?}");
    };
    let next = OperatorOrder::Replace { secondary: None };
    let third = OperatorOrder::Replace { secondary: Some(2) };
    let mut bench = Bench::new(vec![robot()]);
    refused(&mut bench, 7, OperatorOrder::Stop, "no such component");
    refused(
        &mut bench,
        1,
        next,
        "the rules name no secondary for planner",
    );
    refused(&mut bench, 0, third, "no secondary of that name");
    bench.crash(0);
    refused(&mut bench, 0, OperatorOrder::Reset, "recovered for fault 1");
    let mut bench = Bench::new(vec![robot()]);
    order(&mut bench, 0, OperatorOrder::Stop);
    refused(&mut bench, 0, OperatorOrder::Reset, "is being stopped");
    refused(&mut bench, 0, OperatorOrder::Stop, "stopped already");
    let mut scope = robot();
    scope.rules.components[1].severity = Some(located(ComponentSeverity::Emergency));
    let mut bench = Bench::new(vec![scope]);
    bench.crash(1);
    refused(&mut bench, 0, OperatorOrder::Reset, "emergency stop");
    refused(&mut bench, 0, next, "emergency stop");
}
