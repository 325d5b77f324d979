//! `steadfast run`: brings applications up, watches them, stops them in order.

pub(super) mod applications;
pub(in crate::commands) mod duration;
mod failure;
mod libraries;
mod live;
mod models;
mod network;
mod observers;
mod recording;
mod report;
mod supervised;
mod tasks;
mod words;
mod worlds;

use std::io::{self, IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::{Args, ValueEnum};
use container::summary::Summary;
use container::system::{ClockKind, RunOptions, StateOptions, System};
use crossbeam::channel::bounded;
use system_profile::Problem;

use super::{output, problems};
use applications::Sources;
pub(super) use failure::{Failed, exit_code, refused, unwritable};
pub(super) use libraries::{libraries, library_folders};
use live::Watcher;
use observers::{ObserverArguments, listen};
use recording::RecordingArguments;
use supervised::SupervisionArguments;
pub(super) use worlds::simulation;

/// How often a person's view is refreshed: fast enough to look alive, slow enough to be read.
const REFRESH_PERIOD: Duration = Duration::from_millis(100);

/// Lines that may wait for the view; a view that lags loses lines, the event file does not.
const ECHO_QUEUE: usize = 1024;

/// What `steadfast run` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::RUN)]
pub struct RunArguments {
    /// Application profiles (`package_profile` or `application_profile`), run in one container
    #[arg(required = true, value_name = "APPLICATION.xml")]
    applications: Vec<PathBuf>,
    /// Fault rules: what counts as a fault and what is done about it; may be given several times,
    /// also a `system_config` that says which applications need each other
    #[arg(long, value_name = "FILE.xml")]
    rules: Vec<PathBuf>,
    /// Faults to be made on purpose; may be given several times
    #[arg(long, value_name = "FILE.xml")]
    inject: Vec<PathBuf>,
    /// How long to run, by the chosen clock: 500ms, 30s, 2min, 1h; without it until the target is
    /// reached or Ctrl-C
    #[arg(long = "for", value_name = "DURATION", value_parser = duration::parse)]
    duration: Option<Duration>,
    /// Real time, or simulated time as fast as it goes
    #[arg(long, value_enum, default_value_t = ClockArgument::Real)]
    clock: ClockArgument,
    /// Seed of the simulated world
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write every event as one JSON object a line
    #[arg(long, value_name = "FILE.jsonl")]
    events: Option<PathBuf>,
    /// Write what the run came to as JSON
    #[arg(long, value_name = "FILE.json")]
    summary: Option<PathBuf>,
    /// Draw the drive as seen from above
    #[arg(long, value_name = "FILE.svg")]
    picture: Option<PathBuf>,
    /// Also look for component libraries in this folder; may be given several times
    #[arg(long = "library-path", value_name = "FOLDER")]
    library_path: Vec<PathBuf>,
    /// Also look for referenced profiles in this folder; may be given several times
    #[arg(long = "search-path", value_name = "FOLDER")]
    search_path: Vec<PathBuf>,
    /// Where checkpoints lie that outlive the container (`<backup persist="true">`); without it
    /// $STATE_DIRECTORY, $XDG_STATE_HOME/steadfast or ~/.local/state/steadfast
    #[arg(long, value_name = "FOLDER")]
    state_path: Option<PathBuf>,
    /// Remove the checkpoints of a run that died, instead of going on from them
    #[arg(long)]
    fresh: bool,
    /// How the result is printed
    #[arg(long, value_enum, default_value_t = Format::Human)]
    format: Format,
    #[command(flatten)]
    observers: ObserverArguments,
    #[command(flatten)]
    supervision: SupervisionArguments,
    #[command(flatten)]
    recording: RecordingArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ClockArgument {
    /// By the machine's clock
    Real,
    /// As fast as it goes; the same seed gives the same events
    Simulated,
}

/// How the result is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// What happens, line by line, and a table in the end
    Human,
    /// What the run came to as one JSON object, as in --summary; what happens goes to standard error
    Json,
}

impl RunArguments {
    /// The files that say what is run.
    fn sources(&self) -> Sources<'_> {
        Sources {
            applications: &self.applications,
            rules: &self.rules,
            inject: &self.inject,
            search_path: &self.search_path,
        }
    }
}

/// Runs applications to their end.
pub fn run(arguments: &RunArguments) -> ExitCode {
    let ended = match arguments.supervision.supervised {
        true => supervised::run(arguments),
        false => run_to_end(arguments).map(|()| exit_code::ENDED),
    };
    match ended {
        Ok(code) => ExitCode::from(code),
        Err(failed) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(io::stderr(), "{}", failed.text.trim_end());
            ExitCode::from(failed.code)
        }
    }
}

fn run_to_end(arguments: &RunArguments) -> Result<(), Failed> {
    let supervised = supervised::join(arguments)?;
    let applications = applications::load(&arguments.sources())?;
    let simulations = match supervised.as_ref().and_then(|it| it.world()) {
        Some(_elsewhere) => Vec::new(),
        None => worlds::simulate(&applications, arguments.seed)?,
    };
    let stop_asked = watch_signals()?;
    let (echo, lines) = bounded(ECHO_QUEUE);
    let (observers, echo) = arguments.observers.prepare(echo)?;
    let options = RunOptions {
        clock: match arguments.clock {
            ClockArgument::Real => ClockKind::Real,
            ClockArgument::Simulated => ClockKind::Simulated,
        },
        duration: arguments.duration,
        seed: arguments.seed,
        events: arguments.events.clone(),
        echo: Some(echo),
        libraries: libraries(&arguments.library_path),
        state: StateOptions {
            folder: arguments.state_path.clone(),
            // A container that goes on where another has died goes on from what that has left.
            fresh: arguments.fresh && supervised.as_ref().is_none_or(|it| it.restarts() == 0),
        },
        score: None,
        recording: arguments.observers.shown(arguments.recording.options()),
        supervised: supervised.clone(),
        network: network::of(&arguments.sources(), arguments.clock)?,
    };
    let started = System::start(applications, simulations, options);
    let system = started.map_err(|error| refused(&error))?;
    let mut watcher = Watcher::new(system.name(), lines, arguments.format == Format::Json);
    let server = listen(&system, &watcher);
    let observers = observers.start(&system, &watcher);
    let reason = loop {
        if stop_asked.load(Ordering::Acquire) {
            break "stopped";
        }
        if let Some(reason) = system.wait(REFRESH_PERIOD) {
            break reason;
        }
        watcher.refresh(&system);
    };
    if let Some(supervised) = supervised {
        supervised.stops();
    }
    drop((server, observers));
    let environment = Arc::clone(system.supervisor().environment());
    let (summary, log_error) = system.stop(reason);
    watcher.finish();
    if let Some(error) = log_error {
        return Err(unwritable(arguments.events.as_deref(), &error));
    }
    if let Some(path) = &arguments.picture {
        worlds::draw_all(path, &environment.worlds)?;
    }
    conclude(arguments, &summary)?;
    let recording = summary.recording.as_ref();
    match recording.and_then(|it| it.failure.clone()) {
        Some(text) => Err(Failed {
            code: exit_code::FILE,
            text,
        }),
        None => Ok(()),
    }
}

fn conclude(arguments: &RunArguments, summary: &Summary) -> Result<(), Failed> {
    let text = serde_json::to_string_pretty(summary)
        .map_err(|error| unwritable(arguments.summary.as_deref(), &error.into()))?
        + "\n";
    if let Some(path) = &arguments.summary {
        write(path, text.as_bytes())?;
    }
    if arguments.format == Format::Json {
        return output::write(None, &text);
    }
    let picture = arguments.picture.as_deref();
    // A closed pipe: whoever reads has seen enough.
    let _unread = report::print(&mut io::stdout().lock(), summary, picture);
    Ok(())
}

/// Warnings do not stop a run, but a person should see them.
pub(super) fn show(found: &[Problem]) {
    if !found.is_empty() {
        let _unread = writeln!(
            io::stderr(),
            "{}",
            problems::render(found, errors_on_terminal())
        );
    }
}

/// The first signal asks for a stop in order, the second ends the process at once.
fn watch_signals() -> Result<Arc<AtomicBool>, Failed> {
    let asked = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 130, Arc::clone(&asked))
            .and_then(|_id| signal_hook::flag::register(signal, Arc::clone(&asked)))
            .map_err(|error| Failed {
                code: exit_code::SYSTEM,
                text: format!(
                    "signals cannot be watched: {error}\n  help: see the limits of this user and \
                     machine"
                ),
            })?;
    }
    Ok(asked)
}

fn write(path: &Path, content: &[u8]) -> Result<(), Failed> {
    std::fs::write(path, content).map_err(|error| unwritable(Some(path), &error))
}

/// Whether a person watches.
fn on_terminal() -> bool {
    io::stdout().is_terminal()
}

fn errors_on_terminal() -> bool {
    io::stderr().is_terminal()
}
