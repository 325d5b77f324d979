//! The data of a recording, once more, a hundred times as fast.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use container::adaptation::AdaptationRequests;
use container::assembly::assemble;
use container::clock::Clock;
use container::component::Environment;
use container::event_log::EventLog;
use container::recording::{PortRecorder, Recorder, RecordingOptions};
use container::schedule::BusyTime;
use container::world::Worlds;
use recording::{Layout, read};
use serde::Serialize;
use serde_json::Value;
use system_model::data_type::DataType;
use system_model::rules::FaultRules;

use super::RecordingArguments;
use crate::commands::run::applications::{Sources, load};
use crate::commands::run::libraries;

/// So many times as fast.
const FACTOR: u32 = 100;

/// Data come in portions of a millisecond: less than what a thread sleeps at least, more than many.
const PORTION: Duration = Duration::from_millis(1);

/// So many different data of each port are sent in turns.
const DIFFERENT_DATA: usize = 16;

/// What became of the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Flood {
    /// Data of the application in a second.
    pub(super) usual_hz: f64,
    /// Their bytes, as components write them.
    pub(super) usual_bytes_per_s: f64,
    /// Data that were sent, at a hundred times that rate.
    pub(super) sent: u64,
    /// For how long, in seconds.
    pub(super) duration_s: f64,
    /// Data that are in the file, by reading it.
    pub(super) recorded: u64,
    /// Data that the recording says are not.
    pub(super) dropped: u64,
    /// Bytes of the file.
    pub(super) file_bytes: u64,
}

/// One port of the application.
struct Port {
    data_type: DataType,
    /// In the recording.
    count: u64,
    data: Vec<Vec<u8>>,
}

/// Sends what `file` holds a hundred times as fast, for so long.
pub(super) fn run(
    arguments: &RecordingArguments,
    file: &Path,
    folder: &Path,
    duration: Duration,
) -> io::Result<Flood> {
    let environment = environment()?;
    let mut ports = ports(arguments, &environment)?;
    let recorded_s = fill(&mut ports, file)?;
    ports.retain(|_, port| port.count > 0);
    let target = folder.join("flood.mcap");
    let options = RecordingOptions {
        file: Some(target.clone()),
        ..RecordingOptions::default()
    };
    let (mut recorder, _events) = Recorder::new(options, false);
    let mut senders = Vec::new();
    for ((component, name), port) in &ports {
        let recorder = recorder.port(component, name, "output", &port.data_type);
        senders.extend(recorder.map(|recorder| (recorder, port)));
    }
    let recording = recorder
        .start(&environment, std::iter::empty(), Vec::new())
        .map_err(io::Error::other)?;
    let (sent, duration_s) = send(&environment, &mut senders, recorded_s, duration);
    let summary = recording.finish();
    if let Some(failure) = summary.failure {
        return Err(io::Error::other(failure));
    }
    let bytes = |port: &Port| port.count as f64 * port.data_type.size as f64;
    Ok(Flood {
        usual_hz: ports.values().map(|it| it.count as f64).sum::<f64>() / recorded_s,
        usual_bytes_per_s: ports.values().map(bytes).sum::<f64>() / recorded_s,
        sent,
        duration_s,
        recorded: recorded(&target)?,
        dropped: summary.dropped,
        file_bytes: std::fs::metadata(&target)?.len(),
    })
}

fn environment() -> io::Result<Arc<Environment>> {
    Ok(Arc::new(Environment {
        clock: Clock::real(),
        events: EventLog::nowhere(),
        observations: container::supervision::Observations::default(),
        injections: container::injection::Injections::default(),
        scenes: container::supervision::Scenes::default(),
        worlds: Worlds::default(),
        score: None,
        adaptation_requests: AdaptationRequests::default(),
        busy: BusyTime::default(),
    }))
}

/// The data outputs of the application, by component and name. Nothing of it runs.
fn ports(
    arguments: &RecordingArguments,
    environment: &Arc<Environment>,
) -> io::Result<BTreeMap<(String, String), Port>> {
    let sources = Sources {
        applications: std::slice::from_ref(&arguments.application),
        rules: &[],
        inject: &[],
        search_path: &[],
    };
    let applications = load(&sources).map_err(|failed| io::Error::other(failed.text))?;
    let mut ports = BTreeMap::new();
    for application in &applications {
        let specification = &application.specification;
        let libraries = libraries(&arguments.library_path);
        let rules = FaultRules::default();
        let assembly = assemble(specification, &rules, &libraries, environment);
        let assembly = assembly.map_err(|problems| {
            let texts: Vec<String> = problems.iter().map(ToString::to_string).collect();
            io::Error::other(texts.join("\n"))
        })?;
        for (component, described) in specification.components.iter().zip(assembly.interfaces) {
            for port in described {
                if let Some(data_type) = port.data_type {
                    let unused = Port {
                        data_type,
                        count: 0,
                        data: Vec::new(),
                    };
                    ports.insert((component.name.clone(), port.name), unused);
                }
            }
        }
    }
    Ok(ports)
}

/// Counts the data of a recording, and takes some of each port; how long it is, in seconds.
fn fill(ports: &mut BTreeMap<(String, String), Port>, file: &Path) -> io::Result<f64> {
    let mut layouts = BTreeMap::new();
    let (mut first_ns, mut last_ns) = (u64::MAX, 0);
    for message in read(file).map_err(io::Error::other)? {
        let message = message.map_err(io::Error::other)?;
        let of = |key: &str| {
            message
                .channel
                .metadata
                .get(key)
                .cloned()
                .unwrap_or_default()
        };
        let key = (of("component"), of("port"));
        if of("direction") != "output" {
            continue;
        }
        let Some(port) = ports.get_mut(&key) else {
            continue;
        };
        (first_ns, last_ns) = (first_ns.min(message.t_ns), last_ns.max(message.t_ns));
        port.count += 1;
        if port.data.len() < DIFFERENT_DATA {
            let layout = layouts
                .entry(key)
                .or_insert_with(|| Layout::new(&port.data_type));
            port.data.push(datum(layout, &message.value)?);
        }
    }
    if last_ns <= first_ns {
        return Err(io::Error::other("the recording holds no data"));
    }
    Ok(Duration::from_nanos(last_ns - first_ns).as_secs_f64())
}

fn datum(layout: &Layout, message: &Value) -> io::Result<Vec<u8>> {
    let mut datum = vec![0; layout.data_type().size];
    layout
        .decode(message, &mut datum)
        .map_err(io::Error::other)?;
    Ok(datum)
}

/// Sends data in portions; how many, and for how long it did, in seconds.
fn send(
    environment: &Environment,
    senders: &mut [(PortRecorder, &Port)],
    recorded_s: f64,
    duration: Duration,
) -> (u64, f64) {
    let begin = Instant::now();
    let mut sent = vec![0u64; senders.len()];
    while begin.elapsed() < duration {
        let factor = begin.elapsed().as_secs_f64() / recorded_s * f64::from(FACTOR);
        for ((recorder, port), sent) in senders.iter_mut().zip(&mut sent) {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // counts of seconds
            let due = (port.count as f64 * factor) as u64;
            while *sent < due {
                let datum = &port.data[*sent as usize % port.data.len()];
                let now_ns = environment.clock.now_ns();
                recorder.record(now_ns, now_ns, datum);
                *sent += 1;
            }
        }
        std::thread::sleep(PORTION);
    }
    (sent.iter().sum(), begin.elapsed().as_secs_f64())
}

/// Data in a file, by reading it.
fn recorded(file: &Path) -> io::Result<u64> {
    let mut count = 0;
    for message in read(file).map_err(io::Error::other)? {
        let message = message.map_err(io::Error::other)?;
        count += u64::from(message.channel.metadata.contains_key("port"));
    }
    Ok(count)
}
