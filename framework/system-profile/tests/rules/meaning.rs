//! What sound rules become.

use std::time::Duration;

use system_model::fault::FaultKind;
use system_model::rules::{
    Arming, ComponentSeverity, DecisionRule, DependencySeverity, Entity, IsolationTier, Preload,
    ProcessLimits, StopCategory, VotingMethod,
};

use crate::project::{Project, milliseconds, of};

#[test]
fn without_rules_everything_has_its_default() {
    let rules = Project::new().load(&[]).sound();
    assert_eq!(rules.application, "patrol");
    assert_eq!(rules.components.len(), 7);
    let severity = rules.components[0].exception_severity(FaultKind::Segfault, 0);
    assert_eq!(severity, ComponentSeverity::Reset);
}

#[test]
fn rules_of_ports() {
    let project = Project::new();
    let rules = project
        .load(&[&of(
            "avoidance",
            "<port name='range'>
              <validity field='distance'><min>0.03</min><max>3</max></validity>
              <validation field='angle' latch='true' armed='always' severity='stop'>
                <rang_min>-1</rang_min><range_max>1</range_max><confirm count='3' within='1s'/>
              </validation>
              <freshness max_age='60' safe_value='0.5'/>
              <rate_of_change field='distance' max='2.5'/><stuck count='10'/>
            </port>",
        )])
        .sound();
    let port = &rules.components[3].ports[0];
    assert_eq!((&port.port[..], &port.data_type[..]), ("range", "Range"));
    let checks = &port.checks;
    let interval = &checks.validity[0];
    assert_eq!(
        (interval.value.minimum, interval.value.maximum),
        (Some(0.03), Some(3.0))
    );
    assert_eq!(interval.place.line, 2);
    assert!(interval.place.file.ends_with("rules/r0.xml"));
    let alias = &checks.validity[1].value;
    assert_eq!((alias.minimum, alias.maximum), (Some(-1.0), Some(1.0)));
    let judgement = alias.judgement;
    assert!(judgement.latched && judgement.arming == Arming::Always);
    assert_eq!(judgement.severity, Some(ComponentSeverity::Stop));
    let confirmation = rules.components[3].confirmation(&judgement);
    assert_eq!(
        (confirmation.count, confirmation.within),
        (3, Some(milliseconds(1000)))
    );
    let freshness = checks.freshness.as_ref().unwrap();
    assert_eq!(freshness.value.maximum_age, milliseconds(60));
    assert_eq!(checks.safe_values[0].value.value, 0.5);
    assert_eq!(checks.rate_of_change[0].value.maximum_per_second, 2.5);
    assert_eq!(checks.stuck[0].value.count, 10);
}

/// A copy outlives the container only where a rule says so.
#[test]
fn how_long_a_persisted_copy_is_good() {
    for (attributes, expected) in [
        ("", None),
        ("persist='false'", None),
        ("persist='true'", Some(Duration::from_secs(3600))),
        (
            "persist='true' max_age='2min'",
            Some(Duration::from_secs(120)),
        ),
    ] {
        let backup = format!("<backup {attributes}>40</backup>");
        let rule = format!("<resurrect><reset>true</reset>{backup}</resurrect>");
        let project = Project::new();
        let rules = project.load(&[&of("motor", &rule)]).sound();
        let resurrect = rules.components[4].resurrect.as_ref().unwrap().value;
        assert_eq!(resurrect.persist, expected, "{attributes}");
    }
}

/// Bounds of the process in the rules below.
const LIMITS: ProcessLimits = ProcessLimits {
    memory_bytes: Some(2 << 20),
    open_files: Some(32),
    processor_time_s: None,
    filters_system_calls: false,
};

#[test]
fn rules_of_components() {
    let project = Project::new();
    let rules = project
        .load(&[&of(
            "motor",
            "<severity>emergency</severity><confirm count='2'/>
            <exception signal='SIGSEGV' severity='reset'/><exception class='panic' severity='stop'/>
            <exception return_code='0x10000001' severity='ignore'/>
            <exception return_code='callee' severity='reset'/>
            <fault_event name='too_hot' severity='stop'/>
            <watchdog deadline='10ms' startup='2s'/><overrun tolerated='3' within='1s'/>
            <heartbeat period='100' missed='2'/>
            <memory limit_kb='64' severity='stop' latch='true'><confirm count='3'/></memory>
            <resurrect><reset>on</reset><backup persist='true'>40</backup></resurrect>
            <fault window='10s' backoff='5' retry_max='2'><severity>global</severity></fault>
            <standby preload='warm'/>
            <recovery deadline='20'/><isolation group='drive' memory_limit_kb='2048' open_files='32' system_call_filter='false'>process</isolation>
            <actuator stop_category='1'><command port='command' safe_value='0'/></actuator>
            <adapt task='adapt.xml' robot='R2'/>",
        )])
        .sound();
    let motor = &rules.components[4];
    let severity = |kind, code| motor.exception_severity(kind, code);
    assert_eq!(severity(FaultKind::Segfault, 0), ComponentSeverity::Reset);
    assert_eq!(severity(FaultKind::Panic, 0), ComponentSeverity::Stop);
    assert_eq!(
        severity(FaultKind::ErrorReturn, 0x1000_0001),
        ComponentSeverity::Ignore
    );
    assert_eq!(
        severity(FaultKind::ErrorReturn, 500),
        ComponentSeverity::Reset
    );
    assert_eq!(severity(FaultKind::Abort, 0), ComponentSeverity::Emergency);
    let watchdog = motor.watchdog.as_ref().unwrap().value;
    assert_eq!(watchdog.deadline, Some(milliseconds(10)));
    assert_eq!(watchdog.startup, Duration::from_secs(2));
    assert_eq!(motor.confirmation(&watchdog.judgement).count, 2);
    assert_eq!(motor.overrun.as_ref().unwrap().value.tolerated, 3);
    assert_eq!(motor.heartbeat.as_ref().unwrap().value.missed, 2);
    let memory = motor.memory.as_ref().unwrap().value;
    assert_eq!(memory.limit_bytes, 64 * 1024);
    assert_eq!(memory.judgement.severity, Some(ComponentSeverity::Stop));
    assert!(memory.judgement.latched && motor.confirmation(&memory.judgement).count == 3);
    let resurrect = motor.resurrect.as_ref().unwrap().value;
    assert!(resurrect.reset);
    assert_eq!(resurrect.persist, Some(Duration::from_secs(3600)));
    assert_eq!(resurrect.backup, Some(milliseconds(40)));
    let fault = motor.fault.as_ref().unwrap().value;
    assert_eq!(
        (fault.retry_max, fault.window),
        (2, Duration::from_secs(10))
    );
    assert_eq!(fault.backoff, milliseconds(5));
    assert_eq!(motor.standby.as_ref().unwrap().value, Preload::Warm);
    let isolation = &motor.isolation.as_ref().unwrap().value;
    assert_eq!(
        (isolation.tier, isolation.group.as_deref()),
        (IsolationTier::Process, Some("drive"))
    );
    assert_eq!(isolation.limits, LIMITS);
    let actuator = &motor.actuator.as_ref().unwrap().value;
    assert_eq!(actuator.stop_category, StopCategory::ControlledThenOff);
    assert_eq!(motor.ports[0].checks.safe_values[0].value.value, 0.0);
    let adapt = &motor.adapt.as_ref().unwrap().value;
    assert_eq!(
        (adapt.task.as_str(), adapt.robot.as_deref()),
        ("adapt.xml", Some("R2"))
    );
    assert_eq!(motor.handle, None);
}

#[test]
fn rules_of_everything_else() {
    let project = Project::new();
    project.write(
        "applications/mapping.xml",
        "<package_profile><name>mapping</name><subcomponents/><port_connections/></package_profile>",
    );
    let rules = project
        .load(&["<fault retry_max='1'/><heartbeat period='1s'/>
            <executor name='motor'><overrun tolerated='1' within='1s'/></executor>
            <node name='base'><heartbeat period='1s'/></node>
            <application name='patrol'><dependency><reference>mapping</reference></dependency></application>
            <dependency need='2' severity='destroy'><name>avoidance</name>
              <reference>front</reference><reference>left</reference>
              <reference kind='executor'>right</reference></dependency>
            <monitor name='drive'>
              <process_model model='dc.xml' window='200' threshold='0.5' method='cusum' drift='0.1'>
                <input component='motor' port='command' field='rpm'/>
                <output component='encoders' port='left'/><parameter name='gain'>2</parameter>
              </process_model></monitor>
            <monitor name='sonars'><voting of='3' method='weighted' tolerance='0.1' weights='1, 2 1'>
                <input component='front' port='range'/><input component='left' port='range'/>
                <input component='right' port='range'/><output component='avoidance' port='range'/>
              </voting></monitor>"])
        .sound();
    assert_eq!(rules.fault.unwrap().value.retry_max, 1);
    assert!(rules.heartbeat.is_some());
    assert_eq!(rules.executors[0].first_component, 4);
    assert_eq!(rules.nodes[0].0, "base");
    let [avoidance, patrol] = &rules.dependencies[..] else {
        panic!("two dependencies");
    };
    assert_eq!(
        (avoidance.value.need, avoidance.value.severity),
        (2, DependencySeverity::Destroy)
    );
    let providers: Vec<_> = avoidance
        .value
        .providers
        .iter()
        .map(|p| p.entity.clone())
        .collect();
    let expected = [
        Entity::Component(0),
        Entity::Component(1),
        Entity::Executor(2),
    ];
    assert_eq!(providers, expected);
    assert_eq!(
        patrol.value.dependent.entity,
        Entity::Application("patrol".into())
    );
    let drive = &rules.monitors[0];
    assert_eq!(
        drive.rule.value.method,
        DecisionRule::Cusum { drift: Some(0.1) }
    );
    assert_eq!(
        (drive.inputs[0].component, drive.inputs[0].field.as_deref()),
        (4, Some("rpm"))
    );
    assert_eq!(drive.rule.value.parameters, [("gain".to_owned(), 2.0)]);
    let voting = &rules.votings[0];
    assert_eq!(voting.rule.value.method, VotingMethod::Weighted);
    let weights: Vec<f64> = voting.sources.iter().map(|source| source.weight).collect();
    assert_eq!(weights, [1.0, 2.0, 1.0]);
}
