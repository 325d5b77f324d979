//! A folder with an application and components of all kinds of ports beside it.

use std::fmt::Write as _;
use std::path::PathBuf;

use system_model::specification::ApplicationSpecification;
use system_profile::{LoadOptions, load_application};
use tempfile::TempDir;

/// A folder with `applications/a.xml` and components of all kinds of ports beside it.
pub struct Project {
    pub folder: TempDir,
}

pub const SENSOR: &str =
    "<data_port><name>range</name><usage>output</usage><data_type>Range</data_type></data_port>
    <event_port><name>alarm</name><usage>output</usage></event_port>
    <service_port><name>setup</name><usage>provided</usage><type>Setup</type></service_port>";

pub const PLANNER: &str =
    "<data_port><name>range</name><usage>input</usage><data_type>Range</data_type></data_port>
    <data_port><name>image</name><usage>input</usage><data_type>Image</data_type></data_port>
    <event_port><name>alarm</name><usage>input</usage></event_port>
    <service_port><name>setup</name><usage>required</usage><type>Setup</type></service_port>";

impl Project {
    pub fn new() -> Self {
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

    pub fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn composite(&self, name: &str, members: &str, connections: &str, exports: &str) {
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
    pub fn application(&self, members: &str, connections: &str, rest: &str) -> Loaded {
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
pub struct Loaded {
    pub specification: Option<ApplicationSpecification>,
    pub problems: Vec<String>,
}

impl Loaded {
    #[track_caller]
    pub fn sound(self) -> ApplicationSpecification {
        assert_eq!(self.problems, [""; 0]);
        self.specification.unwrap()
    }

    #[track_caller]
    pub fn refused(self, expected: &[&str]) {
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
pub fn connect(connection: &str) -> String {
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

pub fn connect_all(connections: &[&str]) -> String {
    connections
        .iter()
        .map(|connection| connect(connection))
        .collect()
}

pub const BOTH: &str = "s:sensor.xml p:planner.xml";
