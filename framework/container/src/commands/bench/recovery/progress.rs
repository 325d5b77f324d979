//! How far the study is, for a person who waits.

use std::io::{self, IsTerminal as _};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Often enough that a clock runs.
const TICK: Duration = Duration::from_millis(500);

/// A bar on standard error; none where that is no terminal.
pub(super) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// At its start, with so many steps before it.
    pub(super) fn new(steps: usize) -> Self {
        if !io::stderr().is_terminal() {
            return Self {
                bar: ProgressBar::hidden(),
            };
        }
        let bar = ProgressBar::new(steps.try_into().unwrap_or(u64::MAX));
        let style = ProgressStyle::with_template("{elapsed_precise} [{wide_bar}] {eta} {msg}");
        let bar = match style {
            Ok(style) => bar.with_style(style),
            Err(_constant_template) => bar,
        };
        bar.enable_steady_tick(TICK);
        Self { bar }
    }

    /// What is measured now.
    pub(super) fn show(&self, what: &str) {
        self.bar.set_message(what.to_owned());
    }

    /// One step is done.
    pub(super) fn advance(&self) {
        self.bar.inc(1);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
