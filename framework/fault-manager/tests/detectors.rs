//! No sequence of inputs brings a detector down, and what it says stays within what it may say.

use std::time::Duration;

use fault_manager::detection::Finding;
use fault_manager::detection::data_check::DataCheck;
use fault_manager::detection::liveness::{Freshness, Heartbeat, Overruns};
use fault_manager::detection::process_model::{Monitor, ResidualMonitor};
use fault_manager::detection::voting::{Opinion, SourceValue, Voter};
use proptest::collection::vec;
use proptest::prelude::*;
use system_model::data_type::{DataType, Field, Scalar};
use system_model::process_model::{Matrix, ProcessModel, StateSpace, StateSpaceKind};
use system_model::profile::Located;
use system_model::rules::{
    DecisionRule, FreshnessRule, HeartbeatRule, Judgement, OverrunRule, PortChecks,
    ProcessModelRule, RateOfChangeRule, StuckRule, ValidityRule, VotingMethod, VotingRule,
};
use system_model::specification::Place;

/// Numbers of every kind, the odd ones often.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -10.0..10.0,
        1 => any::<f64>(),
        1 => prop_oneof![
            Just(f64::NAN),
            Just(f64::INFINITY),
            Just(f64::NEG_INFINITY),
            Just(f64::MAX),
            Just(-0.0),
        ],
    ]
}

/// Times that stand still, run, jump and run backwards.
fn time() -> impl Strategy<Value = Duration> {
    prop_oneof![
        6 => (0..100_u64).prop_map(|sample| Duration::from_millis(20 * sample)),
        1 => any::<u64>().prop_map(Duration::from_nanos),
        1 => prop_oneof![Just(Duration::ZERO), Just(Duration::MAX)],
    ]
}

fn decision_rule() -> impl Strategy<Value = DecisionRule> {
    prop_oneof![
        Just(DecisionRule::Window),
        Just(DecisionRule::ChiSquare),
        Just(DecisionRule::Cusum { drift: Some(0.1) }),
    ]
}

fn monitor_rule() -> impl Strategy<Value = ProcessModelRule> {
    (decision_rule(), 0..2000_u64, 0.01..100.0).prop_map(|(method, window_ms, threshold)| {
        ProcessModelRule {
            model: "model.xml".into(),
            window: Duration::from_millis(window_ms),
            threshold,
            method,
            parameters: Vec::new(),
            judgement: Judgement::default(),
        }
    })
}

fn matrix(rows: usize, columns: usize) -> impl Strategy<Value = Matrix> {
    vec(
        prop_oneof![8 => -2.0..2.0, 1 => any::<f64>()],
        rows * columns,
    )
    .prop_map(move |elements| Matrix {
        rows,
        columns,
        elements,
    })
}

/// Two states, one input, one output; mostly no model that anybody would write.
fn model() -> impl Strategy<Value = ProcessModel> {
    let kind = prop_oneof![
        Just(StateSpaceKind::Discrete),
        Just(StateSpaceKind::Continuous)
    ];
    let matrices = (matrix(2, 2), matrix(2, 1), matrix(1, 2), matrix(1, 1));
    let noise = (matrix(2, 2), matrix(1, 1));
    let times = (1..1000_u64, 0..1000_u64, 0..100_u64);
    (kind, matrices, noise, times).prop_map(|(kind, (a, b, c, d), noise, times)| ProcessModel {
        name: "any".into(),
        state_space: StateSpace {
            kind,
            period: Duration::from_millis(times.0),
            a,
            b,
            c,
            d,
            initial: vec![0.0; 2],
        },
        process_noise: noise.0,
        measurement_noise: noise.1,
        input_delay: Duration::from_millis(times.1),
        input_jitter: Duration::from_millis(times.2),
        inputs: Vec::new(),
    })
}

fn datum_type() -> DataType {
    let field = |path: &str, offset, scalar, count| Field {
        path: path.into(),
        unit: String::new(),
        offset,
        scalar,
        count,
    };
    DataType {
        name: "Datum".into(),
        size: 16,
        layout_hash: 0,
        fields: vec![
            field("value", 0, Scalar::F64, 1),
            field("parts", 8, Scalar::I16, 4),
        ],
    }
}

fn located<Rule>(value: Rule) -> Located<Rule> {
    Located {
        value,
        place: Place::default(),
    }
}

fn checks(minimum: f64, maximum: f64, rate: f64, count: u32) -> PortChecks {
    let judgement = Judgement::default();
    PortChecks {
        validity: vec![located(ValidityRule {
            field: None,
            minimum: Some(minimum),
            maximum: Some(maximum),
            judgement,
        })],
        rate_of_change: vec![located(RateOfChangeRule {
            field: None,
            maximum_per_second: rate,
            judgement,
        })],
        stuck: vec![located(StuckRule {
            field: None,
            count,
            judgement,
        })],
        ..PortChecks::default()
    }
}

proptest! {
    #[test]
    fn data_of_any_bytes_are_checked(
        limits in (number(), number(), number(), any::<u32>()),
        data in vec((any::<u64>(), prop_oneof![9 => vec(any::<u8>(), 16), 1 => vec(any::<u8>(), 0..40)]), 0..30),
    ) {
        let (minimum, maximum, rate, count) = limits;
        let checks = checks(minimum, maximum, rate, count);
        let mut check = DataCheck::compile(&datum_type(), &checks).expect("known fields");
        for (stamp_ns, bytes) in data {
            let mut told = Vec::new();
            let violated = check.check(stamp_ns, &bytes, &mut |rule, finding| {
                told.push((rule, finding != Finding::Passed));
            });
            // In order, each rule at most once.
            prop_assert!(told.is_sorted_by(|one, next| one.0 < next.0) && told.len() <= 3);
            prop_assert_eq!(violated, told.iter().any(|(_, violated)| *violated));
            let value = bytes.first_chunk().map(|bytes| f64::from_ne_bytes(*bytes));
            let is_number = value.is_some_and(f64::is_finite) && bytes.len() == 16;
            prop_assert!(is_number || told[0] == (0, true));
        }
    }

    #[test]
    fn liveness_takes_any_time_and_counter(
        steps in vec((time(), any::<u64>(), proptest::option::of(time())), 0..50),
        settings in (time(), any::<u32>()),
    ) {
        let judgement = Judgement::default();
        let (time, count) = settings;
        let mut heartbeat = Heartbeat::new(&HeartbeatRule { period: time, missed: count, judgement });
        let mut freshness = Freshness::new(&FreshnessRule { maximum_age: time, judgement });
        let mut overruns = Overruns::new(&OverrunRule { tolerated: count, within: time, judgement }, 0);
        for (now, counter, newest) in steps {
            if let Some(Finding::Violated(found)) = heartbeat.step(now, counter) {
                prop_assert!(found.missed >= count);
            }
            if let Some(Finding::Violated(found)) = freshness.step(now, newest) {
                prop_assert!(found.age > found.maximum && freshness.is_stale(now));
            }
            if let Some(Finding::Violated(found)) = overruns.step(now, counter) {
                prop_assert!(found.count > u64::from(count));
            }
        }
    }

    #[test]
    fn a_vote_lies_between_its_sources(
        method in prop_oneof![
            Just(VotingMethod::Median), Just(VotingMethod::Majority), Just(VotingMethod::Weighted)
        ],
        tolerance in number(),
        sources in vec((number(), number(), any::<bool>()), 0..8),
    ) {
        let rule = VotingRule { of: 3, method, tolerance, judgement: Judgement::default() };
        let mut voter = Voter::new(&rule, sources.len());
        let sources: Vec<_> = sources
            .into_iter()
            .map(|(value, weight, is_fresh)| SourceValue { value, weight, is_fresh })
            .collect();
        let vote = voter.vote(&sources);
        let usable = sources.iter().filter(|one| one.is_fresh && one.value.is_finite());
        let values: Vec<f64> = usable.map(|source| source.value).collect();
        prop_assert!(vote.value.is_some() || !vote.is_decided);
        if let Some(value) = vote.value {
            let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
            let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let rounding = 1e-9 * lowest.abs().max(highest.abs());
            prop_assert!(value >= lowest - rounding && value <= highest + rounding);
        }
        let silent = voter.opinions().iter().filter(|one| **one == Opinion::Silent).count();
        prop_assert_eq!(silent, sources.len() - values.len());
        let dissents = |one: &&Opinion| matches!(one, Opinion::Dissents { .. });
        prop_assert!(vote.is_decided || voter.opinions().iter().find(dissents).is_none());
    }

    #[test]
    fn monitors_take_any_model_and_any_data(
        model in model(),
        rule in monitor_rule(),
        steps in vec((time(), number(), number()), 0..60),
    ) {
        if let Ok(mut monitor) = Monitor::new(&model, &rule) {
            for (at, input, output) in &steps {
                let finding = monitor.step(*at, &[*input], &[*output]);
                prop_assert!(!monitor.statistic().is_nan());
                if let Some(Finding::Violated(residual)) = finding {
                    prop_assert!(output.is_finite() && residual.statistic > rule.threshold);
                }
            }
            monitor.reset();
            prop_assert_eq!(monitor.step(Duration::ZERO, &[], &[0.0]), None);
        }
    }

    #[test]
    fn reference_components_may_say_anything(
        rule in monitor_rule(),
        steps in vec((time(), number(), number()), 0..60),
    ) {
        let period = Duration::from_millis(20);
        if let Ok(mut monitor) = ResidualMonitor::new(&rule, 1, period) {
            for (at, expected, measured) in steps {
                let finding = monitor.step(at, &[expected], &[measured]);
                prop_assert!(finding.is_none() || expected.is_finite() && measured.is_finite());
            }
        }
    }
}
