//! Random applications, rules and sequences of what happens.

use std::time::Duration;

use fault_manager::Scope;
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use system_model::profile::Located;
use system_model::rules::{
    ApplicationSeverity, ComponentRules, ComponentSeverity, Confirmation, FaultRule, FreshnessRule,
    Judgement, OverrunRule, PortChecks, PortRules, Preload, RecoveryRule, ResurrectRule, Secondary,
};
use system_model::specification::{Place, PortDirection};

use crate::applications::{application, component, connect, depend};

/// So many cases; what fails is printed, not kept in a file.
pub fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

/// Something that happens to a robot. Numbers choose among what there is.
#[derive(Debug, Clone)]
pub enum Step {
    /// A component crashes, if it runs.
    Crash(usize),
    /// One of its detectors complains.
    Complain(usize, usize),
    /// A detector finds all well.
    Passed(usize, usize),
    /// An open action ends: well, badly, or it is never heard of again.
    Answer(usize, Answer),
    /// A recovered component completes its first cycle.
    Works(usize),
    /// So many milliseconds pass, with all ticks that are wanted.
    Wait(u64),
    /// An operator clears one fault.
    ClearOne(usize),
    /// An operator clears all.
    ClearAll,
    /// An operator starts a stopped component again.
    Restart(usize),
}

/// How an action ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    Done,
    Failed,
    Never,
}

/// What happens, the likely more often.
pub fn steps(most: usize) -> impl Strategy<Value = Vec<Step>> {
    let answer = prop_oneof![
        6 => Just(Answer::Done),
        2 => Just(Answer::Failed),
        1 => Just(Answer::Never),
    ];
    let some = 0..100_usize;
    let step = prop_oneof![
        6 => some.clone().prop_map(Step::Crash),
        4 => (some.clone(), 0..4_usize).prop_map(|(one, kind)| Step::Complain(one, kind)),
        2 => (some.clone(), 0..4_usize).prop_map(|(one, kind)| Step::Passed(one, kind)),
        8 => (some.clone(), answer).prop_map(|(one, answer)| Step::Answer(one, answer)),
        6 => some.clone().prop_map(Step::Works),
        4 => prop_oneof![3 => 0..50_u64, 1 => 500..12_000_u64].prop_map(Step::Wait),
        1 => some.clone().prop_map(Step::ClearOne),
        1 => Just(Step::ClearAll),
        1 => some.prop_map(Step::Restart),
    ];
    vec(step, 1..most)
}

/// One or two applications.
pub fn robots() -> impl Strategy<Value = Vec<Scope>> {
    let sizes = prop_oneof![(2..7_usize, Just(0)), (1..4_usize, 1..4_usize)];
    sizes.prop_flat_map(|(first, second)| {
        let dependency = (0..6_usize, vec(0..12_usize, 1..4), 1..4_usize, 0..3_u8);
        let components = vec(component_rules(), first + second);
        let kinds = vec(0..4_u8, first + second);
        let dependencies = vec(dependency, 0..8);
        let connections = vec((0..6_usize, 0..6_usize), 0..5);
        (components, kinds, dependencies, connections, any::<bool>()).prop_map(
            move |(rules, kinds, dependencies, connections, backwards)| {
                let mut scopes = vec![application("first", &rules[..first], &kinds[..first])];
                if second > 0 {
                    scopes.push(application("second", &rules[first..], &kinds[first..]));
                }
                for scope in &mut scopes {
                    connect(scope, &connections);
                }
                for dependency in dependencies {
                    depend(&mut scopes, dependency, backwards);
                }
                scopes
            },
        )
    })
}

pub fn located<T>(value: T) -> Located<T> {
    Located {
        value,
        place: Place::default(),
    }
}

fn severities() -> impl Strategy<Value = ComponentSeverity> {
    prop_oneof![
        1 => Just(ComponentSeverity::Ignore),
        5 => Just(ComponentSeverity::Reset),
        2 => Just(ComponentSeverity::Stop),
        1 => Just(ComponentSeverity::Emergency),
    ]
}

fn judgements() -> impl Strategy<Value = Judgement> {
    let within = option::of((10..500_u64).prop_map(Duration::from_millis));
    let confirmation = option::of((1..4_u32, within));
    (confirmation, any::<bool>(), option::of(severities())).prop_map(
        |(confirmation, latched, severity)| Judgement {
            confirmation: confirmation.map(|(count, within)| Confirmation { count, within }),
            latched,
            severity,
            ..Judgement::default()
        },
    )
}

fn fault_rules() -> impl Strategy<Value = FaultRule> {
    let severity = prop_oneof![
        Just(ApplicationSeverity::Ignore),
        Just(ApplicationSeverity::Local),
        Just(ApplicationSeverity::Global),
    ];
    (0..4_u32, 1..10_u64, 0..300_u64, severity).prop_map(
        |(retry_max, window, backoff, severity)| FaultRule {
            retry_max,
            window: Duration::from_secs(window),
            backoff: Duration::from_millis(backoff),
            severity,
        },
    )
}

fn component_rules() -> impl Strategy<Value = ComponentRules> {
    let resurrect = (any::<bool>(), any::<bool>()).prop_map(|(reset, backup)| ResurrectRule {
        reset,
        backup: backup.then_some(Duration::from_millis(20)),
        persist: None,
    });
    let recovery = (1..100_u64).prop_map(|milliseconds| RecoveryRule {
        deadline: Duration::from_millis(milliseconds),
    });
    (
        option::of(severities()),
        option::of(fault_rules()),
        option::of(resurrect),
        option::of(recovery),
        0..3_usize,
        (judgements(), judgements()),
    )
        .prop_map(
            |(severity, fault, resurrect, recovery, spares, judgements)| ComponentRules {
                severity: severity.map(located),
                fault: fault.map(located),
                resurrect: resurrect.map(located),
                recovery: recovery.map(located),
                overrun: Some(located(OverrunRule {
                    tolerated: 0,
                    within: Duration::from_secs(1),
                    judgement: judgements.0,
                })),
                ports: vec![input_rules(judgements.1)],
                secondaries: (0..spares).map(|_| secondary()).collect(),
                ..ComponentRules::default()
            },
        )
}

fn input_rules(judgement: Judgement) -> PortRules {
    PortRules {
        port: "input".to_owned(),
        direction: PortDirection::Input,
        data_type: String::new(),
        checks: PortChecks {
            freshness: Some(located(FreshnessRule {
                maximum_age: Duration::from_millis(200),
                judgement,
            })),
            ..PortChecks::default()
        },
    }
}

fn secondary() -> Secondary {
    Secondary {
        specification: component("spare", 0),
        preload: Preload::Cold,
    }
}
