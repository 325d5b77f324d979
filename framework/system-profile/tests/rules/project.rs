//! A folder with an application that rules are written for.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use system_model::injection::Injection;
use system_model::rules::FaultRules;
use system_model::specification::ApplicationSpecification;
use system_profile::{
    LoadOptions, Problem, Severity, check_file, load_application, load_injections, load_rules,
};
use tempfile::TempDir;

pub fn data_port(name: &str, usage: &str, data_type: &str) -> String {
    format!(
        "<data_port><name>{name}</name><usage>{usage}</usage><data_type>{data_type}</data_type>\
         </data_port>"
    )
}

pub fn profile(name: &str, execution: &str, ports: &str, rules: &str) -> String {
    format!(
        "<component_profile><name>{name}</name>\n\
         <execution_environment><library_name>{name}</library_name></execution_environment>\n\
         <execution_semantics>{execution}</execution_semantics>\n{rules}\n\
         <ports>{ports}</ports></component_profile>"
    )
}

pub const PERIODIC: &str = "<type>periodic</type><period>20</period>";
const EVENTS: &str = "<event_port><name>alarm</name><usage>output</usage></event_port>
    <event_port><name>reset</name><usage>input</usage></event_port>";

/// A folder with the application `patrol`: three sonars and a passive map, an avoidance that reads
/// one sonar, and a motor that it drives.
pub struct Project {
    pub folder: TempDir,
}

impl Project {
    pub fn new() -> Self {
        let project = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        let range_out = data_port("range", "output", "Range");
        let range_in = data_port("range", "input", "Range");
        let command_in = data_port("command", "input", "Command");
        let command_out = data_port("command", "output", "Command");
        let all_events = format!("{range_out}{EVENTS}");
        let avoidance = format!("{range_in}{command_out}");
        let encoders = data_port("left", "output", "Ticks");
        for (name, execution, ports) in [
            ("sonar", PERIODIC, &all_events),
            ("avoidance", PERIODIC, &avoidance),
            ("simple", PERIODIC, &avoidance),
            ("blind", PERIODIC, &data_port("range", "input", "Image")),
            ("motor", PERIODIC, &command_in),
            ("encoders", "<type>aperiodic</type>", &encoders),
            ("map", "<type>passive</type>", &String::new()),
        ] {
            project.write(
                &format!("components/{name}.xml"),
                &profile(name, execution, ports, ""),
            );
        }
        project.application("");
        project
    }

    /// Writes the application anew, with further elements in it.
    pub fn application(&self, rest: &str) {
        let members = [
            ("front", "sonar"),
            ("left", "sonar"),
            ("right", "sonar"),
            ("avoidance", "avoidance"),
            ("motor", "motor"),
            ("encoders", "encoders"),
            ("map", "map"),
        ];
        let mut text = "<package_profile><name>patrol</name>\n<subcomponents>\n".to_owned();
        for (name, reference) in members {
            writeln!(
                text,
                "<subcomponent><name>{name}</name><reference>{reference}.xml</reference>\
                 <node_id>base</node_id></subcomponent>"
            )
            .unwrap();
        }
        text += "</subcomponents>\n<port_connections>\n";
        for (source, target, port) in [
            ("front", "avoidance", "range"),
            ("avoidance", "motor", "command"),
        ] {
            writeln!(
                text,
                "<port_connection port_type='data'>\
                 <source component_name='{source}' port_name='{port}'/>\
                 <target component_name='{target}' port_name='{port}'/></port_connection>"
            )
            .unwrap();
        }
        let text = format!("{text}</port_connections>\n{rest}</package_profile>");
        self.write("applications/patrol.xml", &text);
    }

    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    }

    /// Loads rule files, given by what stands in their `fault_rules`.
    pub fn load(&self, contents: &[&str]) -> Loaded {
        let files = contents.iter().enumerate().map(|(number, content)| {
            self.write(
                &format!("rules/r{number}.xml"),
                &format!("<fault_rules application=\"patrol\">{content}</fault_rules>"),
            )
        });
        self.load_files(&files.collect::<Vec<_>>())
    }

    pub fn load_files(&self, files: &[PathBuf]) -> Loaded {
        let outcome = load_rules(&self.specification(), files, &LoadOptions::default());
        let problems = outcome.problems.iter().map(|problem| {
            let file = problem.place.file.file_stem().unwrap().to_string_lossy();
            format!("{file}:{}: {}", problem.place.line, self.describe(problem))
        });
        Loaded {
            problems: problems.collect(),
            rules: outcome.rules,
        }
    }

    /// Gives the application a world, and the front sonar its socket.
    pub fn in_a_world(&self) {
        self.write("worlds/hall.xml", "<world_profile/>");
        self.application("<world><reference>hall.xml</reference></world>");
        let path = self.folder.path().join("applications/patrol.xml");
        let text = std::fs::read_to_string(path).unwrap().replace(
            "<name>front</name>",
            "<name>front</name><properties><property name='index' type='int'>2</property>\
             </properties>",
        );
        self.write("applications/patrol.xml", &text);
    }

    /// Loads an injection file, given by what stands in its `fault_injections`.
    pub fn inject(&self, content: &str) -> (Option<Vec<Injection>>, Vec<String>) {
        let path = self.write(
            "injections.xml",
            &format!("<fault_injections application=\"patrol\">{content}</fault_injections>"),
        );
        let outcome = load_injections(&self.specification(), &path);
        let problems = outcome.problems.iter();
        let problems = problems.map(|problem| self.describe(problem)).collect();
        (outcome.injections, problems)
    }

    pub fn specification(&self) -> ApplicationSpecification {
        let path = self.folder.path().join("applications/patrol.xml");
        let application = load_application(&path, &LoadOptions::default());
        application.specification.expect("a sound application")
    }

    /// What `check` says of a file.
    pub fn check(&self, path: &Path) -> Vec<String> {
        let reports = check_file(path, &LoadOptions::default());
        let problems = reports.iter().flat_map(|report| &report.problems);
        let problems = problems.map(|problem| {
            let line = problem.place.line;
            format!("{line}: {}", self.describe(problem))
        });
        problems.collect()
    }

    fn describe(&self, problem: &Problem) -> String {
        assert!(problem.help.is_some(), "no help: {problem}");
        assert!(
            problem.place.line > 0 && problem.length > 0,
            "no place: {problem}"
        );
        let folder = self.folder.path().to_string_lossy();
        let message = problem.message.replace(&*folder, "");
        match problem.severity {
            Severity::Error => message,
            severity => format!("{}: {message}", severity.name()),
        }
    }
}

pub struct Loaded {
    pub rules: Option<FaultRules>,
    pub problems: Vec<String>,
}

impl Loaded {
    #[track_caller]
    pub fn sound(self) -> FaultRules {
        assert_eq!(self.problems, [""; 0]);
        self.rules.expect("rules")
    }
}

pub fn of(component: &str, rules: &str) -> String {
    format!("<component name=\"{component}\">{rules}</component>")
}

pub fn milliseconds(number: u64) -> Duration {
    Duration::from_millis(number)
}
