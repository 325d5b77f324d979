//! Heartbeats, overruns, memory.

use std::sync::Arc;
use std::time::Duration;

use fault_manager::detection::liveness::{Heartbeat, Overruns};
use fault_manager::{Detector, DetectorId, DetectorKind};
use system_model::profile::Located;
use system_model::rules::{Arming, HeartbeatRule, OverrunRule};

use super::Subjects;
use crate::supervision::{MemoryUse, Monitors, OverrunCount, Subject, WorkDone};

/// A watch for every detector of these kinds in the application; the fault manager has chosen the
/// rule.
pub(super) fn watch(subjects: &Subjects<'_>, monitors: &mut Monitors) {
    for (number, detector) in subjects.manager.detectors().iter().enumerate() {
        // Of what is played the recording does not tell.
        if !subjects.members.contains(&detector.component) || subjects.is_played(detector.component)
        {
            continue;
        }
        let id = DetectorId(number);
        match detector.kind {
            DetectorKind::Heartbeat => watch_work(subjects, id, detector, monitors),
            DetectorKind::Overrun => watch_overruns(subjects, id, detector, monitors),
            DetectorKind::Memory => watch_memory(subjects, id, detector, monitors),
            _ => {}
        }
    }
}

fn watch_work(
    subjects: &Subjects<'_>,
    id: DetectorId,
    detector: &Detector,
    monitors: &mut Monitors,
) {
    let rules = subjects.rules;
    let own = subjects.rules_of(detector.component);
    let candidates = own
        .and_then(|rules| rules.heartbeat.as_ref())
        .into_iter()
        .chain(
            rules
                .executors
                .iter()
                .filter_map(|it| it.heartbeat.as_ref()),
        )
        .chain(rules.heartbeat.as_ref())
        .chain(rules.nodes.iter().map(|(_, rule)| rule));
    if let Some(rule) = chosen::<HeartbeatRule>(detector, candidates) {
        let mut heartbeat = Heartbeat::new(rule);
        if rule.judgement.arming == Arming::Always {
            heartbeat.arm(Duration::ZERO, 0);
        }
        monitors.heartbeats.push(WorkDone {
            subject: subject(subjects, id, detector),
            heartbeat,
        });
    }
}

fn watch_overruns(
    subjects: &Subjects<'_>,
    id: DetectorId,
    detector: &Detector,
    monitors: &mut Monitors,
) {
    let own = subjects.rules_of(detector.component);
    let executors = subjects.rules.executors.iter();
    let candidates = own
        .and_then(|rules| rules.overrun.as_ref())
        .into_iter()
        .chain(executors.filter_map(|it| it.overrun.as_ref()));
    if let Some(rule) = chosen::<OverrunRule>(detector, candidates) {
        monitors.overruns.push(OverrunCount {
            subject: subject(subjects, id, detector),
            overruns: Overruns::new(rule, 0),
        });
    }
}

fn watch_memory(
    subjects: &Subjects<'_>,
    id: DetectorId,
    detector: &Detector,
    monitors: &mut Monitors,
) {
    let own = subjects.rules_of(detector.component);
    if let Some(rule) = own.and_then(|rules| rules.memory.as_ref()) {
        monitors.memories.push(MemoryUse {
            subject: subject(subjects, id, detector),
            limit_bytes: rule.value.limit_bytes,
        });
    }
}

fn subject(subjects: &Subjects<'_>, id: DetectorId, detector: &Detector) -> Subject {
    Subject::new(
        id,
        Arc::clone(&subjects.assembly.statuses[detector.component]),
    )
}

/// The rule that stands where the detector's does.
fn chosen<'rules, Rule>(
    detector: &Detector,
    mut candidates: impl Iterator<Item = &'rules Located<Rule>>,
) -> Option<&'rules Rule> {
    let place = detector.place.as_ref()?;
    let found = candidates.find(|rule| rule.place == *place);
    found.map(|rule| &rule.value)
}
