//! `steadfast run --supervised`: the parent of the container that does the running.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use clap::Args;
use container::outer_supervision::{
    DEFAULT_BEAT_LIMIT, DEFAULT_RESTARTS, LEAST_BEAT_LIMIT, Plan, PlannedWorld, SuperviseError,
    Supervised, supervise,
};
use container::system::Application;

use super::{ClockArgument, Failed, RunArguments, applications, duration, exit_code, worlds};

/// The option that makes a parent.
const SUPERVISED: &str = "--supervised";

/// Whether, and how, the container is supervised by a parent.
#[derive(Debug, Args)]
pub(super) struct SupervisionArguments {
    /// Start the container as a child process, and restart it when it crashes or hangs
    #[arg(long, group = "supervision")]
    pub(super) supervised: bool,
    /// The process that supervises this one
    #[arg(long, hide = true, value_name = "PROCESS", group = "supervision")]
    pub(super) supervised_by: Option<i32>,
    /// Give up when the container has been restarted so often within 60 s
    #[arg(long, value_name = "N", default_value_t = DEFAULT_RESTARTS, requires = "supervision")]
    restarts: u32,
    /// Take a running container for hung that has given no sign of life for so long [default: 1s]
    #[arg(long, value_name = "DURATION", value_parser = beat_limit, requires = "supervision")]
    supervision_timeout: Option<Duration>,
    /// Keep this watchdog device of the machine (/dev/watchdog) fed while the container lives
    #[arg(long, value_name = "DEVICE", requires = "supervision")]
    hardware_watchdog: Option<PathBuf>,
}

fn beat_limit(text: &str) -> Result<Duration, String> {
    let limit = duration::parse(text)?;
    if limit < LEAST_BEAT_LIMIT {
        return Err(format!(
            "'{text}' is too short: a container that lives may be heard as seldom as every 150 ms; \
             write at least {LEAST_BEAT_LIMIT:?}"
        ));
    }
    Ok(limit)
}

/// Supervises a container to its end: the exit code of the run.
pub(super) fn run(arguments: &RunArguments) -> Result<u8, Failed> {
    if arguments.clock == ClockArgument::Simulated {
        return Err(Failed {
            code: exit_code::USAGE,
            text: "--supervised and --clock simulated do not go together: simulated time stands still \
                   while no container runs\n  help: leave one of them out"
                .to_owned(),
        });
    }
    // What is wrong with these is said here; warnings are for the container to say.
    let (applications, _warnings) = applications::read(&arguments.sources())?;
    let world = only_world(&applications)?;
    let executable = std::env::current_exe().map_err(SuperviseError::from);
    let options = &arguments.supervision;
    let plan = executable.map(|executable| Plan {
        executable,
        arguments: container_arguments(std::env::args_os()),
        world: world.map(|file| PlannedWorld {
            file,
            seed: arguments.seed,
        }),
        restarts: options.restarts,
        beat_limit: options.supervision_timeout.unwrap_or(DEFAULT_BEAT_LIMIT),
        hardware_watchdog: options.hardware_watchdog.clone(),
        safe_states: safe_states(&applications),
        events: arguments.events.clone(),
    });
    plan.and_then(supervise).map_err(|error| Failed {
        code: match error {
            SuperviseError::File { .. } => exit_code::FILE,
            _ => exit_code::SYSTEM,
        },
        text: error.to_string(),
    })
}

/// The world of a supervised run, if there is one: the process that outlives containers is one.
fn only_world(applications: &[Application]) -> Result<Option<PathBuf>, Failed> {
    let files = worlds::files(applications);
    let Some(other) = files.get(1) else {
        return Ok(files.into_iter().next());
    };
    Err(Failed {
        code: exit_code::PROFILE,
        text: format!(
            "the applications drive in {} and in {}: --supervised keeps one world alive\n  help: let \
             them name the same world, or run each application in a supervised container of its own",
            files[0].display(),
            other.display()
        ),
    })
}

/// The parent of this container, if it has one.
pub(super) fn join(arguments: &RunArguments) -> Result<Option<Arc<Supervised>>, Failed> {
    let parent = arguments.supervision.supervised_by;
    let joined = parent.map(Supervised::join).transpose();
    let joined = joined.map_err(|error| Failed {
        code: exit_code::SYSTEM,
        text: format!(
            "the parent that is to supervise cannot be reached: {error}\n  help: start the run with \
             --supervised, which makes a parent"
        ),
    })?;
    Ok(joined.map(Arc::new))
}

/// What the container is called with: the same, but it supervises nothing.
fn container_arguments(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let without_program = arguments.skip(1);
    without_program
        .filter(|argument| argument != SUPERVISED)
        .collect()
}

fn safe_states(applications: &[Application]) -> Vec<system_model::rules::SafeStateRule> {
    let rules = applications.iter().flat_map(|it| &it.rules.components);
    let actuators = rules.filter_map(|rules| rules.actuator.as_ref());
    actuators
        .flat_map(|actuator| actuator.value.safe_states.iter().cloned())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_container_is_called_with_the_same() {
        let given = ["steadfast", "run", "a.xml", "--supervised", "--seed", "7"];
        let arguments = container_arguments(given.iter().map(OsString::from));
        assert_eq!(arguments, ["run", "a.xml", "--seed", "7"]);
    }

    #[test]
    fn a_limit_that_no_container_keeps_is_refused() {
        for (text, expected_ms) in [
            ("1s", Some(1000)),
            ("300ms", Some(300)),
            ("299ms", None),
            ("soon", None),
        ] {
            let expected = expected_ms.map(Duration::from_millis);
            assert_eq!(beat_limit(text).ok(), expected, "{text}");
        }
    }
}
