//! Answers to suppositions. What a whole robot does is compared with the container elsewhere.

#[path = "what_if/chain.rs"]
mod chain;

use std::time::Duration;

use chain::{chain, freshness, validity, watch};
use fault_manager::Scope;
use fault_manager::what_if::{
    Answer, Assumptions, InputPort, Recoveries, Table, answer, dependents, parse,
};
use system_model::rules::{
    ActuatorRule, ApplicationSeverity, ComponentSeverity, Confirmation, DependencySeverity, Entity,
    HeartbeatRule, Judgement, MemoryRule, OverrunRule, PortChecks, Preload, RateOfChangeRule,
    Secondary, StopCategory, StuckRule, WatchdogRule,
};
use system_model::specification::ExecutionKind;

use crate::support::{budget, component, located, needs};

fn ask_with(scope: &Scope, question: &str, assumptions: &Assumptions) -> Answer {
    let scopes = [scope.clone()];
    let supposition = parse(&scopes, question).expect("a question");
    answer(&scopes, &supposition, assumptions).expect("it can happen")
}

fn ask(scope: &Scope, question: &str) -> Vec<String> {
    ask_with(scope, question, &Assumptions::default()).actions()
}

const STOP_ALL: [&str; 3] = ["stop source: done", "stop filter: done", "stop sink: done"];

#[test]
fn what_does_not_return_is_recovered_and_what_comes_back_climbs_the_ladder() {
    let mut scope = chain();
    scope.rules.components[0].fault = budget(2, ApplicationSeverity::Local);
    for fault in ["panic", "segfault", "exit", "error_return", "hang"] {
        let question = format!("source {fault}");
        assert_eq!(ask(&scope, &question), ["reset source: done"], "{fault}");
    }
    // Longer than the watchdog allows, in every cycle.
    scope.rules.components[0].watchdog = Some(located(WatchdogRule {
        deadline: Some(Duration::from_millis(30)),
        startup: Duration::from_secs(30),
        judgement: Judgement::default(),
    }));
    // It hangs again before its first cycle, which is a reset that has failed.
    let resets = ["reset source: failed"; 2];
    assert_eq!(
        ask(&scope, "source slow"),
        [&resets[..], &STOP_ALL].concat()
    );
}

#[test]
fn when_no_recovery_succeeds_the_ladder_is_climbed_to_its_end() {
    let mut scope = chain();
    let mut specification = component("source");
    specification.type_name = "spare".to_owned();
    scope.rules.components[0].secondaries = vec![Secondary {
        specification,
        preload: Preload::Warm,
    }];
    scope.rules.components[0].fault = budget(1, ApplicationSeverity::Global);
    scope.rules.components[2].actuator = Some(located(ActuatorRule {
        stop_category: StopCategory::ControlledThenOff,
        safe_states: Vec::new(),
    }));
    let fail = Assumptions {
        recoveries: Recoveries::Fail,
        ..Assumptions::default()
    };
    let answer = ask_with(&scope, "source segfault", &fail);
    let expected = [
        "reset source: failed",
        "replace source by spare: failed",
        "emergency stop: done",
    ];
    assert_eq!(answer.actions(), expected);
    assert!(answer.emergency_stop && answer.stops_robot());
    let states = answer.components.iter().map(|it| it.state);
    assert_eq!(states.collect::<Vec<_>>(), ["ERROR", "ACTIVE", "INACTIVE"]);
    // A library that is missing is not missed where a standby waits.
    assert_eq!(
        ask(&scope, "source library_missing"),
        ["reset source: failed", "replace source by spare: done"]
    );
    assert_eq!(
        ask(&scope, "source checkpoint_corrupt"),
        ["reset source: done"]
    );
}

#[test]
fn data_are_seen_where_a_rule_looks_and_reach_whoever_no_rule_protects() {
    let mut scope = chain();
    for fault in [
        "out_of_range",
        "not_a_number",
        "offset",
        "drift",
        "noise",
        "drop",
        "stuck",
    ] {
        let answer = ask_with(
            &scope,
            &format!("source.out {fault}"),
            &Assumptions::default(),
        );
        assert!(!answer.is_seen() && answer.ends_in_nothing(), "{fault}");
        let reaches: &[&str] = if fault == "drop" { &[] } else { &["filter"] };
        assert_eq!(answer.reaches, reaches, "{fault}");
    }
    scope.rules.components[1].severity = Some(located(ComponentSeverity::Stop));
    watch(&mut scope, 1, "in", validity());
    for fault in ["out_of_range", "not_a_number", "offset", "drift", "noise"] {
        let answer = ask_with(
            &scope,
            &format!("source.out {fault}"),
            &Assumptions::default(),
        );
        assert_eq!(answer.actions(), ["stop filter: done"], "{fault}");
        assert!(answer.reaches.is_empty() || fault == "drift", "{fault}");
    }
    assert!(ask(&scope, "source.out stuck").is_empty());
}

#[test]
fn what_does_not_come_is_missed_and_passed_on_only_by_whom_it_is_said_of() {
    let mut scope = chain();
    scope.rules.components[2].severity = Some(located(ComponentSeverity::Stop));
    watch(&mut scope, 2, "in", freshness(100));
    assert!(ask(&scope, "source.out drop").is_empty());
    let passes_on = Assumptions {
        passes_on: vec![InputPort {
            application: 0,
            component: 1,
            port: "in".to_owned(),
        }],
        ..Assumptions::default()
    };
    for fault in ["drop", "delay"] {
        let answer = ask_with(&scope, &format!("source.out {fault}"), &passes_on);
        assert_eq!(answer.actions(), ["stop sink: done"], "{fault}");
        let own = ask(&scope, &format!("filter.out {fault}"));
        assert_eq!(own, ["stop sink: done"], "{fault}");
    }
    scope.rules.components[2].ports[0].checks = validity();
    let answer = ask_with(&scope, "source.out out_of_range", &passes_on);
    assert_eq!(answer.actions(), ["stop sink: done"]);
}

#[test]
fn other_detectors_speak_when_what_they_watch_goes_wrong() {
    let stop = Judgement {
        severity: Some(ComponentSeverity::Stop),
        ..Judgement::default()
    };
    let mut scope = chain();
    scope.rules.components[0].memory = Some(located(MemoryRule {
        limit_bytes: 1,
        judgement: stop,
    }));
    scope.rules.components[0].overrun = Some(located(OverrunRule {
        tolerated: 3,
        within: Duration::from_secs(1),
        judgement: stop,
    }));
    let checks = PortChecks {
        stuck: vec![located(StuckRule {
            field: None,
            count: 3,
            judgement: stop,
        })],
        rate_of_change: vec![located(RateOfChangeRule {
            field: None,
            maximum_per_second: 1.0,
            judgement: stop,
        })],
        ..PortChecks::default()
    };
    watch(&mut scope, 0, "out", checks);
    for question in [
        "source leak",
        "source slow",
        "source.out stuck",
        "source.out noise",
    ] {
        assert_eq!(ask(&scope, question), ["stop source: done"], "{question}");
    }
    // An aperiodic component that gets nothing completes nothing.
    scope.specification.components[1].execution.kind = ExecutionKind::Aperiodic;
    scope.specification.components[1].execution.period = Duration::ZERO;
    scope.rules.components[1].heartbeat = Some(located(HeartbeatRule {
        period: Duration::from_millis(100),
        missed: 3,
        judgement: Judgement {
            confirmation: Some(Confirmation {
                count: 2,
                within: None,
            }),
            ..stop
        },
    }));
    assert_eq!(ask(&scope, "source.out drop"), ["stop filter: done"]);
}

#[test]
fn who_needs_whom_comes_down_with_it() {
    let mut scope = chain();
    let (source, filter, sink) = (0, 1, 2);
    needs(
        &mut scope,
        Entity::Component(filter),
        &[Entity::Component(source)],
        1,
        DependencySeverity::Stop,
    );
    needs(
        &mut scope,
        Entity::Component(sink),
        &[Entity::Component(filter)],
        1,
        DependencySeverity::Destroy,
    );
    let scopes = [scope];
    assert_eq!(
        dependents(&scopes, 0, source),
        [(0, filter, false), (0, sink, true)]
    );
    assert_eq!(dependents(&scopes, 0, sink), []);
}

#[test]
fn the_table_has_a_cell_for_every_fault_and_says_who_cannot_have_one() {
    let mut scope = chain();
    scope.specification.components[2].execution.kind = ExecutionKind::Passive;
    let mut told = 0;
    let table = Table::new(&[scope], &Assumptions::default(), &mut |_| told += 1);
    assert_eq!((table.rows.len(), told), (3, 3));
    let cells: Vec<usize> = table.rows.iter().map(|row| row.cells.len()).collect();
    // 15 of the component, 9 for each port.
    assert_eq!(cells, [15 + 9, 15 + 18, 15 + 9]);
    let passive = &table.rows[2];
    let refused = passive.cells.iter().filter(|cell| cell.answer.is_err());
    assert_eq!(refused.count(), 15);
    assert!(passive.loss.is_err());
}

#[test]
fn questions_that_are_none_are_refused_with_what_there_is() {
    let scopes = [chain()];
    for (question, words) in [
        ("source", "COMPONENT FAULT"),
        ("sauce panic", "there are: source, filter, sink"),
        ("source panik", "there are: panic, segfault"),
        ("source.out panic", "leave the port out"),
        ("source drop", "source.PORT"),
        ("source.in drop", "no data port 'in'"),
    ] {
        let error = parse(&scopes, question).expect_err(question).to_string();
        assert!(error.contains(words), "{question}: {error}");
    }
    assert!(parse(&scopes, "chain/source panic").is_ok());
    let twice = [chain(), chain()];
    assert!(parse(&twice, "source panic").is_err());
}
