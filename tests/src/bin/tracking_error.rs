//! Draws figure 12 of the ReFrESH paper from a run: the tracker's error over time, the error at which the
//! task is not done well enough, smoke, and when the task was done in another way.
//!
//! `tracking_error RUN.mcap EVENTS.jsonl FIGURE.svg`
#![forbid(unsafe_code)]

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
/// When smoke blows in, in the world `servoing_arena.xml`.
const SMOKE_S: f64 = 4.4;
/// The error above which P_F does not exceed 0.2 in the task `visual_servoing_one_robot.xml`.
const MOST_ERROR: f64 = 38.3;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [run, events, figure] = &arguments[..] else {
        eprintln!("usage: tracking_error RUN.mcap EVENTS.jsonl FIGURE.svg");
        return ExitCode::FAILURE;
    };
    let drawn = points(Path::new(run)).and_then(|points| {
        let changes = changes(Path::new(events))?;
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

/// Seconds and errors of all tracked pictures.
fn points(run: &Path) -> Result<Vec<(f64, f64)>, String> {
    let mut points = Vec::new();
    for message in recording::read(run).map_err(|error| error.to_string())? {
        let message = message.map_err(|error| error.to_string())?;
        if message.topic() == "/ssd_tracker/target" {
            let time = message.value["time"].as_f64().unwrap_or_default();
            let error = message.value["matching_error"].as_f64();
            points.push((time * 1e-9, error.unwrap_or_default()));
        }
    }
    match points.is_empty() {
        true => Err("the recording has no /ssd_tracker/target".to_owned()),
        false => Ok(points),
    }
}

/// When the task was done in another way, in seconds.
fn changes(events: &Path) -> Result<Vec<f64>, String> {
    let text = std::fs::read_to_string(events).map_err(|error| error.to_string())?;
    let events = text
        .lines()
        .filter_map(|line| serde_json::from_str(line).ok());
    let changes = events
        .filter(|event: &Value| event["event"] == "adaptation" && event["outcome"] == "changed");
    Ok(changes
        .filter_map(|event| Some(event["t_ns"].as_f64()? * 1e-9))
        .collect())
}

fn draw(points: &[(f64, f64)], changes: &[f64]) -> String {
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
    figure.lines(changes);
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

    fn lines(&mut self, changes: &[f64]) {
        let (end_s, top) = (self.end_s, self.top);
        self.line((0.0, 0.0), (end_s, 0.0), "stroke=\"#888\"");
        self.line((0.0, 0.0), (0.0, top), "stroke=\"#888\"");
        let dashed = "stroke=\"#c33\" stroke-dasharray=\"6 4\"";
        self.line((0.0, MOST_ERROR), (end_s, MOST_ERROR), dashed);
        self.line((SMOKE_S, 0.0), (SMOKE_S, top), "stroke=\"#aaa\"");
        for change in changes {
            self.line((*change, 0.0), (*change, top), "stroke=\"#393\"");
        }
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

    fn labels(&mut self, changes: &[f64]) {
        let (end_s, top) = (self.end_s, self.top);
        let smoke = format!("smoke blows in, {SMOKE_S} s");
        self.words((SMOKE_S, top), (-6.0, 10.0), "end", &smoke);
        for change in changes {
            let text = format!("done with the software dehazer, {change:.3} s");
            self.words((*change, top), (6.0, 10.0), "start", &text);
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
