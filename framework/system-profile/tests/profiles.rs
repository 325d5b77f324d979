//! Each kind of profile: what is understood, and what each mistake is called, where.

use std::time::Duration;

use system_model::profile::{CallType, ComponentProfile, LoadPolicy, Profile};
use system_model::specification::{
    ExecutionKind, PortDirection, PortKind, QueuePolicy, SchedulingPolicy,
};
use system_profile::{Document, Problem, read_profile};

fn read(text: &str) -> (Option<Profile>, Vec<Problem>) {
    let document = Document::from_bytes("profile.xml", text.as_bytes());
    let profile = read_profile(&document);
    (profile, document.problems())
}

fn shown(problems: &[Problem]) -> Vec<String> {
    let shown = |problem: &Problem| {
        let place = &problem.place;
        let severity = problem.severity.name();
        format!("{}:{} {severity}: {problem}", place.line, place.column)
    };
    problems.iter().map(shown).collect()
}

/// A passive component with `inside`, which starts in column 1 of line 2.
fn component(inside: &str) -> (ComponentProfile, Vec<Problem>) {
    let text = format!(
        "<component_profile><name>c</name>\n{inside}\n{}</component_profile>",
        match inside.contains("<execution_semantics>") {
            true => "",
            false => "<execution_semantics><type>passive</type></execution_semantics>",
        }
    );
    match read(&text) {
        (Some(Profile::Component(profile)), problems) => (*profile, problems),
        other => panic!("no component: {other:?}"),
    }
}

fn semantics(inside: &str) -> (ComponentProfile, Vec<Problem>) {
    component(&format!(
        "<execution_semantics>{inside}</execution_semantics>"
    ))
}

#[test]
fn a_component_with_everything() {
    let (profile, problems) = component(
        r#"<id>1</id><version>1.0</version><description>d</description><layout>1</layout>
        <copyright><company><name/><phone/></company><license_policy>MIT</license_policy></copyright>
        <execution_environment><os name="Linux" version="6"/><cpu>x86</cpu>
            <library_type>so</library_type><library_name>libc.so</library_name>
            <impl_language>Rust</impl_language><compiler>rustc</compiler><app_domain/><app_robot/>
        </execution_environment>
        <execution_semantics><type>periodic-shared</type><period>20</period><priority>5</priority>
            <policy>SCHED_FIFO</policy><instance_creation>multiple</instance_creation>
            <lifecycle_type>start</lifecycle_type></execution_semantics>
        <properties><property name="p" type="int">7</property></properties>
        <exports><property name="q">8</property></exports>
        <data_type_list/><defined_data_types><defined_data_type>t.xml</defined_data_type>
        </defined_data_types><defined_service_types><defined_service_type>s.xml</defined_service_type>
        </defined_service_types><ports/>"#,
    );
    assert_eq!(shown(&problems), [""; 0]);
    assert_eq!(profile.execution.kind, ExecutionKind::PeriodicShared);
    assert_eq!(profile.execution.period, Duration::from_millis(20));
    assert_eq!(profile.execution.priority, 5);
    assert_eq!(profile.execution.policy, SchedulingPolicy::Fifo);
    assert_eq!(profile.instance_creation.as_deref(), Some("multiple"));
    assert_eq!(profile.properties.len(), 2);
    assert_eq!(profile.environment.library_name.unwrap().value, "libc.so");
    assert_eq!(profile.environment.operating_systems[0].name, "Linux");
    assert_eq!(profile.data_type_files[0].value, "t.xml");
    assert_eq!(profile.service_type_files[0].value, "s.xml");
}

#[test]
fn execution_types_and_their_spellings() {
    use ExecutionKind::{Aperiodic, Passive, Periodic, PeriodicShared};
    for (word, kind) in [
        ("passive", Passive),
        ("aperiodic", Aperiodic),
        ("periodic", Periodic),
        ("periodic-exclusive", Periodic),
        ("periodic-shared", PeriodicShared),
    ] {
        let (profile, problems) = semantics(&format!("<type>{word}</type><period>9</period>"));
        assert_eq!(profile.execution.kind, kind);
        assert_eq!(problems.len(), 0);
    }
    let (profile, problems) =
        semantics("<type>non-periodic</type><creation_type>singleton</creation_type>");
    assert_eq!(profile.execution.kind, Aperiodic);
    assert_eq!(profile.instance_creation.as_deref(), Some("singleton"));
    assert_eq!(
        shown(&problems),
        ["2:28 warning: `non-periodic` is an old name and is read as `aperiodic`"]
    );
}

#[test]
fn mistakes_in_execution_semantics() {
    for (inside, expected) in [
        ("", "2:2 error: <execution_semantics> has no <type>"),
        ("<type/>", "2:23 error: <type> is empty"),
        (
            "<type>periodc</type>",
            "2:28 error: `periodc` in <type> is not understood",
        ),
        (
            "<type>periodic</type>",
            "2:2 error: a periodic component without a period",
        ),
        (
            "<type>periodic</type><period/>",
            "2:2 error: a periodic component without a period",
        ),
        (
            "<type>periodic</type><period>0</period>",
            "2:51 error: a period of 0 ms is not from 1 ms to one day",
        ),
        (
            "<type>passive</type><priority>120</priority>",
            "2:52 warning: priority 120 is read as 99",
        ),
        (
            "<type>passive</type><policy>FIFO</policy>",
            "2:50 error: `FIFO` in <policy> is not understood",
        ),
        (
            "<type>passive</type><perid>20</perid>",
            "2:43 warning: unknown element <perid> in <execution_semantics>",
        ),
    ] {
        assert_eq!(shown(&semantics(inside).1), [expected], "{inside}");
    }
}

#[test]
fn a_period_with_a_unit_is_read_as_the_old_engine_did() {
    let (profile, problems) = semantics("<type>periodic</type><period> 20ms </period>");
    assert_eq!(profile.execution.period, Duration::from_millis(20));
    assert_eq!(
        shown(&problems),
        ["2:52 warning: `20ms` in <period> is read as 20"]
    );
}

#[test]
fn a_component_without_execution_semantics_is_passive_with_a_warning() {
    let (_, problems) = read("<component_profile><name>c</name></component_profile>");
    assert_eq!(
        shown(&problems),
        ["1:2 warning: the component has no <execution_semantics> and is taken for passive"]
    );
}

#[test]
fn ports_and_their_spellings() {
    let (profile, problems) = component(
        r#"<ports>
        <data_port><name>a</name><usage>input</usage><data_type>vector&lt;int></data_type>
            <queueing_policy>FIFO</queueing_policy><queue_size>10</queue_size></data_port>
        <data_port><name>b</name><usage>input</usage><queuing_policy>LIFO</queuing_policy></data_port>
        <data_port><name>c</name><usage>input</usage><policy>FIFO</policy>
            <policy_param name="size">12</policy_param></data_port>
        <data_port><name>d</name><usage>output</usage><reference>t.xml</reference></data_port>
        <event_port><name>e</name><usage>input</usage><data_type>E</data_type><layout>1</layout></event_port>
        <service_port><name>f</name><usage>provided</usage><type>F</type><description/></service_port>
        <service_port><name>g</name><usage>required</usage><type>G</type></service_port></ports>"#,
    );
    assert_eq!(shown(&problems), [""; 0]);
    let ports: Vec<_> = profile.ports.iter().map(|port| &port.port).collect();
    let queues: Vec<_> = ports
        .iter()
        .map(|port| (port.queue, port.queue_size))
        .collect();
    assert_eq!(
        queues[..4],
        [
            (QueuePolicy::Fifo, 10),
            (QueuePolicy::Lifo, 15),
            (QueuePolicy::Fifo, 12),
            (QueuePolicy::Last, 1)
        ]
    );
    assert_eq!(ports[0].data_type, "vector<int>");
    assert_eq!(ports[3].direction, PortDirection::Output);
    assert_eq!(ports[4].kind, PortKind::Event);
    assert_eq!(ports[5].direction, PortDirection::Input);
    assert_eq!(ports[6].direction, PortDirection::Output);
    assert_eq!(ports[6].data_type, "G");
}

#[test]
fn mistakes_in_ports() {
    for (inside, expected) in [
        (
            "<data_port><usage>input</usage></data_port>",
            "2:9 error: <data_port> has no <name>",
        ),
        (
            "<data_port><name>a</name></data_port>",
            "2:9 error: <data_port> has no <usage>",
        ),
        (
            "<data_port><name>a</name><usage>provided</usage></data_port>",
            "2:40 error: `provided` in <usage> is not understood",
        ),
        (
            "<data_port><name>a</name><usage>input</usage><queue_size>0</queue_size></data_port>",
            "2:65 error: a queue of 0",
        ),
        (
            "<data_port><name>a</name><usage>input</usage><policy>UFIFO</policy></data_port>",
            "2:61 warning: an unbounded queue is not offered; `UFIFO` is read as `FIFO`",
        ),
        (
            "<data_port><name>a</name><usage>input</usage><policy>LATS</policy></data_port>",
            "2:61 error: `LATS` in <policy> is not understood",
        ),
        (
            "<dataport/>",
            "2:9 warning: unknown element <dataport> in <ports>",
        ),
    ] {
        let (_, problems) = component(&format!("<ports>{inside}</ports>"));
        assert_eq!(shown(&problems), [expected], "{inside}");
    }
    let twice = "<data_port><name>a</name><usage>input</usage></data_port>".repeat(2);
    let (_, problems) = component(&format!("<ports>{twice}</ports>"));
    assert_eq!(
        shown(&problems),
        ["2:66 error: a second port of the name a"]
    );
    assert!(
        problems[0]
            .help
            .as_ref()
            .unwrap()
            .contains("profile.xml:2:25")
    );
}

#[test]
fn unknown_names_are_warned_of_and_the_dialect_is_not() {
    let (_, problems) = component(
        "<resurrect><reset>true</reset></resurrect><fault/><watchdog deadline='3'/><isolation/>\n\
         <propertys/><properties><property name='a' nmae='b'/></properties>\n\
         <vendor:extra/>stray",
    );
    assert_eq!(
        shown(&problems),
        [
            "3:2 warning: unknown element <propertys> in <component_profile>",
            "3:44 warning: unknown attribute nmae in <property>",
            "4:16 warning: text in <component_profile> is not read",
        ]
    );
    let help = problems[0].help.as_ref().unwrap();
    assert!(help.starts_with("did you mean `properties`?"), "{help}");
}

#[test]
fn a_wrong_root_lists_the_roots() {
    let (profile, problems) = read("<?xml version='1.0'?>\n<component_profil/>");
    assert!(profile.is_none());
    assert_eq!(
        shown(&problems),
        ["2:2 error: the outermost element <component_profil> is not understood"]
    );
    let help = problems[0].help.as_ref().unwrap();
    assert!(
        help.starts_with("did you mean `component_profile`?"),
        "{help}"
    );
    assert!(help.contains("OPRoSProject"), "{help}");
}

#[test]
fn service_and_data_types() {
    let (profile, problems) = read(
        r#"<service_port_type_profile><service_port_type><type_name>S</type_name>
        <method name="m" return_type="void" call_type="nonblocking"><param index="1"><name>x</name>
        <type>int</type></param></method><method name="n" return_type="int"/>
        </service_port_type></service_port_type_profile>"#,
    );
    assert_eq!(shown(&problems), [""; 0]);
    let Some(Profile::ServiceTypes(profile)) = profile else {
        panic!("no service types");
    };
    let methods = &profile.types[0].methods;
    assert_eq!(methods[0].call, CallType::Nonblocking);
    assert_eq!(methods[0].parameters[0].data_type, "int");
    assert_eq!(methods[1].call, CallType::Blocking);

    let (profile, problems) =
        read(r#"<data_type><struct name="T"><item type="Long">left</item></struct></data_type>"#);
    assert_eq!(shown(&problems), [""; 0]);
    let Some(Profile::DataTypes(profile)) = profile else {
        panic!("no data types");
    };
    assert_eq!(profile.structures[0].fields[0].name.value, "left");
}

#[test]
fn a_system_file() {
    for root in ["system_config", "system_profile"] {
        let (profile, problems) = read(&format!(
            r#"<{root}><system_props><prop name="trace">off</prop></system_props>
            <logger_factory><logger name="l" type="cout" enable="off"><prop name="log.level">info</prop>
            </logger></logger_factory>
            <package_deployer><prop name="load.type">list</prop><app_load>A</app_load></package_deployer>
            <component_manager><local_node_id>n</local_node_id><io_workers>4</io_workers>
            <nonblocking_workers max="6"/><node_map><node id="m" protocol="tcp"/></node_map>
            </component_manager><io_manager><event_processor type="selector"/>
            <io id="c" protocol="tcp" role="server"/></io_manager>
            <mwadaptor_manager><prop name="is_run">false</prop></mwadaptor_manager>
            <dependency/></{root}>"#
        ));
        assert_eq!(shown(&problems), [""; 0]);
        let Some(Profile::System(profile)) = profile else {
            panic!("no system");
        };
        assert_eq!(profile.deployment.load, LoadPolicy::List);
        assert_eq!(profile.deployment.applications[0].value, "A");
        assert_eq!(profile.nonblocking_workers, Some((5, 6)));
        assert!(!profile.loggers[0].enabled);
        assert!(profile.channels[0].enabled);
    }
}
