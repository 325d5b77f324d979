//! What is tried next, failure by failure.

use std::path::PathBuf;

use system_model::profile::Located;
use system_model::rules::{
    AdaptRule, ApplicationSeverity, ComponentRules, Preload, ResurrectRule, Secondary,
};
use system_model::specification::{
    ComponentSpecification, ExecutionKind, ExecutionSemantics, Place, SchedulingPolicy,
};

use super::*;

fn component(reset: Option<bool>, retry_max: u32, window: u64, backoff: u64) -> Component {
    let resurrect = reset.map(|reset| Located {
        value: ResurrectRule {
            reset,
            backup: None,
            persist: None,
        },
        place: Place::default(),
    });
    Component {
        name: String::new(),
        node: String::new(),
        application: 0,
        executor: 0,
        periodic: true,
        rules: ComponentRules {
            resurrect,
            ..ComponentRules::default()
        },
        fault: FaultRule {
            retry_max,
            window: Duration::from_millis(window),
            backoff: Duration::from_millis(backoff),
            severity: ApplicationSeverity::Local,
        },
        recovery_deadline: Duration::from_secs(1),
    }
}

/// Failures at these times; the start of the reset that follows each, or that none does.
#[test]
fn resets_are_counted_within_the_window_and_wait_for_the_backoff() {
    type Expected = &'static [(u64, Option<(u32, u64)>)];
    let cases: [(&str, Component, Expected); 6] = [
        (
            "budget of two",
            component(None, 2, 1000, 0),
            &[
                (0, Some((1, 0))),
                (5, Some((2, 5))),
                (10, None),
                (999, None),
            ],
        ),
        (
            "the first one leaves the window",
            component(Some(true), 2, 1000, 0),
            &[
                (0, Some((1, 0))),
                (500, Some((2, 500))),
                (1000, Some((2, 1000))),
                (1400, None),
                (1500, Some((2, 1500))),
            ],
        ),
        (
            "backoff counts from the last reset, and not for the first of a window",
            component(None, 3, 1000, 100),
            &[
                (0, Some((1, 0))),
                (5, Some((2, 100))),
                (105, Some((3, 200))),
                (1250, Some((1, 1250))),
            ],
        ),
        (
            "forbidden",
            component(Some(false), 3, 1000, 0),
            &[(0, None)],
        ),
        ("no budget", component(None, 0, 1000, 0), &[(0, None)]),
        (
            "time stands still",
            component(None, 2, 1000, 0),
            &[(7, Some((1, 7))), (7, Some((2, 7))), (7, None)],
        ),
    ];
    for (case, component, failures) in cases {
        let mut ladder = Ladder::default();
        for (at, expected) in failures {
            let rung = ladder.climb(&component, Duration::from_millis(*at));
            ladder.worked();
            let reset = expected.map(|(attempt, not_before)| Rung::Reset {
                attempt,
                not_before: Duration::from_millis(not_before),
            });
            assert_eq!(rung, reset.unwrap_or(Rung::Exhausted), "{case}, at {at}");
        }
    }
}

#[test]
fn a_replacement_that_never_worked_is_followed_by_the_next_secondary() {
    let mut component = component(None, 1, 1000, 0);
    component.rules.secondaries = vec![secondary(), secondary()];
    let mut ladder = Ladder::default();
    let mut climb = |worked: bool| {
        if worked {
            ladder.worked();
        }
        match ladder.climb(&component, Duration::ZERO) {
            Rung::Reset { .. } => "reset".to_owned(),
            Rung::Replace(secondary) => format!("secondary {secondary}"),
            Rung::HandleByTree => "tree".to_owned(),
            Rung::Adapt => "adapt".to_owned(),
            Rung::Exhausted => "exhausted".to_owned(),
        }
    };
    let rungs = [false, false, false, true, false].map(&mut climb);
    let expected = ["reset", "secondary 0", "secondary 1", "reset", "exhausted"];
    assert_eq!(rungs, expected);
}

fn secondary() -> Secondary {
    let specification = ComponentSpecification {
        name: String::new(),
        type_name: String::new(),
        profile: PathBuf::new(),
        place: Place::default(),
        library: String::new(),
        execution: ExecutionSemantics {
            kind: ExecutionKind::Periodic,
            period: Duration::from_millis(10),
            priority: 0,
            policy: SchedulingPolicy::Other,
        },
        properties: Vec::new(),
        ports: Vec::new(),
        node: String::new(),
    };
    Secondary {
        specification,
        preload: Preload::Cold,
    }
}

#[test]
fn the_task_goes_on_without_it_once_all_else_is_used_up() {
    let mut component = component(None, 1, 1000, 0);
    component.rules.secondaries = vec![secondary()];
    component.rules.adapt = Some(Located {
        value: AdaptRule {
            task: "task.xml".into(),
            robot: None,
        },
        place: Place::default(),
    });
    let mut ladder = Ladder::default();
    let expected = [
        Rung::Reset {
            attempt: 1,
            not_before: Duration::ZERO,
        },
        Rung::Replace(0),
        Rung::Adapt,
        Rung::Exhausted,
    ];
    for rung in expected {
        assert_eq!(ladder.climb(&component, Duration::ZERO), rung);
    }
}

#[test]
fn resets_in_vain_count_however_long_they_took() {
    let component = component(None, 3, 1000, 0);
    let mut ladder = Ladder::default();
    for at in [0, 2_000, 4_000] {
        let rung = ladder.climb(&component, Duration::from_millis(at));
        assert!(matches!(rung, Rung::Reset { .. }), "at {at}");
    }
    let rung = ladder.climb(&component, Duration::from_millis(6_000));
    assert_eq!(rung, Rung::Exhausted);
}
