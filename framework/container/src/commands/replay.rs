//! `steadfast replay`: a recording goes once more through an application's ports and rules.

mod text;

use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use clap::{Args, ValueEnum};
use container::recording::{RecordingOptions, RecordingSummary};
use container::replay::{RecordedVerdict, Score};
use container::system::{Application, ClockKind, RunOptions, StateOptions, System};
use fault_manager::{FaultState, Verdict};
use serde::Serialize;

use super::run::applications::{Sources, load};
use super::run::{Failed, exit_code, libraries, refused};

/// How often it is looked whether the recording is over.
const LOOK_PERIOD: Duration = Duration::from_millis(100);

/// What `steadfast replay` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::REPLAY)]
pub struct ReplayArguments {
    /// What `steadfast run --record` or `--black-box` wrote
    #[arg(value_name = "FILE.mcap")]
    recording: PathBuf,
    /// The application profile that was run then
    #[arg(value_name = "APPLICATION.xml")]
    application: PathBuf,
    /// Fault rules to be tried; may be given several times
    #[arg(long, value_name = "FILE.xml")]
    rules: Vec<PathBuf>,
    /// Run this component itself, with the recorded data at its inputs; all others are played
    #[arg(long, value_name = "NAME")]
    component: Option<String>,
    /// Record the replay
    #[arg(long, value_name = "FILE.mcap")]
    output: Option<PathBuf>,
    /// Also look for component libraries in this folder; may be given several times
    #[arg(long = "library-path", value_name = "FOLDER")]
    library_path: Vec<PathBuf>,
    /// Also look for referenced profiles in this folder; may be given several times
    #[arg(long = "search-path", value_name = "FOLDER")]
    search_path: Vec<PathBuf>,
    /// How the result is written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// How the result is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people
    Text,
    /// For programs: one JSON object
    Json,
}

/// What a replay came to.
#[derive(Debug, Serialize)]
struct Replayed {
    recording: PathBuf,
    /// When the recording begins and ends, by the container's clock at that time.
    from_s: f64,
    to_s: f64,
    /// Data of ports.
    data: u64,
    /// Whether the recording ends in its middle.
    was_cut: bool,
    /// Outputs of which the recording has nothing.
    missing: Vec<String>,
    /// Topics that the application does not have.
    ignored: Vec<String>,
    /// What these rules confirm.
    faults: Vec<Verdict>,
    /// What was confirmed when it was recorded.
    recorded_faults: Vec<RecordedVerdict>,
    /// The recording of the replay.
    #[serde(skip_serializing_if = "Option::is_none")]
    output: Option<RecordingSummary>,
}

/// Replays a recording.
pub fn run(arguments: &ReplayArguments) -> ExitCode {
    let replayed = replay(arguments);
    let code = match replayed.and_then(|replayed| print(arguments.format, &replayed)) {
        Ok(()) => exit_code::ENDED,
        Err(failed) => {
            // If nobody reads the text the exit code still tells.
            let _unread = writeln!(io::stderr(), "{}", failed.text.trim_end());
            failed.code
        }
    };
    ExitCode::from(code)
}

fn replay(arguments: &ReplayArguments) -> Result<Replayed, Failed> {
    let unreadable = |text: String| Failed {
        code: exit_code::FILE,
        text,
    };
    let score = Score::open(&arguments.recording, arguments.component.clone());
    let score = Arc::new(score.map_err(|error| unreadable(error.to_string()))?);
    let application = application(arguments)?;
    let options = RunOptions {
        clock: ClockKind::Simulated,
        duration: None,
        seed: 0,
        events: None,
        echo: None,
        libraries: libraries(&arguments.library_path),
        state: StateOptions::default(),
        score: Some(Arc::clone(&score)),
        recording: RecordingOptions {
            file: arguments.output.clone(),
            // What was recorded is recorded again.
            most_bytes_per_datum: Some(usize::MAX),
            ..RecordingOptions::default()
        },
        supervised: None,
        network: None,
    };
    let system =
        System::start(vec![application], Vec::new(), options).map_err(|it| refused(&it))?;
    let progress = text::Progress::new(&score);
    while system.wait(LOOK_PERIOD).is_none() {
        progress.refresh(&score);
    }
    progress.finish();
    let verdicts = system.supervisor().verdicts().into_iter();
    let faults = verdicts.filter(|it| it.state != FaultState::Prefailed);
    let faults = faults.collect();
    let (summary, _no_event_file) = system.stop("replayed");
    if let Some(failure) = score.failure() {
        return Err(unreadable(failure));
    }
    if let Some(failure) = summary.recording.as_ref().and_then(|it| it.failure.clone()) {
        return Err(unreadable(failure));
    }
    let (missing, ignored) = score.gaps();
    let seconds = |time_ns: u64| Duration::from_nanos(time_ns).as_secs_f64();
    Ok(Replayed {
        recording: arguments.recording.clone(),
        from_s: seconds(score.first_ns()),
        to_s: seconds(score.last_ns()),
        data: score.data(),
        was_cut: score.was_cut(),
        missing,
        ignored,
        faults,
        recorded_faults: score.verdicts(),
        output: summary.recording,
    })
}

fn application(arguments: &ReplayArguments) -> Result<Application, Failed> {
    let sources = Sources {
        applications: std::slice::from_ref(&arguments.application),
        rules: &arguments.rules,
        inject: &[],
        search_path: &arguments.search_path,
    };
    // One file, one application.
    load(&sources)?.pop().ok_or_else(|| Failed {
        code: exit_code::PROFILE,
        text: format!("{} holds no application", arguments.application.display()),
    })
}

fn print(format: Format, replayed: &Replayed) -> Result<(), Failed> {
    let mut output = io::stdout().lock();
    let printed = match format {
        Format::Text => text::print(&mut output, replayed),
        Format::Json => serde_json::to_writer_pretty(&mut output, replayed)
            .map_err(io::Error::from)
            .and_then(|()| writeln!(output)),
    };
    match printed {
        // A closed pipe: whoever reads has seen enough.
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failed {
            code: exit_code::FILE,
            text: format!("the result cannot be written: {error}"),
        }),
        _ => Ok(()),
    }
}
