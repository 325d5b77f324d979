//! `steadfast status`: how a running application is.

pub(super) mod text;

use std::process::ExitCode;

use clap::Args;
use container::control::Request;
use serde_json::Value;

use super::operator::{Format, Target, conclude};

pub use text::components;

/// What `steadfast status` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::STATUS)]
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
