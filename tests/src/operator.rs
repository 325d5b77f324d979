//! An operator beside a running application: `steadfast fault`, and what goes over its socket.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use container::control::Request;
use container::control::client::Client;
use serde_json::Value;

use crate::build::artifacts;
use crate::watchdog::{Finished, Watched, until};

/// A command takes milliseconds; a busy machine gets more.
const COMMAND_LIMIT: Duration = Duration::from_secs(30);

/// Bringing an application of a few components up takes under a second.
const START_LIMIT: Duration = Duration::from_secs(60);

/// An operator of the one application whose sockets lie in this folder.
pub struct Operator {
    folder: PathBuf,
}

impl Operator {
    pub(crate) fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
        }
    }

    /// The sockets of applications that run.
    pub fn sockets(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.folder.join("steadfast"));
        let entries = entries.into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).collect()
    }

    /// The socket of the application, once it runs.
    ///
    /// # Panics
    /// If it does not come.
    pub fn socket(&self) -> PathBuf {
        let listens = || {
            let sockets = self.sockets();
            sockets.iter().any(|path| Client::connect(path).is_ok())
        };
        assert!(until(START_LIMIT, listens), "the application does not run");
        self.sockets().remove(0)
    }

    /// Runs `steadfast fault` with these arguments.
    pub fn fault(&self, arguments: &[&str]) -> Finished {
        self.run(&[&["fault"], arguments].concat())
    }

    /// Runs `steadfast` with these arguments.
    pub fn run(&self, arguments: &[&str]) -> Finished {
        Watched::spawn(&mut self.command(arguments)).wait(COMMAND_LIMIT)
    }

    /// `steadfast` with these arguments, where it finds the application.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(artifacts().join("steadfast"));
        command.args(arguments).env("XDG_RUNTIME_DIR", &self.folder);
        command
    }

    /// The JSON that `steadfast` writes with these arguments when all is well.
    ///
    /// # Panics
    /// If it is not.
    pub fn json(&self, arguments: &[&str]) -> Value {
        let finished = self.run(&[arguments, &["--format", "json"]].concat());
        assert_eq!(finished.code, Some(0), "{finished}");
        serde_json::from_str(&finished.stdout).expect("the answer is JSON")
    }

    /// The answer to a request that is not refused.
    ///
    /// # Panics
    /// If it is.
    pub fn answer(&self, arguments: &[&str]) -> Value {
        self.json(&[&["fault"], arguments].concat())
    }

    /// All faults.
    pub fn faults(&self) -> Vec<Value> {
        let answer = self.answer(&["list"]);
        answer["faults"].as_array().cloned().unwrap_or_default()
    }

    /// How the application is.
    ///
    /// # Panics
    /// If it does not answer.
    pub fn status(&self) -> Value {
        let mut client = Client::connect(&self.socket()).expect("it listens");
        let answer = client.ask(&Request::Status).expect("it answers");
        answer.to_json()["status"].clone()
    }

    /// Waits until this holds of the faults.
    ///
    /// # Panics
    /// If it never does.
    pub fn wait_for(&self, what: &str, holds: impl Fn(&[Value]) -> bool) {
        let happened = until(START_LIMIT, || holds(&self.faults()));
        assert!(happened, "{what}: {:#?}", self.faults());
    }
}
