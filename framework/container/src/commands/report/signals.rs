//! What a recording has of the evidence of faults, and of the robot's way. Data come one after the
//! other and are kept only where they are wanted, and not without bound.

use std::collections::HashMap;

use serde_json::Value;

use super::amounts::read;
use super::evidence::{Wanted, WantedKind, evidence};
use super::model::{Fault, FaultNumber, Run, Signal};

/// How much is shown before the first symptom and behind the end of a fault.
const ROOM_NS: u64 = 1_000_000_000;

/// The longest time that is shown of a signal: below that single data are still told apart.
const LONGEST_NS: u64 = 8_000_000_000;

/// Faults of a run whose signals are shown: more plots than this make a page that opens slowly.
const MOST_SIGNALS: usize = 200;

/// Data that are kept of one signal: those of 8 s at a kilohertz.
const MOST_SAMPLES: usize = 8_192;

/// Poses that are kept of a way: more than a picture has points.
const MOST_POSES: usize = 4_096;

/// A signal that is wanted around one fault.
#[derive(Debug)]
struct Request {
    fault: FaultNumber,
    wanted: Wanted,
    window_ns: (u64, u64),
    /// When the newest datum came, for its age.
    newest_ns: Option<u64>,
    signal: Signal,
}

/// Keeps what is wanted.
#[derive(Debug)]
pub(super) struct Collector {
    requests: Vec<Request>,
    by_topic: HashMap<String, Vec<usize>>,
    /// The topic of the way, and the way.
    path_topic: String,
    path: Vec<(u64, [f64; 2])>,
    /// Every so many poses one is kept.
    stride: usize,
    poses: usize,
}

impl Collector {
    /// Of the evidence of a run's faults, and of the way that this topic tells (empty for none).
    pub(super) fn new(run: &Run, path_topic: &str) -> Self {
        let requests = run.faults.iter().filter_map(|(number, fault)| {
            let wanted = evidence(&fault.verdict).wanted?;
            Some(Request {
                fault: *number,
                signal: Signal {
                    name: name(&wanted),
                    ..Signal::default()
                },
                wanted,
                window_ns: window_ns(fault),
                newest_ns: None,
            })
        });
        let requests: Vec<Request> = requests.take(MOST_SIGNALS).collect();
        let mut by_topic: HashMap<String, Vec<usize>> = HashMap::new();
        for (index, request) in requests.iter().enumerate() {
            let topic = request.wanted.topic.clone();
            by_topic.entry(topic).or_default().push(index);
        }
        Self {
            requests,
            by_topic,
            path_topic: path_topic.to_owned(),
            path: Vec::new(),
            stride: 1,
            poses: 0,
        }
    }

    /// Whether anything of this topic is wanted.
    pub(super) fn wants(&self, topic: &str) -> bool {
        topic == self.path_topic || self.by_topic.contains_key(topic)
    }

    /// Takes what is wanted of a datum.
    pub(super) fn take(&mut self, topic: &str, t_ns: u64, datum: &Value) {
        if topic == self.path_topic {
            self.take_pose(t_ns, datum);
        }
        for index in self.by_topic.get(topic).into_iter().flatten() {
            let request = &mut self.requests[*index];
            match request.wanted.kind {
                WantedKind::Value => request.take_value(t_ns, datum),
                WantedKind::Age => request.take_age(t_ns),
            }
        }
    }

    /// Hands over what was kept.
    pub(super) fn finish(self, run: &mut Run) {
        for mut request in self.requests {
            request.age_until_the_end();
            let fault = run.faults.get_mut(&request.fault);
            if let Some(fault) = fault.filter(|_| !request.signal.samples.is_empty()) {
                fault.signal = Some(request.signal);
            }
        }
        if run.path.is_empty() {
            run.path = self.path;
            run.path_topic = self.path_topic;
        }
    }

    fn take_pose(&mut self, t_ns: u64, datum: &Value) {
        let Some(place) = pose(datum) else {
            return;
        };
        if self.poses.is_multiple_of(self.stride) {
            self.path.push((t_ns, place));
        }
        self.poses += 1;
        if self.path.len() >= MOST_POSES {
            let mut number = 0;
            self.path.retain(|_| {
                number += 1;
                number % 2 == 1
            });
            self.stride *= 2;
        }
    }
}

impl Request {
    fn take_value(&mut self, t_ns: u64, datum: &Value) {
        let (from_ns, to_ns) = self.window_ns;
        if (from_ns..=to_ns).contains(&t_ns) {
            let value = at(datum, &self.wanted.field);
            self.keep(t_ns, value.and_then(read).unwrap_or(f64::NAN));
        }
    }

    /// The age grows until a datum comes, and begins anew with it.
    fn take_age(&mut self, t_ns: u64) {
        let (from_ns, to_ns) = self.window_ns;
        if (from_ns..=to_ns).contains(&t_ns) {
            if let Some(newest_ns) = self.newest_ns {
                self.keep(t_ns, milliseconds(t_ns.saturating_sub(newest_ns)));
            }
            self.keep(t_ns, 0.0);
        }
        if t_ns <= to_ns {
            self.newest_ns = Some(t_ns);
        }
    }

    fn age_until_the_end(&mut self) {
        let end_ns = self.window_ns.1;
        let newest_ns = self.newest_ns.filter(|it| *it < end_ns);
        if let (WantedKind::Age, Some(newest_ns)) = (self.wanted.kind, newest_ns) {
            self.keep(end_ns, milliseconds(end_ns - newest_ns));
        }
    }

    fn keep(&mut self, t_ns: u64, value: f64) {
        match self.signal.samples.len() < MOST_SAMPLES {
            true => self.signal.samples.push((t_ns, value)),
            false => self.signal.left_out += 1,
        }
    }
}

/// The place of a robot, if a datum tells one: numbers `x` and `y` in metres.
pub(super) fn pose(datum: &Value) -> Option<[f64; 2]> {
    let place = [datum.get("x")?.as_f64()?, datum.get("y")?.as_f64()?];
    place.iter().all(|it| it.is_finite()).then_some(place)
}

/// What is shown of a fault: from before its first symptom until behind its end.
pub(super) fn window_ns(fault: &Fault) -> (u64, u64) {
    let verdict = &fault.verdict;
    let from_ns = verdict.first_symptom_ns.min(verdict.confirmed_ns);
    let end_ns = fault.end_ns().unwrap_or_default().max(verdict.confirmed_ns);
    let from_ns = from_ns.saturating_sub(ROOM_NS);
    let to_ns = end_ns.saturating_add(ROOM_NS);
    (from_ns, to_ns.min(from_ns.saturating_add(LONGEST_NS)))
}

/// A field of a datum by its path: `pose.x`, `distances[2]`.
fn at<'datum>(datum: &'datum Value, path: &str) -> Option<&'datum Value> {
    path.split('.').try_fold(datum, |value, part| {
        let element = part.strip_suffix(']').and_then(|it| it.split_once('['));
        match element {
            Some((name, index)) => value.get(name)?.get(index.parse::<usize>().ok()?),
            None => value.get(part),
        }
    })
}

fn name(wanted: &Wanted) -> String {
    let topic = wanted.topic.trim_start_matches('/');
    match wanted.kind {
        WantedKind::Value => format!("{topic}: {}", wanted.field),
        WantedKind::Age => format!("{topic}: age of the newest datum in ms"),
    }
}

fn milliseconds(ns: u64) -> f64 {
    ns as f64 / 1e6
}

#[cfg(test)]
mod tests;
