//! The decider never takes what is infeasible and never changes faster than its dwell time, whatever
//! it is told.

mod support;

use std::time::Duration;

use proptest::prelude::*;
use support::chain;
use system_model::task::{Placement, TaskSpecification};
use task_adaptation::{
    Answer, ComponentPerformance, Decider, DeciderState, Effect, Observation, Outcome, Trigger,
    Verdict, generate, judge,
};

const DWELL: Duration = Duration::from_secs(10);

fn task() -> TaskSpecification {
    let mut task = chain(2, 3, 1, 10.0);
    task.decision.dwell = DWELL;
    task
}

fn on(robot: usize, task: &TaskSpecification) -> Vec<Placement> {
    let components = task.components.iter().enumerate();
    let essential = components.filter(|(_, component)| component.is_essential);
    essential
        .map(|(component, _)| Placement { component, robot })
        .collect()
}

fn answer(placements: &[Placement], error: f64) -> Answer {
    let performance = ComponentPerformance {
        functional: error,
        use_of_resources: vec![1.0],
    };
    Answer::Performances(vec![performance; placements.len()])
}

/// How a shell behaves in one step.
#[derive(Debug, Clone)]
enum Step {
    Evaluate(f64),
    Request,
    Wait(u16),
    /// A robot loses everything, or gets it again.
    Robot(usize, bool),
    /// Answers one open question, if there is one: with an error, a crash, or a failure.
    Answer(f64, bool),
}

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

/// A shell that remembers what was asked and checks what it is asked for.
struct Shell {
    decider: Decider,
    now: Duration,
    open: Vec<Effect>,
    /// What was told about each candidate of the present decision.
    told: Vec<(usize, Answer)>,
    changes: Vec<Duration>,
    /// Since the last change.
    lost: bool,
    verdicts: Vec<Verdict>,
}

impl Shell {
    fn new() -> Self {
        let task = task();
        let running = on(0, &task);
        Self {
            decider: Decider::new(task, running),
            now: Duration::ZERO,
            open: Vec::new(),
            told: Vec::new(),
            changes: Vec::new(),
            lost: false,
            verdicts: Vec::new(),
        }
    }

    fn tell(&mut self, observation: Observation) {
        let effects = self.decider.observe(observation, self.now);
        for effect in effects {
            match effect {
                Effect::Synthesise { .. } => {
                    self.told.clear();
                    self.open = vec![effect];
                }
                Effect::Abandon { .. } => self.open.clear(),
                Effect::Decided(verdict) => {
                    self.open.clear();
                    self.check(&verdict);
                    self.verdicts.push(*verdict);
                }
                Effect::Reconfigure {
                    number,
                    ref candidate,
                    ..
                } => {
                    self.check_feasible(number, &candidate.placements);
                    self.open = vec![effect];
                }
                Effect::Estimate { .. } => self.open.push(effect),
            }
        }
    }

    fn check_feasible(&self, number: usize, placements: &[Placement]) {
        let task = self.decider.task();
        assert!(placements.iter().all(|it| task.instance(*it).is_some()));
        // Unless it was measured as what runs, its estimators must have spoken for it.
        let told = self.told.iter().find(|(other, _)| *other == number);
        if let Some((_, answer)) = told {
            let (quality, rejections) = judge(task, placements, answer);
            assert!(quality.is_some() && rejections.is_empty(), "{answer:?}");
        } else {
            assert!(placements.len() == self.decider.running().len());
        }
    }

    fn check(&mut self, verdict: &Verdict) {
        assert_eq!(verdict.decision, self.verdicts.len() as u64 + 1);
        let Outcome::Changed(number) = verdict.outcome else {
            let is_end = !matches!(verdict.outcome, Outcome::Kept(_));
            for judged in verdict.candidates.iter().filter(|_| is_end) {
                assert!(
                    !judged.is_feasible && !judged.rejections.is_empty(),
                    "{judged:?}"
                );
            }
            return;
        };
        for judged in &verdict.candidates {
            assert_eq!(
                judged.rejections.is_empty(),
                judged.number == number,
                "{judged:?}"
            );
        }
        if let Some(last) = self.changes.last().filter(|_| !self.lost) {
            assert!(self.now - *last >= DWELL, "{last:?} {:?}", self.now);
        }
        self.changes.push(self.now);
        self.lost = false;
    }

    fn step(&mut self, step: &Step) {
        match step {
            Step::Evaluate(error) => {
                let answer = answer(self.decider.running(), *error);
                self.tell(Observation::Evaluated(answer));
            }
            Step::Request => self.tell(Observation::Requested),
            Step::Wait(milliseconds) => {
                self.now += Duration::from_millis(u64::from(*milliseconds));
                self.tell(Observation::TimePassed);
            }
            Step::Robot(robot, is_there) => {
                let mut changed = self.decider.task().clone();
                changed.robots[*robot] = task().robots[*robot].clone();
                if !is_there {
                    changed.robots[*robot].instances.clear();
                }
                self.lost |= !is_there;
                self.tell(Observation::TaskChanged(Box::new(changed)));
            }
            Step::Answer(error, fails) => self.answer(*error, *fails),
        }
    }

    fn answer(&mut self, error: f64, fails: bool) {
        let Some(question) = self.open.pop() else {
            return;
        };
        let observation = match question {
            Effect::Synthesise { decision } => {
                let result = generate(self.decider.task(), Some(self.decider.running()));
                Observation::Synthesised { decision, result }
            }
            Effect::Estimate {
                decision,
                number,
                candidate,
            } => {
                let answer = match fails {
                    true => Answer::Crashed("SIGSEGV".into()),
                    false => answer(&candidate.placements, error),
                };
                self.told.push((number, answer.clone()));
                Observation::Estimated {
                    decision,
                    number,
                    answer,
                }
            }
            Effect::Reconfigure {
                decision, number, ..
            } => match fails {
                true => Observation::ReconfigurationFailed {
                    decision,
                    number,
                    reason: "its library is gone".into(),
                },
                false => Observation::Reconfigured { decision, number },
            },
            Effect::Abandon { .. } | Effect::Decided(_) => return,
        };
        self.tell(observation);
    }
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

/// Answers all questions at once, `error` of what uses more than the essential components.
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
