//! What becomes of references to other files: components, composites, search paths.

use system_model::specification::PortKind;
use system_profile::{LoadOptions, Severity, check_file, load_application};

use crate::project::{BOTH, Project, connect, connect_all};

#[test]
fn a_sound_application() {
    let project = Project::new();
    project.write("worlds/room.xml", "<world_profile/>");
    let connections = connect_all(&[
        "data s.range p.range",
        "event s.alarm p.alarm",
        "service p.setup s.setup",
    ]);
    let specification = project
        .application(
            BOTH,
            &connections,
            "<coordination><depends source='p' target='s'/></coordination>\
             <world><reference>room.xml</reference></world>",
        )
        .sound();
    assert_eq!(specification.name, "a");
    assert_eq!(specification.coordination, [(1, 0)]);
    assert_eq!(specification.world, Some(project.path("worlds/room.xml")));
    let [sensor, planner] = &specification.components[..] else {
        panic!("two components");
    };
    assert_eq!((&sensor.name[..], &planner.type_name[..]), ("s", "planner"));
    assert_eq!(sensor.profile, project.path("components/sensor.xml"));
    assert_eq!(sensor.place.line, 2);
    let service = &specification.connections[2];
    assert_eq!(service.kind, PortKind::Service);
    assert_eq!((service.source.component, service.target.component), (1, 0));
}

#[test]
fn own_properties_come_last() {
    let project = Project::new();
    project.write(
        "applications/a.xml",
        "<application_profile><name>a</name><subcomponents><subcomponent><name>s</name>
        <reference>sensor.xml</reference><node_id>robot1.node1</node_id>
        <properties><property name='gain'>2</property></properties></subcomponent></subcomponents>
        <port_connections/></application_profile>",
    );
    let outcome = load_application(&project.path("applications/a.xml"), &LoadOptions::default());
    let component = &outcome.specification.unwrap().components[0];
    let own = |value: &str| ("gain".to_owned(), value.to_owned());
    assert_eq!(component.properties, [own("1"), own("2")]);
    assert_eq!(component.node, "robot1.node1");
}

#[test]
fn composites_are_flattened() {
    let project = Project::new();
    let export = "<export_port><component_name>s</component_name><port_name>range</port_name>
        <port_type>data</port_type><port_dir>output</port_dir>
        <export_port_name>distance</export_port_name></export_port>";
    project.composite("inner", BOTH, &connect("event s.alarm p.alarm"), export);
    project.composite(
        "outer",
        "i:inner.xml",
        "",
        &export
            .replace(">s<", ">i<")
            .replace(">range<", ">distance<"),
    );
    let specification = project
        .application(
            "o:outer.xml p:planner.xml",
            &connect("data o.distance p.range"),
            "<coordination><depends source='p' target='o'/></coordination>",
        )
        .sound();
    let names: Vec<&str> = specification
        .components
        .iter()
        .map(|c| &c.name[..])
        .collect();
    assert_eq!(names, ["o/i/s", "o/i/p", "p"]);
    assert_eq!(specification.coordination, [(2, 0), (2, 1)]);
    let outside = &specification.connections[1];
    assert_eq!(
        (outside.source.component, &outside.source.port[..]),
        (0, "range")
    );
    assert_eq!(outside.target.component, 2);
}

#[test]
fn mistakes_in_composites() {
    let project = Project::new();
    project.composite("ring", "r:ring.xml", "", "");
    project
        .application("o:ring.xml", "", "")
        .refused(&["ring:2: the composite contains itself"]);

    project.composite("one", "t:two.xml", "", "");
    project.composite("two", "o:one.xml", "", "");
    project
        .application("o:one.xml", "", "")
        .refused(&["two:2: the composite contains itself"]);

    let export = |port: &str, direction: &str| {
        format!(
            "<export_port><component_name>s</component_name><port_name>{port}</port_name>\
             <port_type>data</port_type><port_dir>{direction}</port_dir></export_port>"
        )
    };
    let exports = export("rnge", "output") + &export("range", "input") + &export("range", "output");
    project.composite("c", "s:sensor.xml", "", &exports);
    project
        .application(
            "o:c.xml p:planner.xml",
            &connect("data o.alarm p.range"),
            "",
        )
        .refused(&[
            "a:3: `o` has no port `alarm`",
            "c:4: `s` has no port `rnge` (did you mean `range`)",
            "c:4: the port range is an output data port",
            "c:4: a second exported port of the name range",
        ]);
}

#[test]
fn a_few_small_files_cannot_name_each_other_into_millions() {
    let project = Project::new();
    let members = |reference: &str| {
        let members = (0..40).map(|number| format!("m{number}:{reference} "));
        members.collect::<String>()
    };
    project.composite("l0", &members("sensor.xml"), "", "");
    for level in 1..8 {
        let below = format!("l{}.xml", level - 1);
        project.composite(&format!("l{level}"), &members(&below), "", "");
    }
    let outcome = project.application("m:l7.xml", "", "");
    assert!(outcome.specification.is_none());
    assert!(outcome.problems[0].contains("more than 1024 instances"));
}

#[test]
fn mistakes_in_references() {
    let project = Project::new();
    project.write(
        "applications/other.xml",
        "<package_profile><name>x</name><subcomponents/><port_connections/></package_profile>",
    );
    project.write("components/broken.xml", "<component_profile>");
    project
        .application(
            "a:snesor.xml b:../components/sensor.xml c:/etc/passwd d:other.xml e:broken.xml",
            "",
            "<world><reference>room.xml</reference></world>",
        )
        .refused(&[
            "a:2: there is no file `snesor.xml` (did you mean `sensor.xml`)",
            "a:2: `../components/sensor.xml` is a reference outside the search path",
            "a:2: `/etc/passwd` is a reference outside the search path",
            "a:2: <package_profile> cannot be a subcomponent",
            "a:4: there is no file `room.xml`",
            "broken:1: not well-formed XML: <component_profile> is never closed",
        ]);
}

#[test]
fn search_paths_are_searched() {
    let project = Project::new();
    project.write(
        "vendor/lidar.xml",
        &std::fs::read_to_string(project.path("components/sensor.xml")).unwrap(),
    );
    project
        .application("l:lidar.xml", "", "")
        .refused(&["a:2: there is no file `lidar.xml`"]);
    let options = LoadOptions {
        search_paths: vec![project.path("vendor")],
        ..LoadOptions::default()
    };
    let outcome = load_application(&project.path("applications/a.xml"), &options);
    assert!(outcome.specification.is_some());
}

#[test]
fn a_component_without_a_library_cannot_be_loaded() {
    let project = Project::new();
    project.write(
        "components/empty.xml",
        "<component_profile><name>e</name><execution_semantics><type>passive</type></execution_semantics></component_profile>",
    );
    project
        .application("e:empty.xml", "", "")
        .refused(&["empty:1: the component names no library, so there is nothing to load"]);
}

#[test]
fn only_applications_can_be_loaded() {
    let project = Project::new();
    for (name, expected) in [
        (
            "components/sensor.xml",
            "<component_profile> is no application",
        ),
        (
            "missing.xml",
            "the file cannot be read: No such file or directory (os error 2)",
        ),
    ] {
        let outcome = load_application(&project.path(name), &LoadOptions::default());
        assert!(outcome.specification.is_none());
        assert_eq!(outcome.problems[0].message, expected);
    }
}

#[test]
fn a_check_warns_of_dangling_references_and_reports_referenced_files() {
    let project = Project::new();
    project.write(
        "components/odd.xml",
        "<component_profile><name>o</name></component_profile>",
    );
    project.application(
        "m:missing.xml o:odd.xml s:sensor.xml",
        &connect("data m.x s.y"),
        "",
    );
    let options = LoadOptions {
        dangling: Severity::Warning,
        ..LoadOptions::default()
    };
    let reports = check_file(&project.path("applications/a.xml"), &options);
    let [application, odd] = &reports[..] else {
        panic!(
            "the application and the odd component, not {}",
            reports.len()
        );
    };
    let severities: Vec<_> = application.problems.iter().map(|p| p.severity).collect();
    assert_eq!(severities, [Severity::Warning, Severity::Error]);
    assert_eq!(odd.path, project.path("components/odd.xml"));
    assert!(odd.sha256.is_some());

    project.composite("ring", "r:ring.xml", "", "");
    let reports = check_file(&project.path("components/ring.xml"), &options);
    assert_eq!(
        reports[0].problems[0].message,
        "the composite contains itself"
    );

    project.write(
        "components/typed.xml",
        "<component_profile><name>t</name><execution_semantics><type>passive</type></execution_semantics>
        <defined_service_types><defined_service_type>s.xml</defined_service_type></defined_service_types>
        </component_profile>",
    );
    let reports = check_file(&project.path("components/typed.xml"), &options);
    assert_eq!(reports[0].problems[0].message, "there is no file `s.xml`");
}
