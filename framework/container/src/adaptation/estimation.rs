//! Estimators (Definition 1): what a candidate's components would do that do not run, or would get
//! other data than now. Fresh instances of them run for a cycle on what the others have written last;
//! what they write goes to the next of them and to the evaluators, and nowhere else.

use std::sync::Arc;

use system_model::task::{ComponentClass, ComponentIndex, Placement, QualityAttribute};
use task_adaptation::{Answer, ComponentPerformance, given};

use super::binding::Part;
use super::evaluation::{error_of, worse};
use super::local::LocalRobot;
use super::outlet::Heard;
use super::shadow::Shadow;
use super::wiring::{Hop, PortKey, affected};
use crate::lane::Lane;

impl LocalRobot {
    /// What a candidate would do instead of what runs; all of it is on this robot.
    pub fn estimate(&self, candidate: &[Placement], running: &[Placement], lane: &Lane) -> Answer {
        match self.rehearse(candidate, running, lane) {
            Ok(performances) => Answer::Performances(performances),
            Err(how) => Answer::Crashed(how),
        }
    }

    fn rehearse(
        &self,
        candidate: &[Placement],
        running: &[Placement],
        lane: &Lane,
    ) -> Result<Vec<ComponentPerformance>, String> {
        let wanted = self.hops(candidate);
        let affected = affected(&wanted, &self.hops(running));
        let mut shadows = Vec::new();
        // Components stand in the order in which data flow.
        for placement in candidate {
            if let Some(part) = self.binding.part(*placement)
                && affected.contains(&part.component)
                && self.can_be_rehearsed(placement.component)
            {
                shadows.push(self.shadow(part, lane)?);
            }
        }
        let cycles = shadows.iter().map(|it| self.cycles(it)).max();
        for _ in 0..cycles.unwrap_or(0) {
            for index in 0..shadows.len() {
                let (before, rest) = shadows.split_at_mut(index);
                if let Some(shadow) = rest.first_mut() {
                    self.feed(shadow, before, &wanted);
                    shadow.run(self.now_ns(), lane)?;
                }
            }
        }
        let performances = self.estimated(candidate, &affected, &shadows);
        for shadow in shadows {
            shadow.end(lane);
        }
        performances
    }

    fn estimated(
        &self,
        candidate: &[Placement],
        affected: &[usize],
        shadows: &[Shadow],
    ) -> Result<Vec<ComponentPerformance>, String> {
        let mut performances = given(&self.binding.task, candidate);
        for (placement, performance) in candidate.iter().zip(&mut performances) {
            let Some(part) = self.binding.part(*placement) else {
                continue;
            };
            let shadow = shadows.iter().find(|it| it.component == part.component);
            let error = match shadow {
                Some(shadow) => estimated(part, shadow)?,
                None if affected.contains(&part.component) || part.evaluators.is_empty() => None,
                None => self.error(part),
            };
            if let Some(error) = error {
                performance.functional = error;
            }
        }
        Ok(performances)
    }

    /// Sensors and actuators would reach for their devices: nobody else may while they run.
    fn can_be_rehearsed(&self, component: ComponentIndex) -> bool {
        self.binding.task.components[component].class == ComponentClass::Computation
    }

    fn cycles(&self, shadow: &Shadow) -> u32 {
        let index = self.binding.task_component(shadow.component);
        let part = index.and_then(|index| self.binding.parts[index].as_ref());
        part.map_or(1, |part| part.cycles)
    }

    /// A fresh instance that goes on from the memory of the one that runs.
    fn shadow(&self, part: &Part, lane: &Lane) -> Result<Shadow, String> {
        let memory = self.enter(part.component, lane)?.critical_copy();
        let factory = Arc::clone(&self.factories[part.component]);
        Shadow::new(part.component, &factory, memory, lane)
    }

    /// Gives an instance what it would get: of those before it what they have written, of all others
    /// what they have written last.
    fn feed(&self, shadow: &mut Shadow, before: &[Shadow], wanted: &[Hop]) {
        let component = shadow.component;
        let task_component = self.binding.task_component(component);
        let part = task_component.and_then(|index| self.binding.parts[index].as_ref());
        let links = wanted.iter().map(|hop| (&hop.from, &hop.to));
        let links = links.filter(|(_, to)| to.component == component);
        let fed: Vec<&PortKey> = links.clone().map(|(_, to)| to).collect();
        let others = part.map_or(&[][..], |part| &part.sources).iter();
        let others = others
            .filter(|(_, to)| !fed.contains(&to))
            .map(|(from, to)| (from, to));
        for (from, to) in links.chain(others) {
            let writer = before.iter().find(|it| it.component == from.component);
            let heard: Option<&Heard> = match writer {
                Some(writer) => writer.written(&from.port),
                None => self.outlet(from).and_then(|outlet| outlet.newest()),
            };
            if let Some(heard) = heard {
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
