//! An application for one test: its profiles, written to a folder of its own, and its run.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use rustix::process::Signal;
use tempfile::TempDir;

use crate::build::artifacts;
use crate::member::Member;
use crate::operator::Operator;
use crate::outcome::Outcome;
use crate::watchdog::{Finished, Watched, until};

/// A run takes well under a second of machine time; a busy machine gets a hundred times that.
const RUN_LIMIT: Duration = Duration::from_secs(100);

/// The container promises to stop within three seconds; a busy machine gets more.
const STOP_LIMIT: Duration = Duration::from_secs(30);

/// Files of a run, in the application's folder.
const EVENTS: &str = "events.jsonl";
const SUMMARY: &str = "summary.json";

/// Files that are passed to a run when they are there.
const RULES: &str = "rules.xml";
const ISOLATION: &str = "isolation.xml";
const INJECTIONS: &str = "injections.xml";

/// An application in a folder that is removed with it.
pub struct Application {
    folder: TempDir,
    subcomponents: String,
    connections: String,
    rest: String,
    rules: String,
    injections: String,
    /// Instance names of its components.
    members: Vec<String>,
    /// Whether each of them runs in a process of its own.
    in_hosts: bool,
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
            rules: String::new(),
            injections: String::new(),
            members: Vec::new(),
            in_hosts: false,
        }
    }

    /// Each component runs in a process of its own.
    #[must_use]
    pub fn in_hosts(mut self) -> Self {
        self.in_hosts = true;
        self
    }

    /// Adds a component.
    #[must_use]
    pub fn with(mut self, member: &Member) -> Self {
        self.write(&format!("{}.xml", member.instance()), member.profile());
        self.members.push(member.instance().to_owned());
        self.subcomponents += &member.subcomponent();
        self.subcomponents += "\n";
        self
    }

    /// Writes a component's profile, named after the instance, for a rule that refers to it.
    #[must_use]
    pub fn with_profile(self, member: &Member) -> Self {
        self.write(&format!("{}.xml", member.instance()), member.profile());
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

    /// Adds rules: elements of `fault_rules`.
    #[must_use]
    pub fn rules(mut self, text: &str) -> Self {
        self.rules += text;
        self
    }

    /// Faults of these components are only recorded: what failed stays in ERROR.
    #[must_use]
    pub fn not_recovered(self, components: &[&str]) -> Self {
        let rule = |name: &&str| {
            format!("<component name='{name}'><severity>ignore</severity></component>\n")
        };
        let rules: String = components.iter().map(rule).collect();
        self.rules(&rules)
    }

    /// Adds faults that are made on purpose: elements of `fault_injections`.
    #[must_use]
    pub fn injections(mut self, text: &str) -> Self {
        self.injections += text;
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

    /// Runs it by the machine's clock until `enough` holds of its event file, then interrupts it:
    /// how long that takes is the machine's affair.
    ///
    /// # Panics
    /// If it never holds.
    pub fn run_until(&self, enough: impl Fn(&str) -> bool) -> Outcome {
        self.interrupt_when(&[], Signal::INT, enough)
    }

    /// As [`Self::run_until`], with arguments and another signal.
    ///
    /// # Panics
    /// If it never holds.
    pub fn interrupt_when(
        &self,
        arguments: &[&str],
        signal: Signal,
        enough: impl Fn(&str) -> bool,
    ) -> Outcome {
        let child = self.start(arguments);
        self.wait_until(enough);
        child.signal(signal);
        self.outcome(child.wait(STOP_LIMIT))
    }

    /// Waits until `enough` holds of the event file of the run that is under way.
    ///
    /// # Panics
    /// If it never holds.
    pub fn wait_until(&self, enough: impl Fn(&str) -> bool) {
        let mut text = String::new();
        let happened = until(RUN_LIMIT, || {
            text = self.events_so_far();
            enough(&text)
        });
        assert!(happened, "what was waited for did not happen: {text}");
    }

    /// The event file of the run that is under way.
    pub fn events_so_far(&self) -> String {
        std::fs::read_to_string(self.folder().join(EVENTS)).unwrap_or_default()
    }

    /// Runs these files in one container.
    pub fn run_together(&self, files: &[PathBuf], arguments: &[&str]) -> Outcome {
        let finished = self.start_files(files, arguments).wait(RUN_LIMIT);
        self.outcome(finished)
    }

    /// Starts a run with its rules and injections; [`Self::outcome`] tells what became of it.
    pub fn start(&self, arguments: &[&str]) -> Watched {
        let mut arguments: Vec<String> = arguments.iter().map(|it| (*it).to_owned()).collect();
        let isolation =
            |name| format!("<component name='{name}'><isolation>process</isolation></component>\n");
        let isolation: String = if self.in_hosts {
            self.members.iter().map(isolation).collect()
        } else {
            String::new()
        };
        for (option, name, root, text) in [
            ("--rules", ISOLATION, "fault_rules", &isolation),
            ("--rules", RULES, "fault_rules", &self.rules),
            ("--inject", INJECTIONS, "fault_injections", &self.injections),
        ] {
            if !text.is_empty() {
                let text = format!("<{root} application='application'>\n{text}</{root}>");
                let path = self.write(name, text);
                arguments.extend([option.to_owned(), path.display().to_string()]);
            }
        }
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        self.start_file(&self.profile(), &arguments)
    }

    /// Runs another file than the application's own.
    pub fn run_file(&self, file: &Path, arguments: &[&str]) -> Outcome {
        let finished = self.start_file(file, arguments).wait(RUN_LIMIT);
        self.outcome(finished)
    }

    fn start_file(&self, file: &Path, arguments: &[&str]) -> Watched {
        self.start_files(&[file.to_owned()], arguments)
    }

    /// Starts these files in one container.
    pub fn start_files(&self, files: &[PathBuf], arguments: &[&str]) -> Watched {
        Watched::spawn(&mut self.command(files, arguments))
    }

    /// What starts these files in one container.
    pub fn command(&self, files: &[PathBuf], arguments: &[&str]) -> Command {
        let mut command = Command::new(artifacts().join("steadfast"));
        command
            .arg("run")
            .args(files)
            .args(arguments)
            .arg("--events")
            .arg(self.folder().join(EVENTS))
            .arg("--summary")
            .arg(self.folder().join(SUMMARY))
            .env("XDG_RUNTIME_DIR", self.folder())
            .env("XDG_STATE_HOME", self.folder().join("state"))
            .env_remove("STATE_DIRECTORY")
            .env_remove("STEADFAST_LIBRARY_PATH");
        command
    }

    /// An operator beside the run.
    pub fn operator(&self) -> Operator {
        Operator::new(self.folder())
    }

    /// Interrupts a run and says what became of it.
    pub fn interrupt(&self, run: Watched) -> Outcome {
        run.signal(Signal::INT);
        self.outcome(run.wait(STOP_LIMIT))
    }

    /// What became of a run.
    pub fn outcome(&self, finished: Finished) -> Outcome {
        let read = |name: &str| std::fs::read_to_string(self.folder().join(name));
        Outcome::new(
            finished,
            read(EVENTS).unwrap_or_default(),
            read(SUMMARY).ok(),
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
