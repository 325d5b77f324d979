//! What the thread that writes does: it puts data and events in the order of time, and makes JSON of
//! them.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use crossbeam::channel::Receiver;
use recording::Topic;
use serde::Serialize;

use super::diagnosis::Diagnosis;
use super::port_recorder::Track;
use super::record_file::{Entry, Source};
use super::sinks::Sinks;
use super::thread::{RecordingSummary, Shared};
use crate::component::Environment;
use crate::event_log::{Event, Line};
use crate::wake::Wake;

/// How often the rings are emptied where little comes: waking up costs hardly anything so.
const LONGEST_LOOK_PERIOD: Duration = Duration::from_millis(50);

/// How often where much comes, and at the beginning, when that is not known.
const SHORTEST_LOOK_PERIOD: Duration = Duration::from_millis(1);

/// A ring that is so full is emptied twice as often from then on; one of which half as much would
/// come in twice the time is not. There is room for a disk that takes three times as long once.
const BUSY_PERCENT: usize = 25;

/// What was written this long ago is in the file whatever happens to the process.
const FLUSH_PERIOD: Duration = Duration::from_secs(1);

/// Diagnostics come this often by the container's clock, as they do in ROS, and whenever the level
/// of a component changes.
const DIAGNOSTICS_PERIOD_NS: u64 = 1_000_000_000;

/// What the thread works with.
pub(super) struct Writing {
    environment: Arc<Environment>,
    tracks: Vec<Track>,
    events: Receiver<(u64, Event)>,
    next_event: Option<(u64, Event)>,
    sinks: Sinks,
    diagnosis: Diagnosis,
    diagnostics_due_ns: u64,
    messages: u64,
    said_dropped: bool,
}

/// What is next in the order of time; events come before data of the same time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Next {
    Event,
    Datum(usize),
}

impl Writing {
    /// With nothing written.
    pub(super) fn new(
        environment: Arc<Environment>,
        tracks: Vec<Track>,
        events: Receiver<(u64, Event)>,
        sinks: Sinks,
        diagnosis: Diagnosis,
    ) -> Self {
        Self {
            environment,
            tracks,
            events,
            next_event: None,
            sinks,
            diagnosis,
            diagnostics_due_ns: 0,
            messages: 0,
            said_dropped: false,
        }
    }

    /// Writes until it is asked to stop, and what has come until then.
    pub(super) fn run(mut self, shared: &Shared, wake: &Wake) -> RecordingSummary {
        let mut flushed = Instant::now();
        let mut period = SHORTEST_LOOK_PERIOD;
        loop {
            let fill = self.tracks.iter().map(Track::fill_percent).max();
            period = look_period(period, fill.unwrap_or(0));
            // Before the time is taken: what was recorded until it was asked to stop is written.
            let stopping = shared.stopping.load(Ordering::Acquire);
            let until_ns = match stopping {
                true => u64::MAX,
                false => self.environment.clock.now_ns(),
            };
            self.write_until(until_ns);
            if stopping {
                return self.finish();
            }
            if flushed.elapsed() >= FLUSH_PERIOD {
                self.flush();
                flushed = Instant::now();
            }
            wake.take();
            if !self.tracks.iter().any(Track::is_full) {
                wake.sleep(period);
            }
        }
    }

    /// Writes everything older than `until_ns`, in the order of time. In simulated time all of that is
    /// there when time has come so far, so the same run gives the same file. What has filled its ring
    /// is written in any case.
    fn write_until(&mut self, until_ns: u64) {
        while let Some((time_ns, next)) = self.next(until_ns) {
            self.diagnose_until(time_ns);
            match next {
                Next::Event => self.write_event(),
                Next::Datum(index) => self.write_datum(index),
            }
        }
        if until_ns < u64::MAX {
            self.diagnose_until(until_ns);
        }
    }

    fn next(&mut self, until_ns: u64) -> Option<(u64, Next)> {
        if self.next_event.is_none() {
            self.next_event = self.events.try_recv().ok();
        }
        let is_full = self.events.is_full();
        let event = self.next_event.as_ref();
        let event = event.map(|(time_ns, _)| (*time_ns, Next::Event, is_full));
        let data = self.tracks.iter_mut().enumerate();
        let data = data.filter_map(|(index, track)| {
            Some((track.next_ns()?, Next::Datum(index), track.is_full()))
        });
        let due = |(time_ns, _, is_full): &(u64, Next, bool)| *time_ns < until_ns || *is_full;
        let next = event.into_iter().chain(data).filter(due).min()?;
        Some((next.0, next.1))
    }

    fn write_datum(&mut self, index: usize) {
        let sinks = &mut self.sinks;
        self.tracks[index].take(|datum| {
            let entry = Entry {
                source: Source::Port(index),
                log_ns: datum.seen_ns,
                publish_ns: datum.written_ns,
                content: datum.bytes,
            };
            sinks.write(&entry);
        });
        self.messages += 1;
    }

    fn write_event(&mut self) {
        let Some((t_ns, event)) = self.next_event.take() else {
            return;
        };
        let changes = self.diagnosis.learn(&event);
        let line = Line { t_ns, event };
        self.write_topic(Topic::Events, t_ns, &line);
        match &line.event {
            Event::State {
                component,
                from,
                to,
                incarnation,
            } => {
                let state = serde_json::json!({
                    "component": component, "from": from, "to": to, "incarnation": incarnation,
                });
                self.write_topic(Topic::States, t_ns, &state);
            }
            Event::Verdict(verdict) => {
                self.write_topic(Topic::Verdicts, t_ns, verdict);
                self.sinks.judge(t_ns, verdict);
            }
            _ => {}
        }
        if changes {
            self.diagnose(t_ns);
        }
    }

    fn write_topic(&mut self, topic: Topic, time_ns: u64, message: &impl Serialize) {
        // Numbers, texts and lists of them: there is always JSON for that.
        let content = serde_json::to_vec(message).unwrap_or_default();
        let entry = Entry {
            source: Source::Topic(topic),
            log_ns: time_ns,
            publish_ns: time_ns,
            content: &content,
        };
        self.sinks.write(&entry);
        self.messages += 1;
    }

    /// Diagnostics that are due until then.
    fn diagnose_until(&mut self, time_ns: u64) {
        while self.diagnostics_due_ns <= time_ns {
            self.diagnose(self.diagnostics_due_ns);
            self.diagnostics_due_ns += DIAGNOSTICS_PERIOD_NS;
        }
    }

    fn diagnose(&mut self, time_ns: u64) {
        let dropped = self.dropped();
        let message = self.diagnosis.message(time_ns, self.messages, dropped);
        self.write_topic(Topic::Diagnostics, time_ns, &message);
    }

    fn dropped(&self) -> u64 {
        let tracks = self.tracks.iter();
        tracks.map(|it| it.dropped().load(Ordering::Relaxed)).sum()
    }

    fn flush(&mut self) {
        if let Some(failure) = self.sinks.flush() {
            self.notice(failure);
        }
        let dropped = self.dropped();
        if dropped > 0 && !self.said_dropped {
            self.said_dropped = true;
            self.notice(format!(
                "the recording is not complete: {dropped} data so far came faster than they could \
                 be written"
            ));
        }
    }

    /// In simulated time the event log would wait for this very thread; there it is said at the end.
    fn notice(&self, message: String) {
        let clock = &self.environment.clock;
        if !clock.is_simulated() {
            let event = Event::Notice { message };
            self.environment.events.record(clock.now_ns(), event);
        }
    }

    fn finish(self) -> RecordingSummary {
        self.sinks.finish()
    }
}

/// How long to sleep until the next look, after one that found the fullest ring so full.
fn look_period(period: Duration, fill_percent: usize) -> Duration {
    if fill_percent > BUSY_PERCENT {
        (period / 2).max(SHORTEST_LOOK_PERIOD)
    } else if 2 * fill_percent < BUSY_PERCENT {
        (period * 2).min(LONGEST_LOOK_PERIOD)
    } else {
        period
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_emptied_before_they_are_full() {
        // So much of the fullest ring comes in a millisecond.
        for (percent_in_ms, longest_ms) in [(0, 50), (1, 25), (6, 4), (30, 1), (90, 1)] {
            let mut period = SHORTEST_LOOK_PERIOD;
            for _ in 0..20 {
                let fill = percent_in_ms * period.as_millis() as usize;
                assert!(fill < 100, "{percent_in_ms}: {period:?}");
                period = look_period(period, fill);
            }
            assert!(
                period.as_millis() <= longest_ms,
                "{percent_in_ms}: {period:?}"
            );
        }
    }
}
