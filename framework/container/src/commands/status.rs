//! `steadfast status`: how a running application is.

mod text;

use std::process::ExitCode;

use clap::Args;
use container::control::Request;
use serde_json::Value;

use super::operator::{Format, Target, conclude};

pub use text::components;

/// What `steadfast status` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = "Columns:
  LEVEL  OK; WARN: it works, but is being recovered or has an open fault; ERROR: it should run and
         does not; STALE: it was stopped
  RATE   completed cycles per second, over the last second
  LOAD   how much of its period its executor's cycle takes, over the last second

Exit codes:
  0  it was done
  1  the application refused: too many ask at once
  2  no application is running, several are, or it does not answer")]
pub struct StatusArguments {
    #[command(flatten)]
    target: Target,
    /// How the answer is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Asks the running application and writes its answer.
pub fn run(arguments: &StatusArguments) -> ExitCode {
    let answer = arguments.target.ask(&Request::Status);
    conclude(answer, arguments.format, |content| {
        text::of(content.get("status").unwrap_or(&Value::Null))
    })
}
