//! References between files: what becomes of a sound application, and what each mistake is called.

use std::fmt::Write as _;
use std::path::PathBuf;

use system_model::specification::{ApplicationSpecification, PortKind};
use system_profile::{LoadOptions, Severity, check_file, load_application};
use tempfile::TempDir;

/// A folder with `applications/a.xml` and components of all kinds of ports beside it.
struct Project {
    folder: TempDir,
}

const SENSOR: &str =
    "<data_port><name>range</name><usage>output</usage><data_type>Range</data_type></data_port>
    <event_port><name>alarm</name><usage>output</usage></event_port>
    <service_port><name>setup</name><usage>provided</usage><type>Setup</type></service_port>";

const PLANNER: &str =
    "<data_port><name>range</name><usage>input</usage><data_type>Range</data_type></data_port>
    <data_port><name>image</name><usage>input</usage><data_type>Image</data_type></data_port>
    <event_port><name>alarm</name><usage>input</usage></event_port>
    <service_port><name>setup</name><usage>required</usage><type>Setup</type></service_port>";

impl Project {
    fn new() -> Self {
        let project = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        for (name, ports) in [("sensor", SENSOR), ("planner", PLANNER)] {
            project.write(
                &format!("components/{name}.xml"),
                &format!(
                    "<component_profile><name>{name}</name>
                    <execution_environment><library_name>{name}</library_name></execution_environment>
                    <execution_semantics><type>passive</type></execution_semantics>
                    <properties><property name='gain'>1</property></properties>
                    <ports>{ports}</ports></component_profile>"
                ),
            );
        }
        project
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn composite(&self, name: &str, members: &str, connections: &str, exports: &str) {
        self.write(
            &format!("components/{name}.xml"),
            &format!(
                "<composite_component_profile><name>{name}</name>\n<subcomponents>{}</subcomponents>\n\
                 <port_connections>{connections}</port_connections>\n<export_ports>{exports}\
                 </export_ports></composite_component_profile>",
                subcomponents(members)
            ),
        );
    }

    /// The application: members in line 2, connections in line 3, the rest in line 4.
    fn application(&self, members: &str, connections: &str, rest: &str) -> Loaded {
        self.write(
            "applications/a.xml",
            &format!(
                "<package_profile><name>a</name>\n<subcomponents>{}</subcomponents>\n\
                 <port_connections>{connections}</port_connections>\n{rest}</package_profile>",
                subcomponents(members)
            ),
        );
        let outcome = load_application(&self.path("applications/a.xml"), &LoadOptions::default());
        let mut problems = Vec::new();
        for problem in outcome.problems {
            let file = problem
                .place
                .file
                .file_stem()
                .unwrap()
                .to_string_lossy()
                .into_owned();
            let mut text = format!("{file}:{}: {problem}", problem.place.line);
            if let Some(help) = problem.help.filter(|help| help.starts_with("did you mean")) {
                write!(text, " ({})", help.split('?').next().unwrap()).unwrap();
            }
            problems.push(text);
        }
        Loaded {
            specification: outcome.specification,
            problems,
        }
    }
}

/// What came of it, easily compared.
struct Loaded {
    specification: Option<ApplicationSpecification>,
    problems: Vec<String>,
}

impl Loaded {
    #[track_caller]
    fn sound(self) -> ApplicationSpecification {
        assert_eq!(self.problems, [""; 0]);
        self.specification.unwrap()
    }

    #[track_caller]
    fn refused(self, expected: &[&str]) {
        assert_eq!(self.problems, expected);
        assert!(self.specification.is_none());
    }
}

/// `name:reference` pairs.
fn subcomponents(members: &str) -> String {
    let members = members.split_whitespace().map(|member| {
        let (name, reference) = member.split_once(':').unwrap();
        format!(
            "<subcomponent><name>{name}</name><reference>{reference}</reference></subcomponent>"
        )
    });
    members.collect()
}

/// `kind from.port to.port`.
fn connect(connection: &str) -> String {
    let mut words = connection.split_whitespace();
    let kind = words.next().unwrap();
    let mut text = format!("<port_connection port_type='{kind}'>");
    for (element, end) in ["source", "target"].into_iter().zip(words) {
        let (component, port) = end.split_once('.').unwrap();
        write!(
            text,
            "<{element} component_name='{component}' port_name='{port}'/>"
        )
        .unwrap();
    }
    text + "</port_connection>"
}

fn connect_all(connections: &[&str]) -> String {
    connections
        .iter()
        .map(|connection| connect(connection))
        .collect()
}

const BOTH: &str = "s:sensor.xml p:planner.xml";

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
fn mistakes_in_names() {
    let project = Project::new();
    project
        .application(
            "sonar:sensor.xml sonar:sensor.xml a/b:sensor.xml",
            &connect_all(&["data snar.range sonar.range", "data sonar.rnge sonar.range"]),
            "<coordination><depends source='sonar' target='sonr'/></coordination>",
        )
        .refused(&[
            "a:2: a second subcomponent of the name sonar",
            "a:2: the instance name a/b contains a `/`",
            "a:3: there is no subcomponent `snar` (did you mean `sonar`)",
            "a:3: `sonar` has no port `rnge` (did you mean `range`)",
            "a:4: there is no subcomponent `sonr` (did you mean `sonar`)",
        ]);
}

#[test]
fn mistakes_in_connections_are_all_listed() {
    let project = Project::new();
    project
        .application(
            "s:sensor.xml t:sensor.xml p:planner.xml",
            &connect_all(&[
                "data p.range s.range",
                "data s.alarm p.range",
                "data s.range p.image",
                "service s.setup p.setup",
            ]),
            "",
        )
        .refused(&[
            "a:3: the port range is an input data port",
            "a:3: the port range is an output data port",
            "a:3: the port alarm is an output event port, the connection one of kind data",
            "a:3: the types differ: the source has Range, the target Image",
            "a:3: the port setup is a provided service port",
            "a:3: the port setup is a required service port",
        ]);
    project
        .application(
            "s:sensor.xml t:sensor.xml p:planner.xml q:planner.xml",
            &connect_all(&[
                "data s.range p.range",
                "data s.range q.range",
                "event s.alarm p.alarm",
                "event t.alarm p.alarm",
                "event t.alarm p.alarm",
                "data t.range p.range",
                "service p.setup s.setup",
                "service p.setup t.setup",
            ]),
            "",
        )
        .refused(&[
            "a:3: this connection was already made",
            "a:3: a second writer into one data input",
            "a:3: a second provider for one required service",
        ]);
}

#[test]
fn mistakes_in_connection_elements() {
    let project = Project::new();
    project
        .application(
            BOTH,
            "<port_connection><source component_name='s'/></port_connection>\
             <port_connection port_type='method'/>",
            "",
        )
        .refused(&[
            "a:3: <port_connection> has no port_type",
            "a:3: <port_connection> has no <target>",
            "a:3: <source> has no port_name",
            "a:3: <port_connection> has no <source>",
            "a:3: <port_connection> has no <target>",
            "a:3: `method` in attribute port_type of <port_connection> is not understood",
        ]);
}

#[test]
fn circles_of_coordination_are_named() {
    let project = Project::new();
    let rules = |pairs: &[(&str, &str)]| {
        let rules = pairs
            .iter()
            .map(|(source, target)| format!("<depends source='{source}' target='{target}'/>"));
        format!("<coordination>{}</coordination>", rules.collect::<String>())
    };
    let three = "a:sensor.xml b:sensor.xml c:sensor.xml";
    project
        .application(three, "", &rules(&[("a", "b"), ("b", "c"), ("c", "b")]))
        .refused(&["a:4: components wait for each other: b after c after b"]);
    project
        .application(three, "", &rules(&[("a", "a")]))
        .refused(&["a:4: components wait for each other: a after a"]);
    let sound = project.application(three, "", &rules(&[("a", "b"), ("a", "c"), ("b", "c")]));
    assert_eq!(sound.sound().coordination, [(0, 1), (0, 2), (1, 2)]);
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
