//! Models of one lag, driven by hand.

use std::time::Duration;

use system_model::process_model::{Matrix, ProcessModel, StateSpace, StateSpaceKind};
use system_model::rules::{DecisionRule, Judgement, ProcessModelRule};

use super::*;
use crate::detection::Finding;

pub(super) fn matrix(rows: usize, columns: usize, elements: &[f64]) -> Matrix {
    Matrix {
        rows,
        columns,
        elements: elements.to_vec(),
    }
}

/// The first state is the output, measured with variance 1, every 20 ms.
pub(super) fn continuous(a: Matrix, b: Matrix, process_noise: &[f64]) -> ProcessModel {
    let states = a.rows;
    let mut c = Matrix::zeros(1, states);
    c.elements[0] = 1.0;
    ProcessModel {
        name: "test".into(),
        state_space: StateSpace {
            kind: StateSpaceKind::Continuous,
            period: Duration::from_millis(20),
            d: Matrix::zeros(1, b.columns),
            initial: vec![0.0; states],
            a,
            b,
            c,
        },
        process_noise: matrix(states, states, process_noise),
        measurement_noise: matrix(1, 1, &[1.0]),
        input_delay: Duration::ZERO,
        input_jitter: Duration::ZERO,
        inputs: Vec::new(),
    }
}

pub(super) fn discrete_model(
    a: Matrix,
    b: Matrix,
    process_noise: &[f64],
    measurement_noise: f64,
) -> DiscreteModel {
    let mut model = continuous(a, b, process_noise);
    model.state_space.kind = StateSpaceKind::Discrete;
    model.measurement_noise = matrix(1, 1, &[measurement_noise]);
    DiscreteModel::new(&model).expect("a good model")
}

/// y(k+1) = 0.8 y(k) + 0.2 u(k), one state of variance 0.01^2 a sample, measured with 0.1.
fn lag() -> ProcessModel {
    let mut model = continuous(matrix(1, 1, &[0.8]), matrix(1, 1, &[0.2]), &[1e-4]);
    model.state_space.kind = StateSpaceKind::Discrete;
    model.measurement_noise = matrix(1, 1, &[0.01]);
    model
}

fn rule(method: DecisionRule, window_ms: u64, threshold: f64) -> ProcessModelRule {
    ProcessModelRule {
        model: "lag.xml".into(),
        window: Duration::from_millis(window_ms),
        threshold,
        method,
        parameters: Vec::new(),
        judgement: Judgement::default(),
    }
}

const RULES: [DecisionRule; 3] = [
    DecisionRule::Window,
    DecisionRule::Cusum { drift: None },
    DecisionRule::ChiSquare,
];

fn at(sample: u64) -> Duration {
    Duration::from_millis(1000 + 20 * sample)
}

/// A lag that follows its input, but from `fault` on gets only half of it. Noise of one in ten
/// alternates, so that a test has no luck.
fn drive(monitor: &mut Monitor, samples: u64, fault: u64) -> Vec<(u64, Option<Finding<Residual>>)> {
    let mut output = 0.0;
    let step = |sample: u64| {
        let input = if sample % 100 < 50 { 2.0 } else { 1.0 };
        let noise = if sample.is_multiple_of(2) { 0.1 } else { -0.1 };
        let finding = monitor.step(at(sample), &[input], &[output + noise]);
        let share = if sample < fault { 1.0 } else { 0.5 };
        output = 0.8 * output + 0.2 * share * input;
        (sample, finding)
    };
    (0..samples).map(step).collect()
}

fn is_symptom(finding: &Option<Finding<Residual>>) -> bool {
    matches!(finding, Some(Finding::Violated(_)))
}

fn threshold(method: DecisionRule) -> f64 {
    match method {
        DecisionRule::Window => 0.3,
        DecisionRule::Cusum { .. } => 1.5,
        DecisionRule::ChiSquare => 30.0,
    }
}

#[test]
fn every_rule_finds_the_fault_and_nothing_else() {
    for method in RULES {
        let mut monitor =
            Monitor::new(&lag(), &rule(method, 200, threshold(method))).expect("a good rule");
        let findings = drive(&mut monitor, 400, 200);
        let (sane, faulty) = findings.split_at(200);
        assert!(
            !sane.iter().any(|(_, finding)| is_symptom(finding)),
            "{method:?}"
        );
        let judged = sane.iter().filter(|(_, finding)| finding.is_some()).count();
        assert!(judged > 190, "{method:?}: {judged}");
        let first = faulty.iter().position(|(_, finding)| is_symptom(finding));
        assert!(
            first.is_some_and(|first| first <= 15),
            "{method:?}: {first:?}"
        );
        // A filter that gets used to the fault would be content after some samples.
        let hidden = faulty[20..]
            .iter()
            .filter(|(_, finding)| !is_symptom(finding));
        assert_eq!(hidden.count(), 0, "{method:?}");
    }
}

#[test]
fn a_filter_that_would_learn_the_fault_does_not_hide_it() {
    // Noise in the state as large as the fault: a plain filter follows it within a few samples.
    let mut model = lag();
    model.process_noise = matrix(1, 1, &[0.04]);
    let rule = rule(DecisionRule::ChiSquare, 200, 120.0);
    let mut monitor = Monitor::new(&model, &rule).expect("a good rule");
    assert!(monitor.filter_gain() > 0.8);
    let sane = drive(&mut monitor, 100, u64::MAX);
    assert!(!sane.iter().any(|(_, finding)| is_symptom(finding)));
    // The sensor is off by 3 from now on.
    let symptoms: Vec<bool> = (100..300)
        .map(|sample| is_symptom(&monitor.step(at(sample), &[0.0], &[3.0])))
        .collect();
    let first = symptoms.iter().position(|symptom| *symptom).expect("found");
    assert!(first < 5 && symptoms[first..].iter().all(|symptom| *symptom));
}

#[test]
fn when_the_fault_is_over_the_monitor_passes_again() {
    for method in RULES {
        let mut monitor =
            Monitor::new(&lag(), &rule(method, 200, threshold(method))).expect("a good rule");
        drive(&mut monitor, 100, 50);
        assert!(monitor.statistic() > threshold(method), "{method:?}");
        // Input and output at rest.
        let last: Vec<_> = (100..200)
            .map(|sample| monitor.step(at(sample), &[0.0], &[0.0]))
            .collect();
        assert_eq!(last[99], Some(Finding::Passed), "{method:?}");
    }
}

#[test]
fn an_input_acts_after_its_delay() {
    // A step at sample 10 that the process sees two samples later.
    for (delay_ms, is_right) in [(40, true), (35, true), (0, false), (100, false)] {
        let mut model = lag();
        model.input_delay = Duration::from_millis(delay_ms);
        let mut monitor =
            Monitor::new(&model, &rule(DecisionRule::Window, 20, 1e-9)).expect("a good rule");
        let (mut output, mut inputs) = (0.0, [0.0; 3]);
        let mut symptoms = 0;
        for sample in 0..40 {
            let input = if sample < 10 { 0.0 } else { 1.0 };
            inputs = [inputs[1], inputs[2], input];
            symptoms += usize::from(is_symptom(&monitor.step(at(sample), &[input], &[output])));
            output = 0.8 * output + 0.2 * inputs[0];
        }
        assert_eq!(symptoms == 0, is_right, "{delay_ms} ms: {symptoms}");
    }
}

#[test]
fn a_residual_is_excused_as_far_as_jitter_explains_it() {
    // The process sees each step one sample later than the model.
    for (jitter_ms, is_excused) in [(0, false), (10, false), (20, true)] {
        let mut model = lag();
        model.input_jitter = Duration::from_millis(jitter_ms);
        let mut monitor =
            Monitor::new(&model, &rule(DecisionRule::Window, 20, 0.02)).expect("a good rule");
        let (mut output, mut last) = (0.0, 0.0);
        let mut symptoms = 0;
        for sample in 0..200 {
            let input = if sample % 100 < 50 { 0.0 } else { 1.0 };
            symptoms += usize::from(is_symptom(&monitor.step(at(sample), &[input], &[output])));
            output = 0.8 * output + 0.2 * last;
            last = input;
        }
        assert_eq!(symptoms == 0, is_excused, "{jitter_ms} ms: {symptoms}");
        // A sensor that is off while nothing moves has no excuse.
        for sample in 200..300 {
            let finding = monitor.step(at(sample), &[0.0], &[0.05]);
            assert!(sample < 260 || is_symptom(&finding));
        }
    }
}

#[test]
fn missing_samples_are_bridged_and_a_long_gap_begins_anew() {
    for method in RULES {
        let mut monitor =
            Monitor::new(&lag(), &rule(method, 200, threshold(method))).expect("a good rule");
        let mut output = 0.0_f64;
        for sample in 0..1000_u64 {
            let input = if sample < 500 { 2.0 } else { 1.0 };
            let measured = if sample % 7 == 0 { f64::NAN } else { output };
            if sample % 3 != 0 {
                let finding = monitor.step(at(sample), &[input], &[measured]);
                assert!(!is_symptom(&finding), "{method:?} {sample}");
            }
            output = 0.8 * output + 0.2 * input;
        }
        // Elsewhere after a minute: no symptom, and soon judged again.
        let later = |sample: u64| at(sample + 4000);
        let findings: Vec<_> = (0..60)
            .map(|sample| monitor.step(later(sample), &[7.0], &[7.0]))
            .collect();
        assert!(!findings.iter().any(is_symptom), "{method:?}");
        assert_eq!(findings[59], Some(Finding::Passed), "{method:?}");
    }
}

#[test]
fn a_reference_component_is_compared_without_a_model() {
    let period = Duration::from_millis(20);
    let cusum = DecisionRule::Cusum { drift: Some(0.2) };
    for method in [DecisionRule::Window, cusum] {
        let mut monitor =
            ResidualMonitor::new(&rule(method, 100, 0.5), 2, period).expect("a good rule");
        let mut first = None;
        for sample in 0..100_u64 {
            let off = if sample < 50 { 0.1 } else { 1.0 };
            let finding = monitor.step(at(sample), &[1.0, 2.0], &[1.0, 2.0 - off]);
            if let Some(Finding::Violated(residual)) = finding {
                assert_eq!((residual.output, residual.residual), (1, -1.0));
                first.get_or_insert(sample);
            }
        }
        assert!(matches!(first, Some(51..=54)), "{method:?} {first:?}");
        assert_eq!(monitor.step(at(200), &[f64::NAN, 0.0], &[0.0, 0.0]), None);
        assert_eq!(monitor.step(at(200), &[0.0], &[0.0]), None);
    }
    for (method, window_ms, expected) in [
        (DecisionRule::ChiSquare, 100, ModelError::NoCovariance),
        (
            DecisionRule::Cusum { drift: None },
            100,
            ModelError::NoCovariance,
        ),
        (DecisionRule::Window, 60_000, ModelError::Window),
    ] {
        let error = ResidualMonitor::new(&rule(method, window_ms, 0.5), 2, period);
        assert_eq!(error.expect_err("a bad rule"), expected);
    }
}

#[test]
fn parameters_of_the_rule_change_the_model() {
    let with = |name: &str, value: f64| {
        let mut rule = rule(DecisionRule::Window, 200, 0.5);
        rule.parameters = vec![(name.into(), value)];
        Monitor::new(&lag(), &rule)
    };
    let model = |name, value| with(name, value).expect("a parameter").model().clone();
    assert_eq!(model("input_delay_ms", 60.0).delay, 3);
    assert_eq!(
        model("process_noise_scale", 2.0).process_noise[(0, 0)],
        2e-4
    );
    assert_eq!(
        model("measurement_noise_scale", 3.0).measurement_noise[(0, 0)],
        0.03
    );
    for (name, value) in [("gain", 1.0), ("input_delay_ms", -1.0)] {
        let error = with(name, value).expect_err("no parameter");
        assert_eq!(error, ModelError::Parameter(name.into()));
    }
}
