//! An application for one test: its profiles, written to a folder of its own, and its run.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use tempfile::TempDir;

use crate::build::artifacts;
use crate::outcome::Outcome;
use crate::watchdog::Watched;

/// A run takes well under a second of machine time; a busy machine gets a hundred times that.
const RUN_LIMIT: Duration = Duration::from_secs(100);

/// A component instance with a profile of its own.
#[derive(Debug, Clone)]
pub struct Member {
    instance: String,
    library: String,
    kind: String,
    period_ms: u64,
    priority: u8,
    own_properties: String,
    properties: String,
    ports: String,
    queue: String,
}

impl Member {
    /// An instance of a component of the tests, with its ports; runs every 10 ms.
    pub fn new(instance: &str, library: &str) -> Self {
        Self {
            instance: instance.to_owned(),
            library: library.to_owned(),
            kind: "periodic".to_owned(),
            period_ms: 10,
            priority: 0,
            own_properties: String::new(),
            properties: String::new(),
            ports: ports(library),
            queue: "<queueing_policy>FIFO</queueing_policy><queue_size>1000</queue_size>"
                .to_owned(),
        }
    }

    /// `execution_semantics/type`.
    #[must_use]
    pub fn kind(mut self, kind: &str) -> Self {
        kind.clone_into(&mut self.kind);
        self
    }

    /// Period in milliseconds.
    #[must_use]
    pub fn period(mut self, milliseconds: u64) -> Self {
        self.period_ms = milliseconds;
        self
    }

    /// Priority.
    #[must_use]
    pub fn priority(mut self, priority: u8) -> Self {
        self.priority = priority;
        self
    }

    /// A property in the component's profile.
    #[must_use]
    pub fn property(mut self, name: &str, value: &str) -> Self {
        self.properties += &format!("<property name='{name}'>{value}</property>");
        self
    }

    /// A property that the application gives this instance.
    #[must_use]
    pub fn own_property(mut self, name: &str, value: &str) -> Self {
        self.own_properties += &format!("<property name='{name}'>{value}</property>");
        self
    }

    /// Other ports than the library has.
    #[must_use]
    pub fn ports(mut self, ports: &str) -> Self {
        ports.clone_into(&mut self.ports);
        self
    }

    /// What data inputs keep; without it, more than arrives in any test.
    #[must_use]
    pub fn queue(mut self, policy: &str, size: usize) -> Self {
        self.queue =
            format!("<queueing_policy>{policy}</queueing_policy><queue_size>{size}</queue_size>");
        self
    }

    fn profile(&self) -> String {
        let input = "<usage>input</usage>";
        format!(
            "<component_profile><name>{}</name>\n\
             <execution_environment><library_name>{}</library_name></execution_environment>\n\
             <execution_semantics><type>{}</type><period>{}</period><priority>{}</priority>\
             </execution_semantics>\n<properties>{}</properties>\n<ports>{}</ports>\n\
             </component_profile>",
            self.instance,
            self.library,
            self.kind,
            self.period_ms,
            self.priority,
            self.properties,
            self.ports.replace(input, &format!("{input}{}", self.queue)),
        )
    }

    fn subcomponent(&self) -> String {
        format!(
            "<subcomponent><name>{0}</name><reference>{0}.xml</reference>\
             <properties>{1}</properties></subcomponent>",
            self.instance, self.own_properties
        )
    }
}

/// Ports of the libraries of the tests, as profiles declare them.
fn ports(library: &str) -> String {
    let data = |name: &str, usage: &str| {
        format!(
            "<data_port><name>{name}</name><usage>{usage}</usage>\
             <data_type>Sample</data_type></data_port>"
        )
    };
    let event = |name: &str, usage: &str| {
        format!(
            "<event_port><name>{name}</name><usage>{usage}</usage>\
             <data_type>Sample</data_type></event_port>"
        )
    };
    let service = |usage: &str| {
        format!(
            "<service_port><name>arithmetic</name><usage>{usage}</usage>\
             <type>Arithmetic</type></service_port>"
        )
    };
    match library {
        "counter" => data("output", "output"),
        "recorder" => data("input", "input"),
        "echo" => data("input", "input") + &data("output", "output"),
        "low_pass" => data("raw", "input") + &data("smooth", "output"),
        "herald" => event("news", "output"),
        "listener" => event("news", "input"),
        "adder" => service("provided"),
        "asker" => service("required"),
        "diary" | "no_component" | "old_abi" | "wrong_layout" | "crashes_when_loaded" => {
            String::new()
        }
        _faulty => data("output", "output") + &event("heard", "input") + &service("provided"),
    }
}

/// An application in a folder that is removed with it.
pub struct Application {
    folder: TempDir,
    subcomponents: String,
    connections: String,
    rest: String,
}

impl Default for Application {
    fn default() -> Self {
        Self::new()
    }
}

impl Application {
    /// One without components.
    ///
    /// # Panics
    /// If there is no room for temporary files.
    pub fn new() -> Self {
        Self {
            folder: tempfile::tempdir().expect("a folder for the application"),
            subcomponents: String::new(),
            connections: String::new(),
            rest: String::new(),
        }
    }

    /// Adds a component.
    #[must_use]
    pub fn with(mut self, member: &Member) -> Self {
        self.write(&format!("{}.xml", member.instance), member.profile());
        self.subcomponents += &member.subcomponent();
        self.subcomponents += "\n";
        self
    }

    /// Adds a component by the name of a profile that was written by [`Self::write`].
    #[must_use]
    pub fn with_reference(mut self, instance: &str, reference: &str) -> Self {
        writeln!(
            self.subcomponents,
            "<subcomponent><name>{instance}</name><reference>{reference}</reference></subcomponent>"
        )
        .expect("writing to memory does not fail");
        self
    }

    /// Connects ports: `connect("data", "a.output", "b.input")`.
    ///
    /// # Panics
    /// If an end is not written so.
    #[must_use]
    pub fn connect(mut self, kind: &str, source: &str, target: &str) -> Self {
        self.connections += &connection(kind, source, target);
        self
    }

    /// Further elements of the application profile.
    #[must_use]
    pub fn element(mut self, text: &str) -> Self {
        self.rest += text;
        self
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Writes a file of the application.
    ///
    /// # Panics
    /// If that fails.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.folder().join(name);
        std::fs::write(&path, content).expect("a file of the application is written");
        path
    }

    /// Writes the application profile.
    pub fn profile(&self) -> PathBuf {
        self.write(
            "application.xml",
            format!(
                "<package_profile><name>application</name>\n<subcomponents>\n{}</subcomponents>\n\
                 <port_connections>\n{}</port_connections>\n{}</package_profile>",
                self.subcomponents, self.connections, self.rest
            ),
        )
    }

    /// Runs it for a time of the simulated clock.
    pub fn simulate(&self, duration: &str) -> Outcome {
        self.run(&["--clock", "simulated", "--for", duration])
    }

    /// Runs it for a time of the machine's clock.
    pub fn run_really(&self, duration: &str) -> Outcome {
        self.run(&["--clock", "real", "--for", duration])
    }

    /// Runs it to its end.
    pub fn run(&self, arguments: &[&str]) -> Outcome {
        let finished = self.start(arguments).wait(RUN_LIMIT);
        self.outcome(finished)
    }

    /// Starts a run; [`Self::outcome`] tells what became of it.
    pub fn start(&self, arguments: &[&str]) -> Watched {
        self.start_file(&self.profile(), arguments)
    }

    /// Runs another file than the application's own.
    pub fn run_file(&self, file: &Path, arguments: &[&str]) -> Outcome {
        let finished = self.start_file(file, arguments).wait(RUN_LIMIT);
        self.outcome(finished)
    }

    fn start_file(&self, file: &Path, arguments: &[&str]) -> Watched {
        let mut command = Command::new(artifacts().join("steadfast"));
        command
            .arg("run")
            .arg(file)
            .args(arguments)
            .arg("--events")
            .arg(self.events_file())
            .arg("--summary")
            .arg(self.folder().join("summary.json"))
            .env_remove("STEADFAST_LIBRARY_PATH");
        Watched::spawn(&mut command)
    }

    /// Where events are written.
    pub fn events_file(&self) -> PathBuf {
        self.folder().join("events.jsonl")
    }

    /// What became of a run.
    pub fn outcome(&self, finished: crate::watchdog::Finished) -> Outcome {
        let read = |name: &str| std::fs::read_to_string(self.folder().join(name));
        Outcome::new(
            finished,
            read("events.jsonl").unwrap_or_default(),
            read("summary.json").ok(),
        )
    }
}

/// A connection as applications and composites declare it.
fn connection(kind: &str, source: &str, target: &str) -> String {
    let end = |text: &str| {
        let (component, port) = text.split_once('.').expect("an end is component.port");
        format!("component_name='{component}' port_name='{port}'")
    };
    format!(
        "<port_connection port_type='{kind}'><source {}/><target {}/></port_connection>\n",
        end(source),
        end(target)
    )
}
