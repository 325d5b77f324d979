use std::collections::BTreeMap;

use fault_manager::{ActionRecord, Cause, Evidence, FaultId, FaultState, Severity, Verdict};

use super::*;
use crate::control::view::ContainerView;
use crate::event_log::Event;
use crate::status::ComponentStatus;
use crate::summary::ComponentSummary;

fn view() -> SystemView {
    let status = ComponentStatus::new("camera".to_owned());
    status.count_cycle();
    status.count_cycle();
    status.set_state(LifeCycleState::Active);
    let camera = ComponentView {
        application: "patrol".to_owned(),
        level: "OK",
        summary: ComponentSummary::of(&status),
        condition: "working",
        open_faults: 1,
        runs: "camera".to_owned(),
        executor: "camera".to_owned(),
        execution: "periodic",
        period_ms: Some(40.0),
        rate_hz: Some(25.0),
        load_percent: Some(12.5),
        standbys: Vec::new(),
    };
    SystemView {
        applications: BTreeMap::new(),
        clock: "real",
        time_s: 1.0,
        emergency_stop: true,
        verdicts_recorded: 0,
        container: ContainerView {
            process: 1,
            uptime_s: 2.5,
            threads: 7,
            restarts: 1,
            port_data_dropped: 3,
            events_lost: 4,
            symptoms_dropped: 0,
        },
        components: BTreeMap::from([("camera".to_owned(), camera)]),
        trees: BTreeMap::new(),
    }
}

fn verdict(id: u64, kind: &'static str, handling_us: Option<u64>) -> Event {
    Event::Verdict(Box::new(Verdict {
        id: FaultId(id),
        state: FaultState::Confirmed,
        kind,
        component: "ca\"mera".to_owned(),
        incarnation: 1,
        node: String::new(),
        rule: None,
        evidence: Evidence::Order {
            order: String::new(),
            by: None,
        },
        symptoms: 1,
        first_symptom_ns: 0,
        confirmed_ns: 0,
        cause: Cause::Root,
        severity: Severity::Reset,
        plan: Vec::new(),
        actions: vec![ActionRecord {
            action: "reset".to_owned(),
            outcome: "done",
            note: String::new(),
        }],
        detection_us: 10,
        decision_us: 5,
        handling_us,
    }))
}

#[test]
fn figures_are_named_and_counted_by_the_conventions() {
    let mut tally = Tally::default();
    for event in [
        verdict(1, "segfault", None),
        verdict(1, "segfault", Some(85)),
        // Nothing but its backtrace is new.
        verdict(1, "segfault", Some(85)),
        // It came again and was handled again.
        verdict(1, "segfault", None),
        verdict(1, "segfault", Some(900)),
        verdict(2, "stale", None),
        verdict(3, "segfault", None),
        verdict(4, "operator_order", Some(7)),
    ] {
        tally.take(&event);
    }
    let links = [LinkView {
        source: "camera.picture".to_owned(),
        target: "detector.picture".to_owned(),
        dropped: 3,
    }];
    let text = of(&view(), &links, &tally);
    let component = r#"component="ca\"mera""#;
    for line in [
        r#"steadfast_component_cycles_total{component="camera"} 2"#.to_owned(),
        r#"steadfast_component_state{component="camera",state="ACTIVE"} 1.0"#.to_owned(),
        r#"steadfast_component_state{component="camera",state="ERROR"} 0.0"#.to_owned(),
        r#"steadfast_component_load_ratio{component="camera"} 0.125"#.to_owned(),
        r#"steadfast_component_open_faults{component="camera"} 1.0"#.to_owned(),
        format!(r#"steadfast_component_faults_total{{{component},kind="segfault"}} 2"#),
        format!(r#"steadfast_component_faults_total{{{component},kind="stale"}} 1"#),
        format!("steadfast_component_recovery_duration_seconds_count{{{component}}} 2"),
        format!("steadfast_component_recovery_duration_seconds_sum{{{component}}} 0.001015"),
        format!(
            r#"steadfast_component_recovery_duration_seconds_bucket{{le="+Inf",{component}}} 2"#
        ),
        r#"steadfast_port_data_dropped_total{source="camera.picture",target="detector.picture"} 3"#
            .to_owned(),
        "steadfast_events_lost_total 4".to_owned(),
        "steadfast_container_uptime_seconds 2.5".to_owned(),
        "steadfast_emergency_stop 1.0".to_owned(),
        "# TYPE steadfast_component_recovery_duration_seconds histogram".to_owned(),
        "# EOF".to_owned(),
    ] {
        assert!(
            text.lines().any(|other| other == line),
            "{line} is not in\n{text}"
        );
    }
    assert!(!text.contains("operator_order"));
}

#[test]
fn what_is_remembered_of_faults_is_bounded() {
    let mut tally = Tally::default();
    for id in 1..5_000 {
        tally.take(&verdict(id, "stale", None));
    }
    assert!(tally.remembered() <= 1024);
    let text = of(&view(), &[], &tally);
    assert!(text.contains(r#"kind="stale"} 4999"#), "{text}");
}
