//! The decider never takes what is infeasible and never changes faster than its dwell time, whatever
//! it is told.

mod shell;
mod support;

use std::time::Duration;

use proptest::prelude::*;
use shell::{DWELL, Shell, Step, on, task};
use task_adaptation::{DeciderState, Effect, Observation, Outcome, Trigger};

fn steps() -> impl Strategy<Value = Step> {
    let number = prop_oneof![
        3 => 0.0..2.0_f64,
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 1e300]),
    ];
    prop_oneof![
        4 => number.clone().prop_map(Step::Evaluate),
        1 => Just(Step::Request),
        4 => (1..4000_u16).prop_map(Step::Wait),
        1 => (0..2_usize, any::<bool>()).prop_map(|(robot, is_there)| Step::Robot(robot, is_there)),
        8 => (number, any::<bool>()).prop_map(|(error, fails)| Step::Answer(error, fails)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn nothing_infeasible_and_no_flapping(steps in prop::collection::vec(steps(), 1..150)) {
        let mut shell = Shell::new();
        for step in &steps {
            shell.step(step);
            let is_waiting = shell.decider.state() != DeciderState::Monitoring;
            prop_assert!(!is_waiting || shell.decider.deadline() > Some(shell.now));
        }
        // Whatever is open, time ends it, or at least the attempt.
        for _ in 0..20 {
            shell.now += Duration::from_secs(10);
            shell.tell(Observation::TimePassed);
        }
    }
}

/// Answers all questions at once, with the same error of every component.
fn decide(shell: &mut Shell, error: f64) {
    while !shell.open.is_empty() {
        shell.answer(error, false);
    }
}

#[test]
fn confirmed_bad_evaluations_lead_through_four_states_to_a_change() {
    let mut shell = Shell::new();
    for count in 0..3 {
        assert_eq!(shell.decider.state(), DeciderState::Monitoring, "{count}");
        shell.step(&Step::Evaluate(1.5));
        shell.step(&Step::Wait(20));
    }
    assert_eq!(shell.decider.state(), DeciderState::Synthesising);
    shell.step(&Step::Wait(5));
    shell.answer(0.1, false);
    assert_eq!(shell.decider.state(), DeciderState::Estimating);
    shell.step(&Step::Wait(30));
    while shell.decider.state() == DeciderState::Estimating {
        shell.answer(0.1, false);
    }
    assert_eq!(shell.decider.state(), DeciderState::Reconfiguring);
    shell.step(&Step::Wait(100));
    shell.answer(0.1, false);
    let verdict = shell.verdicts.first().expect("a verdict");
    assert_eq!(verdict.trigger, Trigger::Evaluated { bad_evaluations: 3 });
    let times = [
        verdict.phases.monitoring,
        verdict.phases.synthesis,
        verdict.phases.estimation,
        verdict.phases.reconfiguration,
    ];
    // The second wait of 20 ms came after the third evaluation.
    assert_eq!(times.map(|it| it.as_millis()), [40, 25, 30, 100]);
    assert!(matches!(verdict.outcome, Outcome::Changed(_)));
}

#[test]
fn a_performance_that_wavers_is_found_bad_once() {
    let mut shell = Shell::new();
    // P_F_th is 0.1, of three components: clearly good, bad, just good.
    for error in [0.1, 0.6, 0.53, 0.6, 0.53] {
        shell.step(&Step::Evaluate(error));
        assert_eq!(shell.decider.state(), DeciderState::Monitoring);
    }
    shell.step(&Step::Evaluate(0.6));
    assert_eq!(shell.decider.state(), DeciderState::Synthesising);
}

#[test]
fn what_is_asked_for_too_early_is_done_after_the_dwell_time() {
    let mut shell = Shell::new();
    for _ in 0..3 {
        shell.step(&Step::Evaluate(2.0));
    }
    decide(&mut shell, 0.1);
    shell.step(&Step::Request);
    assert_eq!(shell.decider.state(), DeciderState::Monitoring);
    assert_eq!(shell.decider.deadline(), Some(DWELL));
    shell.now = DWELL;
    shell.step(&Step::Wait(1));
    assert_eq!(shell.decider.state(), DeciderState::Synthesising);
}

#[test]
fn who_has_followed_rests_after_a_change_of_the_one_who_decided() {
    let mut shell = Shell::new();
    let elsewhere = on(1, shell.decider.task());
    for _ in 0..2 {
        // He tells it again and again; it changes once.
        let effects = shell.decider.follow(elsewhere.clone(), shell.now);
        assert!(effects.is_empty(), "{effects:?}");
    }
    assert_eq!(shell.decider.running(), elsewhere);
    shell.step(&Step::Request);
    assert_eq!(shell.decider.deadline(), Some(DWELL));
    shell.now = DWELL;
    shell.step(&Step::Wait(1));
    assert_eq!(shell.decider.state(), DeciderState::Synthesising);
    let effects = shell.decider.follow(elsewhere.clone(), shell.now);
    let is_overtaken = |effect: &Effect| matches!(effect, Effect::Decided(verdict) if verdict.outcome == Outcome::Overtaken);
    assert!(effects.iter().any(is_overtaken), "{effects:?}");
    assert_eq!(shell.decider.state(), DeciderState::Monitoring);
}

#[test]
fn a_lost_robot_does_not_wait_and_the_other_one_takes_over() {
    let mut shell = Shell::new();
    shell.step(&Step::Robot(0, false));
    decide(&mut shell, 0.1);
    let verdict = shell.verdicts.first().expect("a verdict");
    assert!(matches!(&verdict.trigger, Trigger::Lost(lost) if lost.len() == 3));
    assert!(shell.decider.running().iter().all(|it| it.robot == 1));
    shell.step(&Step::Robot(1, false));
    decide(&mut shell, 0.1);
    let verdict = shell.verdicts.last().expect("a verdict");
    assert_eq!(verdict.outcome, Outcome::NoCandidate);
    assert_eq!(verdict.lacking, [0, 1, 2]);
}

#[test]
fn estimators_that_never_answer_end_a_decision_with_what_ran() {
    let mut shell = Shell::new();
    for _ in 0..3 {
        shell.step(&Step::Evaluate(2.0));
    }
    shell.answer(0.0, false);
    shell.step(&Step::Wait(499));
    assert_eq!(shell.decider.state(), DeciderState::Estimating);
    shell.step(&Step::Wait(1));
    let verdict = shell.verdicts.first().expect("a verdict");
    assert_eq!(verdict.outcome, Outcome::NoCandidate);
    let nearest = verdict
        .nearest
        .as_ref()
        .expect("what runs, which has numbers");
    assert_eq!(nearest.number, 1);
    assert_eq!(shell.decider.running(), on(0, &task()));
}
