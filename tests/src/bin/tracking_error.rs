//! Draws figures 12 and 14 of the ReFrESH paper from a run with one robot or with two: the tracker's error
//! over time, the error at which the task is not done well enough, smoke, and how the task came to be
//! done in another way.
//!
//! `tracking_error RUN.mcap EVENTS.jsonl FIGURE.svg`
#![forbid(unsafe_code)]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::process::ExitCode;

use serde_json::Value;

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 300.0;
/// Room for axes and words.
const MARGIN: f64 = 48.0;
/// The least error that has to fit, in grey values.
const LEAST_TOP: f64 = 60.0;
/// What the tracker writes; behind the application's name where there are several.
const TOPIC: &str = "/ssd_tracker/target";
/// When smoke blows in, in the worlds of the tasks.
const SMOKE_S: f64 = 4.4;
/// The error above which P_F does not exceed 0.2 in both tasks of visual servoing.
const MOST_ERROR: f64 = 38.3;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [run, events, figure] = &arguments[..] else {
        eprintln!("usage: tracking_error RUN.mcap EVENTS.jsonl FIGURE.svg");
        return ExitCode::FAILURE;
    };
    let drawn = points(Path::new(run)).and_then(|points| {
        let changes = changes(Path::new(events), &points)?;
        std::fs::write(figure, draw(&points, &changes)).map_err(|error| error.to_string())
    });
    match drawn {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("tracking_error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The task was done in another way; times in seconds.
struct Change {
    /// When the first picture was taken of which the error was too large.
    crossing_s: f64,
    /// When the other way had been chosen.
    decided_s: f64,
    /// When it was known to do.
    changed_s: f64,
    /// The components of it that not every way has.
    with: String,
}

/// Seconds and errors of all pictures that the first robot has tracked.
fn points(run: &Path) -> Result<Vec<(f64, f64)>, String> {
    let mut by_topic: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    for message in recording::read(run).map_err(|error| error.to_string())? {
        let message = message.map_err(|error| error.to_string())?;
        if message.topic().ends_with(TOPIC) {
            let time = message.value["time"].as_f64().unwrap_or_default();
            let error = message.value["matching_error"].as_f64();
            let points = by_topic.entry(message.topic().to_owned()).or_default();
            points.push((time * 1e-9, error.unwrap_or_default()));
        }
    }
    let first = by_topic.into_values().next();
    first.ok_or_else(|| format!("the recording has no topic that ends with {TOPIC}"))
}

/// How the task came to be done in another way.
fn changes(events: &Path, points: &[(f64, f64)]) -> Result<Vec<Change>, String> {
    let text = std::fs::read_to_string(events).map_err(|error| error.to_string())?;
    let events = text
        .lines()
        .filter_map(|line| serde_json::from_str(line).ok());
    let changes = events
        .filter(|event: &Value| event["event"] == "adaptation" && event["outcome"] == "changed");
    let mut last_s = 0.0;
    let change = |event: Value| {
        let changed_s = event["t_ns"].as_f64()? * 1e-9;
        let took_us = event["phases"]["reconfiguration_us"].as_f64()?;
        let began_s = std::mem::replace(&mut last_s, changed_s);
        let mut since = points.iter().filter(|(time_s, _)| *time_s > began_s);
        let (crossing_s, _) = since.find(|(_, error)| *error > MOST_ERROR)?;
        Some(Change {
            crossing_s: crossing_s.min(changed_s),
            decided_s: changed_s - took_us * 1e-6,
            changed_s,
            with: what_differs(&event),
        })
    };
    Ok(changes.filter_map(change).collect())
}

/// Components of the chosen candidate that are not in every candidate, whichever robot has them.
fn what_differs(event: &Value) -> String {
    let components = |candidate: &Value| -> Vec<String> {
        let listed = candidate["components"].as_array().into_iter().flatten();
        listed
            .filter_map(|it| Some(it.as_str()?.to_owned()))
            .collect()
    };
    let name = |component: &str| component.split_once(':').map(|(_, name)| name.to_owned());
    let all: Vec<Vec<String>> = (event["candidates"].as_array().into_iter().flatten())
        .map(components)
        .collect();
    let number = event["chosen"]
        .as_u64()
        .and_then(|it| usize::try_from(it).ok());
    let chosen = number.and_then(|number| all.get(number.checked_sub(1)?));
    let differs = |component: &&String| {
        let has = |candidate: &Vec<String>| candidate.iter().any(|it| name(it) == name(component));
        !all.iter().all(has)
    };
    let differing = chosen.into_iter().flatten().filter(differs).cloned();
    differing.collect::<Vec<_>>().join(", ")
}

fn draw(points: &[(f64, f64)], changes: &[Change]) -> String {
    let end_s = points.last().map_or(1.0, |(time_s, _)| time_s.ceil());
    let largest = points.iter().map(|(_, error)| *error);
    let mut figure = Figure {
        end_s,
        top: largest.fold(LEAST_TOP, f64::max),
        svg: format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
             font-family=\"sans-serif\" font-size=\"12\">\n\
             <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
        ),
    };
    figure.spans(changes);
    figure.lines();
    figure.curve(points);
    figure.labels(changes);
    figure.svg + "</svg>\n"
}

struct Figure {
    end_s: f64,
    /// The largest error that fits.
    top: f64,
    svg: String,
}

impl Figure {
    fn at(&self, time_s: f64, error: f64) -> (f64, f64) {
        let x = MARGIN + time_s / self.end_s * (WIDTH - 2.0 * MARGIN);
        (
            x,
            HEIGHT - MARGIN - error / self.top * (HEIGHT - 2.0 * MARGIN),
        )
    }

    fn line(&mut self, from: (f64, f64), to: (f64, f64), style: &str) {
        let ((x1, y1), (x2, y2)) = (self.at(from.0, from.1), self.at(to.0, to.1));
        // Writing to memory does not fail.
        let _infallible = writeln!(
            self.svg,
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>"
        );
    }

    /// Words beside a point, `beside` pixels to the right and down.
    fn words(&mut self, point: (f64, f64), beside: (f64, f64), anchor: &str, text: &str) {
        let (x, y) = self.at(point.0, point.1);
        let (x, y) = (x + beside.0, y + beside.1);
        let _infallible = writeln!(
            self.svg,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"
        );
    }

    /// From the error that is too large until it is known that the other way will do.
    fn spans(&mut self, changes: &[Change]) {
        let top = self.top;
        for change in changes {
            let (left, upper) = self.at(change.crossing_s, top);
            let (right, lower) = self.at(change.changed_s, 0.0);
            let (width, height) = (right - left, lower - upper);
            let _infallible = writeln!(
                self.svg,
                "<rect x=\"{left:.1}\" y=\"{upper:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" \
                 fill=\"#dfd\"/>"
            );
            let dotted = "stroke=\"#393\" stroke-dasharray=\"2 3\"";
            self.line((change.crossing_s, 0.0), (change.crossing_s, top), dotted);
            self.line((change.decided_s, 0.0), (change.decided_s, top), dotted);
            let changed = (change.changed_s, top);
            self.line((change.changed_s, 0.0), changed, "stroke=\"#393\"");
        }
    }

    fn lines(&mut self) {
        let (end_s, top) = (self.end_s, self.top);
        self.line((0.0, 0.0), (end_s, 0.0), "stroke=\"#888\"");
        self.line((0.0, 0.0), (0.0, top), "stroke=\"#888\"");
        let dashed = "stroke=\"#c33\" stroke-dasharray=\"6 4\"";
        self.line((0.0, MOST_ERROR), (end_s, MOST_ERROR), dashed);
        self.line((SMOKE_S, 0.0), (SMOKE_S, top), "stroke=\"#aaa\"");
    }

    fn curve(&mut self, points: &[(f64, f64)]) {
        let corners = points.iter().map(|(time_s, error)| {
            let (x, y) = self.at(*time_s, *error);
            format!("{x:.1},{y:.1}")
        });
        let corners: Vec<String> = corners.collect();
        let _infallible = writeln!(
            self.svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"#236\" stroke-width=\"1.5\"/>",
            corners.join(" ")
        );
    }

    fn labels(&mut self, changes: &[Change]) {
        let (end_s, top) = (self.end_s, self.top);
        let smoke = format!("smoke blows in, {SMOKE_S} s");
        self.words((SMOKE_S, top), (-6.0, 10.0), "end", &smoke);
        for change in changes {
            let texts = [
                format!("not good enough, {:.3} s", change.crossing_s),
                format!("decided, {:.3} s", change.decided_s),
                format!("done with {}, {:.3} s", change.with, change.changed_s),
            ];
            for (down, text) in [10.0, 25.0, 40.0].into_iter().zip(&texts) {
                self.words((change.changed_s, top), (6.0, down), "start", text);
            }
        }
        let threshold = "not good enough above";
        self.words((0.0, MOST_ERROR), (6.0, -6.0), "start", threshold);
        self.words((end_s, 0.0), (0.0, 30.0), "end", "time in seconds");
        let axis = "tracking error in grey values";
        self.words((0.0, top), (0.0, -10.0), "start", axis);
        let mut second = 0.0;
        while second <= end_s {
            let text = format!("{second:.0}");
            self.words((second, 0.0), (0.0, 16.0), "middle", &text);
            second += 1.0;
        }
        for error in [0.0, 20.0, 40.0, 60.0] {
            let text = format!("{error:.0}");
            self.words((0.0, error), (-6.0, 4.0), "end", &text);
        }
    }
}
