//! `steadfast component`: components of a running application are listed, shown, reset, replaced and
//! stopped.

mod order;

use std::process::ExitCode;
use std::time::Duration;

use clap::{Args, Subcommand};
use container::control::Request;
use serde_json::Value;

use super::operator::{Format, Target, conclude};
use super::run::duration;
use super::{status, words};

/// What `steadfast component` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::COMPONENT)]
pub struct ComponentArguments {
    #[command(subcommand)]
    command: ComponentCommand,
    #[command(flatten)]
    target: Target,
    /// How the answer is written
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// How long to wait until an order was carried out: 500ms, 30s, 2min
    #[arg(
        long,
        global = true,
        value_name = "DURATION",
        value_parser = duration::parse,
        default_value = "10s"
    )]
    timeout: Duration,
}

#[derive(Debug, Subcommand)]
enum ComponentCommand {
    /// List all components with their states
    List,
    /// Show everything that is known of a component
    Info {
        /// Its name
        name: String,
    },
    /// Reset a component, its memory restored as the rules say; one that was stopped works again
    Reset {
        /// Its name
        name: String,
    },
    /// Put a secondary in a component's place
    Replace {
        /// Its name
        name: String,
        /// Component type of the secondary; without it the next one of the rules
        #[arg(long, value_name = "SECONDARY")]
        with: Option<String>,
    },
    /// Stop a component, and what needs it
    Stop {
        /// Its name
        name: String,
    },
}

/// Asks the running application and writes its answer.
pub fn run(arguments: &ComponentArguments) -> ExitCode {
    let request = request(&arguments.command);
    match request {
        Request::ComponentList | Request::ComponentInfo { .. } => {
            let answer = arguments.target.ask(&request);
            conclude(answer, arguments.format, |content| match request {
                Request::ComponentList => status::components(&content["components"]),
                _ => info(content.get("component").unwrap_or(&Value::Null)),
            })
        }
        order => order::carry_out(
            &arguments.target,
            &order,
            arguments.timeout,
            arguments.format,
        ),
    }
}

fn request(command: &ComponentCommand) -> Request {
    match command {
        ComponentCommand::List => Request::ComponentList,
        ComponentCommand::Info { name } => Request::ComponentInfo {
            component: name.clone(),
        },
        ComponentCommand::Reset { name } => Request::ComponentReset {
            component: name.clone(),
        },
        ComponentCommand::Replace { name, with } => Request::ComponentReplace {
            component: name.clone(),
            with: with.clone(),
        },
        ComponentCommand::Stop { name } => Request::ComponentStop {
            component: name.clone(),
        },
    }
}

fn info(component: &Value) -> String {
    let mut text = String::new();
    words::parts(&mut text, 0, component);
    text
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        component: ComponentArguments,
    }

    #[test]
    fn command_lines() {
        let component = || "camera".to_owned();
        let replace = |with: Option<&str>| Request::ComponentReplace {
            component: component(),
            with: with.map(str::to_owned),
        };
        for (line, expected) in [
            ("list", Some(Request::ComponentList)),
            (
                "info camera --format json",
                Some(Request::ComponentInfo {
                    component: component(),
                }),
            ),
            (
                "reset camera --timeout 500ms",
                Some(Request::ComponentReset {
                    component: component(),
                }),
            ),
            ("replace camera", Some(replace(None))),
            ("replace camera --with spare", Some(replace(Some("spare")))),
            (
                "stop camera --application patrol",
                Some(Request::ComponentStop {
                    component: component(),
                }),
            ),
            ("info", None),
            ("start camera", None),
            ("reset camera --timeout soon", None),
        ] {
            let words = std::iter::once("component").chain(line.split(' '));
            let parsed = Line::try_parse_from(words).ok();
            let found = parsed.map(|line| request(&line.component.command));
            assert_eq!(found, expected, "{line}");
        }
    }
}
