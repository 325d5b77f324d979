//! The view of a running application: a table that is redrawn on a terminal, plain lines else.

use std::io::{self, Write as _};
use std::sync::Arc;
use std::time::{Duration, Instant};

use container::event_log::Event;
use container::status::ComponentStatus;
use container::system::System;
use crossbeam::channel::Receiver;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use robot_simulation::RobotSummary;

use super::on_terminal;
use super::words::describe;

/// Shows what happens.
pub(super) struct Watcher {
    lines: Receiver<(u64, Event)>,
    table: Option<Table>,
    /// Standard output belongs to the result.
    aside: bool,
}

/// A line for the robot of each world, one for each component.
struct Table {
    lines: MultiProgress,
    robots: Vec<ProgressBar>,
    components: Vec<ProgressBar>,
    application: String,
    /// When cycles were last counted, and how many there were.
    counted: Option<(Instant, Vec<u64>)>,
    rates_hz: Vec<f64>,
}

/// Over how long rates are counted: at 10 Hz that is ten cycles, so the figure stands still.
const RATE_WINDOW: Duration = Duration::from_secs(1);

impl Watcher {
    /// `aside`: the lines go to standard error, and there is no table.
    pub(super) fn new(application: &str, lines: Receiver<(u64, Event)>, aside: bool) -> Self {
        let table = (on_terminal() && !aside).then(|| Table::new(application));
        Self {
            lines,
            table,
            aside,
        }
    }

    /// Shows what has happened since the last time.
    pub(super) fn refresh(&mut self, system: &System) {
        self.print_events();
        if let Some(table) = &mut self.table {
            table.refresh(system);
        }
    }

    /// Shows the rest and takes the table away.
    pub(super) fn finish(&mut self) {
        self.print_events();
        if let Some(table) = &self.table {
            // Without a terminal there is nothing to clear.
            let _no_terminal = table.lines.clear();
        }
    }

    fn print_events(&self) {
        while let Ok((t_ns, event)) = self.lines.try_recv() {
            let Some(text) = describe(&event) else {
                continue;
            };
            let seconds = std::time::Duration::from_nanos(t_ns).as_secs_f64();
            self.say(&format!("[{seconds:10.3}] {text}"));
        }
    }

    /// Prints a line.
    pub(super) fn say(&self, line: &str) {
        match &self.table {
            // A view that cannot be drawn is no reason to stop the robot.
            Some(table) => drop(table.lines.println(line)),
            None if self.aside => drop(writeln!(io::stderr(), "{line}")),
            None => drop(writeln!(io::stdout(), "{line}")),
        }
    }
}

impl Table {
    fn new(application: &str) -> Self {
        let lines = MultiProgress::new();
        Self {
            lines,
            robots: Vec::new(),
            components: Vec::new(),
            application: application.to_owned(),
            counted: None,
            rates_hz: Vec::new(),
        }
    }

    fn refresh(&mut self, system: &System) {
        let time_s = system.now().as_secs_f64();
        let mut robots = robot_lines(system, &self.application, time_s);
        if robots.is_empty() {
            robots.push(format!("{} {time_s:8.2} s", self.application));
        }
        while self.robots.len() < robots.len() {
            self.robots.push(self.lines.add(line()));
        }
        for (bar, text) in self.robots.iter().zip(robots) {
            bar.set_message(text);
        }
        let statuses = system.statuses();
        while self.components.len() < statuses.len() {
            self.components.push(self.lines.add(line()));
        }
        self.count(statuses);
        for (index, (status, bar)) in statuses.iter().zip(&self.components).enumerate() {
            let rate_hz = self.rates_hz.get(index).copied();
            bar.set_message(component_line(status, rate_hz));
        }
    }

    fn count(&mut self, statuses: &[Arc<ComponentStatus>]) {
        let now = Instant::now();
        let cycles: Vec<u64> = statuses.iter().map(|status| status.cycles()).collect();
        let Some((then, before)) = &self.counted else {
            self.counted = Some((now, cycles));
            return;
        };
        let passed = now.duration_since(*then);
        if passed >= RATE_WINDOW {
            let rate = |(now, before): (&u64, &u64)| (now - before) as f64 / passed.as_secs_f64();
            self.rates_hz = cycles.iter().zip(before).map(rate).collect();
            self.counted = Some((now, cycles));
        }
    }
}

fn robot_lines(system: &System, all: &str, time_s: f64) -> Vec<String> {
    let worlds = system.worlds();
    let line = |(name, robot): (String, RobotSummary)| {
        let name = match worlds.are_several() {
            true => &name,
            false => all,
        };
        format!(
            "{name} {time_s:8.2} s   target {:5.2} m away   path {:5.2} m   collisions {}   clearance {:4.2} m",
            robot.distance_to_target_m,
            robot.path_length_m,
            robot.collisions,
            robot.least_clearance_m
        )
    };
    worlds.summaries().map(line).collect()
}

fn component_line(status: &ComponentStatus, rate_hz: Option<f64>) -> String {
    let rate = rate_hz.map_or_else(String::new, |rate_hz| format!("{rate_hz:8.1} Hz"));
    let fault = status.last_fault().unwrap_or_default();
    format!(
        "  {:22} {:9} {:>9} cycles {rate:11} {:>4} overruns {:>4} faults  {fault}",
        status.name,
        status.state().name(),
        status.cycles(),
        status.overruns(),
        status.faults()
    )
}

/// A line of text that is redrawn in place.
fn line() -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_msg}");
    let bar = ProgressBar::new_spinner();
    match style {
        Ok(style) => bar.with_style(style),
        Err(_constant_template) => bar,
    }
}
