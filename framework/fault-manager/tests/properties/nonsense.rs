//! Observations that make no sense: unknown numbers, times that stand still or go back.

use std::collections::BTreeSet;
use std::time::Duration;

use fault_manager::{
    Action, ActionId, ActionOutcome, Cause, DetectorId, Effect, Evidence, FaultId, FaultManager,
    FaultState, Observation, OperatorOrder, Scope, Symptom,
};
use proptest::collection::vec;
use proptest::prelude::*;
use system_model::fault::FaultKind;

use crate::generators::{config, robots};

/// Cleared faults that are kept, and a generous number for what is open of a few components.
const MOST_VERDICTS: usize = 256 + 200;

fn kinds() -> impl Strategy<Value = FaultKind> {
    prop_oneof![
        Just(FaultKind::Panic),
        Just(FaultKind::ErrorReturn),
        Just(FaultKind::Hang),
        Just(FaultKind::Stale),
    ]
}

fn orders() -> impl Strategy<Value = OperatorOrder> {
    prop_oneof![
        Just(OperatorOrder::Reset),
        Just(OperatorOrder::Stop),
        proptest::option::of(0..3_usize).prop_map(|secondary| OperatorOrder::Replace { secondary }),
    ]
}

fn observations() -> impl Strategy<Value = Observation> {
    let outcome = prop_oneof![
        (0..6_u32).prop_map(|incarnation| ActionOutcome::Done {
            incarnation,
            note: String::new(),
        }),
        Just(ActionOutcome::Failed {
            reason: String::new(),
        }),
    ];
    let symptom = (
        0..60_usize,
        0..6_u32,
        kinds(),
        any::<u32>(),
        0..5_000_u64,
        any::<bool>(),
    );
    prop_oneof![
        1 => Just(Observation::Running),
        10 => symptom.prop_map(|(detector, incarnation, kind, return_code, at, runs)| {
            Observation::Symptom(Box::new(Symptom {
                detector: DetectorId(detector),
                incarnation,
                kind,
                return_code,
                at: Duration::from_millis(at),
                runs,
                evidence: Evidence::Heartbeat { missed: 1, period_ms: f64::NAN },
            }))
        }),
        3 => (0..60_usize).prop_map(|detector| Observation::Passed(DetectorId(detector))),
        6 => (0..80_u64, outcome).prop_map(|(action, outcome)| Observation::Ended {
            action: ActionId(action),
            outcome,
        }),
        4 => (0..8_usize, 0..6_u32).prop_map(|(component, incarnation)| Observation::Works {
            component,
            incarnation,
        }),
        1 => (0..60_u64).prop_map(|id| Observation::Clear(Some(FaultId(id)))),
        1 => Just(Observation::Clear(None)),
        3 => (0..8_usize, orders()).prop_map(|(component, order)| Observation::Ordered {
            component,
            order,
        }),
        2 => Just(Observation::Tick),
    ]
}

/// Times that mostly stand still and now and then go back.
fn times() -> impl Strategy<Value = Duration> {
    prop_oneof![
        4 => Just(Duration::from_millis(1_000)),
        2 => (0..10_000_u64).prop_map(Duration::from_millis),
        1 => Just(Duration::MAX),
    ]
}

fn run(scopes: Vec<Scope>, told: &[(Duration, Observation)]) -> Vec<Effect> {
    let mut manager = FaultManager::new(scopes);
    let mut effects = Vec::new();
    let mut consequences = BTreeSet::new();
    for (now, observation) in told {
        let new = manager.observe(*now, observation.clone());
        for effect in &new {
            if let Effect::Record(verdict) = effect {
                assert_ne!(verdict.state, FaultState::Prefailed);
                assert!(verdict.cause != Cause::Root || !verdict.plan.is_empty());
                if verdict.cause != Cause::Root {
                    consequences.insert(verdict.id);
                }
            }
        }
        for effect in &new {
            if let Effect::Act(act) = effect
                && matches!(act.action, Action::Reset { .. } | Action::Replace { .. })
            {
                assert!(!consequences.contains(&act.fault));
            }
        }
        assert!(manager.verdicts().count() <= MOST_VERDICTS);
        effects.extend(new);
    }
    effects
}

proptest! {
    #![proptest_config(config(300))]

    #[test]
    fn nonsense_is_survived_and_has_the_same_effects_again(
        scopes in robots(),
        told in vec((times(), observations()), 1..150),
    ) {
        // NaN differs from itself; the text of it does not.
        let first = format!("{:?}", run(scopes.clone(), &told));
        let second = format!("{:?}", run(scopes, &told));
        prop_assert_eq!(first, second);
    }
}
