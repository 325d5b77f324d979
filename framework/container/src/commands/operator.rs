//! What all commands have in common that ask a running application over its socket.

use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use container::control::client::{Client, ClientError, find};
use container::control::{Answer, Request};
use serde_json::{Map, Value};

use super::exit_code::{self, DONE, REFUSED};

/// Which running application is asked.
#[derive(Debug, Clone, Args)]
pub struct Target {
    /// Which application, if several are running
    #[arg(long, global = true, value_name = "NAME")]
    pub application: Option<String>,
    /// The socket of the running application, if it cannot be found by name
    #[arg(
        long,
        global = true,
        value_name = "PATH",
        conflicts_with = "application"
    )]
    pub socket: Option<PathBuf>,
}

/// How the answer is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people
    Text,
    /// For programs: the answer as one JSON object
    Json,
}

impl Target {
    /// The socket.
    ///
    /// # Errors
    /// If there is none, or it is not clear which one is meant.
    pub fn path(&self) -> Result<PathBuf, ClientError> {
        match &self.socket {
            Some(socket) => Ok(socket.clone()),
            None => find(self.application.as_deref()),
        }
    }

    /// A connection.
    ///
    /// # Errors
    /// As [`Target::path`], or if nobody listens there.
    pub fn connect(&self) -> Result<Client, ClientError> {
        Client::connect(&self.path()?)
    }

    /// Asks, and waits for the answer: at most five seconds.
    ///
    /// # Errors
    /// If there is no answer.
    pub fn ask(&self, request: &Request) -> Result<Answer, ClientError> {
        self.connect()?.ask(request)
    }
}

/// Writes an answer, as text by `words`; the exit code that goes with it.
pub fn conclude(
    answer: Result<Answer, ClientError>,
    format: Format,
    words: impl FnOnce(&Map<String, Value>) -> String,
) -> ExitCode {
    let answer = match answer {
        Ok(answer) => answer,
        Err(error) => return unanswered(&error),
    };
    let code = match &answer {
        Answer::Done(_) => DONE,
        Answer::Refused(_) => REFUSED,
    };
    // If nobody reads the text the exit code still tells.
    let _unread = match (format, &answer) {
        (Format::Json, _) => writeln!(io::stdout(), "{:#}", answer.to_json()),
        (Format::Text, Answer::Done(content)) => write!(io::stdout(), "{}", words(content)),
        (Format::Text, Answer::Refused(error)) => writeln!(io::stderr(), "{error}"),
    };
    ExitCode::from(code)
}

/// Says why there is no answer.
pub fn unanswered(error: &ClientError) -> ExitCode {
    let _unread = writeln!(io::stderr(), "{error}");
    ExitCode::from(exit_code::FILE)
}
