//! Estimators (Definition 1): what a candidate's components would do that do not run, or would get
//! other data than now. Fresh instances of them run for a cycle on what the others have written last;
//! what they write goes to the next of them and to the evaluators, and nowhere else.

use std::sync::Arc;

use system_model::task::{Placement, QualityAttribute};
use task_adaptation::{Answer, ComponentPerformance, given};

use super::binding::Part;
use super::evaluation::{error_of, worse};
use super::local::LocalRobot;
use super::outlet::Heard;
use super::rehearsal::{Rehearsal, Segment};
use super::shadow::Shadow;
use super::wiring::{Hop, PortKey};
use crate::lane::Lane;

/// What a component has written to a link.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// Position of the link.
    pub link: usize,
    /// The component.
    pub from: Placement,
    /// The datum.
    pub heard: Heard,
}

/// What came of a segment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rehearsed {
    /// Errors of those that were run; none where nothing tells it.
    pub errors: Vec<(Placement, Option<f64>)>,
    /// What others need.
    pub written: Vec<Written>,
}

impl LocalRobot {
    /// What a candidate would do instead of what runs; all of it is in this system.
    pub fn estimate(&self, candidate: &[Placement], running: &[Placement], lane: &Lane) -> Answer {
        let plan = self.rehearsal(candidate, running);
        let mut errors = Vec::new();
        for segment in &plan.segments {
            match self.rehearse(segment, &plan.wanted, &[], lane) {
                Ok(rehearsed) => errors.extend(rehearsed.errors),
                Err(how) => return Answer::Crashed(how),
            }
        }
        let measured = |placement| self.measured_error(placement);
        Answer::Performances(self.estimated(candidate, &plan, &errors, measured))
    }

    pub(super) fn rehearsal(&self, candidate: &[Placement], running: &[Placement]) -> Rehearsal {
        let is_here = |robot| self.binding.robots.contains(&robot);
        Rehearsal::new(&self.binding.task, candidate, running, is_here)
    }

    /// Does a segment of a rehearsal that is this system's, on data that others have `given`.
    ///
    /// # Errors
    /// Which component does not do it, and why; in words.
    pub(super) fn rehearse(
        &self,
        segment: &Segment,
        wanted: &[Hop],
        given: &[Written],
        lane: &Lane,
    ) -> Result<Rehearsed, String> {
        let mut shadows = Vec::new();
        for placement in &segment.placements {
            if let Some(part) = self.binding.part(*placement) {
                shadows.push((part, self.shadow(part, lane)?));
            }
        }
        let cycles = shadows.iter().map(|(part, _)| part.cycles).max();
        for _ in 0..cycles.unwrap_or(0) {
            for index in 0..shadows.len() {
                let (before, rest) = shadows.split_at_mut(index);
                if let Some((part, shadow)) = rest.first_mut() {
                    self.feed(part, shadow, (before, given), wanted);
                    shadow.run(self.now_ns(), lane)?;
                }
            }
        }
        let rehearsed = self.told(segment, &shadows);
        for (_, shadow) in shadows {
            shadow.end(lane);
        }
        rehearsed
    }

    fn told(&self, segment: &Segment, shadows: &[(&Part, Shadow)]) -> Result<Rehearsed, String> {
        let mut told = Rehearsed::default();
        for (part, shadow) in shadows {
            told.errors.push((part.placement, estimated(part, shadow)?));
        }
        for (link, from) in &segment.tell {
            let mut ends = self.binding.ends.iter();
            let end = ends.find(|it| it.link == *link && it.placement == *from);
            let output = end.and_then(|end| end.output.as_ref());
            let Some(output) = output else { continue };
            let mut writers = shadows.iter();
            let writer = writers.find(|(part, _)| part.placement == *from);
            let heard = match writer {
                Some((_, shadow)) => shadow.written(&output.port),
                None => self.outlet(output).and_then(|outlet| outlet.newest()),
            };
            let heard = heard.cloned().ok_or_else(|| {
                let name = &self.statuses[output.component].name;
                format!("'{name}' wrote nothing to '{}'", output.port)
            })?;
            told.written.push(Written {
                link: *link,
                from: *from,
                heard,
            });
        }
        Ok(told)
    }

    /// All performances of a candidate: of what was run for it by its estimate, of what goes on as it
    /// does by what was `measured`, else by what the task says.
    pub(super) fn estimated(
        &self,
        candidate: &[Placement],
        plan: &Rehearsal,
        errors: &[(Placement, Option<f64>)],
        measured: impl Fn(Placement) -> Option<f64>,
    ) -> Vec<ComponentPerformance> {
        let mut performances = given(&self.binding.task, candidate);
        for (placement, performance) in candidate.iter().zip(&mut performances) {
            let run = errors.iter().find(|(of, _)| of == placement);
            let error = match run {
                Some((_, error)) => *error,
                None if plan.affected.contains(placement) => None,
                None => measured(*placement),
            };
            if let Some(error) = error {
                performance.functional = error;
            }
        }
        performances
    }

    /// The error of a component of this system that runs; none where nothing tells it.
    pub(super) fn measured_error(&self, placement: Placement) -> Option<f64> {
        let part = self.binding.part(placement)?;
        (!part.evaluators.is_empty()).then(|| self.error(part))?
    }

    /// A fresh instance that goes on from the memory of the one that runs.
    fn shadow(&self, part: &Part, lane: &Lane) -> Result<Shadow, String> {
        let memory = self.enter(part.component, lane)?.critical_copy();
        let factory = Arc::clone(&self.factories[part.component]);
        Shadow::new(&factory, memory, lane)
    }

    /// Gives an instance what it would get: of those before it what they have written, of all others
    /// what they have written last.
    fn feed(
        &self,
        part: &Part,
        shadow: &mut Shadow,
        (before, given): (&[(&Part, Shadow)], &[Written]),
        wanted: &[Hop],
    ) {
        let newest = |key: &PortKey| self.outlet(key).and_then(|outlet| outlet.newest());
        let mut fed: Vec<&PortKey> = Vec::new();
        for hop in wanted.iter().filter(|hop| hop.to == part.placement) {
            let Some((input, _)) = self.binding.input(hop) else {
                continue;
            };
            fed.push(input);
            let mut given = given.iter();
            let given = given.find(|it| (it.link, it.from) == (hop.link, hop.from));
            let mut before = before.iter();
            let writer = before.find(|(part, _)| part.placement == hop.from);
            let heard = match (writer, self.binding.output(hop)) {
                (Some((_, writer)), Some((output, _))) => writer.written(&output.port),
                (None, Some((output, _))) => newest(output),
                _ => given.map(|it| &it.heard),
            };
            if let Some(heard) = heard {
                shadow.send(&input.port, heard);
            }
        }
        for (from, to) in part.sources.iter().filter(|(_, to)| !fed.contains(&to)) {
            if let Some(heard) = newest(from) {
                shadow.send(&to.port, heard);
            }
        }
    }
}

/// The error of an instance that was run for an estimate: what it estimates itself, else what its
/// evaluators make of what it wrote; none where nothing tells it.
fn estimated(part: &Part, shadow: &Shadow) -> Result<Option<f64>, String> {
    let written = |key: &PortKey| {
        let heard = shadow.written(&key.port);
        heard.ok_or_else(|| format!("'{}' wrote nothing to '{}'", shadow.name, key.port))
    };
    if let Some((key, reader)) = &part.own_estimate {
        return Ok(Some(reader.read(&written(key)?.bytes)));
    }
    let mut largest = None;
    for evaluator in &part.evaluators {
        let heard = written(&evaluator.key)?;
        let measured = match (evaluator.rule.attribute, &evaluator.reader) {
            (QualityAttribute::Value, Some(reader)) => reader.read(&heard.bytes),
            // It was written just now.
            (QualityAttribute::Age, _) => 0.0,
            // A cycle has no deviation.
            _ => continue,
        };
        let error = error_of(evaluator, measured);
        largest = Some(largest.map_or(error, |largest| worse(error, largest)));
    }
    Ok(largest)
}
