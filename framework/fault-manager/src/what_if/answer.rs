//! What would come of a fault.

use serde::Serialize;

use super::stand_in::{Component, State};
use crate::state::Condition;
use crate::verdict::Verdict;

/// What would come of a fault.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// The faults that the fault manager would see, with what it would do, in order.
    pub verdicts: Vec<Verdict>,
    /// The components in the end, in the order of their applications.
    pub components: Vec<ComponentEnd>,
    /// The applications in the end.
    pub applications: Vec<ApplicationEnd>,
    /// Whether an emergency stop is in force in the end.
    pub emergency_stop: bool,
    /// Components that take wrong data for right ones.
    pub reaches: Vec<String>,
}

/// One component in the end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ComponentEnd {
    /// Instance name.
    pub component: String,
    /// Life-cycle state: `ACTIVE`, `INACTIVE`, `ERROR` or `DESTROYED`.
    pub state: &'static str,
    /// Which instance, counted from 1.
    pub incarnation: u32,
    /// Whether it was stopped for good, or lost.
    pub lost: bool,
}

/// One application in the end.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ApplicationEnd {
    /// Its name.
    pub application: String,
    /// `ACTIVE` if all its components are, `STOPPED` if none is, else `DEGRADED`.
    pub state: &'static str,
}

impl Answer {
    /// Everything that would be done, in the order of the faults that it is done for, and how it
    /// ends: `reset camera: done`.
    pub fn actions(&self) -> Vec<String> {
        let actions = self.verdicts.iter().flat_map(|verdict| &verdict.actions);
        actions
            .map(|action| format!("{}: {}", action.action, action.outcome))
            .collect()
    }

    /// Whether any detector sees the fault.
    pub fn is_seen(&self) -> bool {
        !self.verdicts.is_empty()
    }

    /// Whether nothing at all would be done.
    pub fn ends_in_nothing(&self) -> bool {
        self.verdicts
            .iter()
            .all(|verdict| verdict.actions.is_empty())
    }

    /// Whether the robot would stand: an emergency stop, or an application that is stopped.
    pub fn stops_robot(&self) -> bool {
        let stopped = |end: &ApplicationEnd| end.state == "STOPPED";
        self.emergency_stop || self.applications.iter().any(stopped)
    }
}

/// What a stand-in has come to.
pub(super) struct Course {
    pub applications: Vec<String>,
    pub components: Vec<Component>,
    pub conditions: Vec<Condition>,
    pub emergency: bool,
    pub reaches: Vec<String>,
    pub verdicts: Vec<Verdict>,
}

/// The answer.
pub(super) fn conclude(course: Course) -> Answer {
    let applications = course.applications.into_iter().enumerate();
    let applications = applications.map(|(index, application)| {
        let own = || {
            course
                .components
                .iter()
                .filter(|one| one.application == index)
        };
        let active = own().filter(|one| one.state == State::Active).count();
        ApplicationEnd {
            application,
            state: match active {
                count if count == own().count() => "ACTIVE",
                0 => "STOPPED",
                _ => "DEGRADED",
            },
        }
    });
    let gone = [Condition::Stopped, Condition::Destroyed, Condition::Lost];
    let components = course.components.iter().zip(&course.conditions);
    Answer {
        applications: applications.collect(),
        components: components
            .map(|(component, condition)| ComponentEnd {
                component: component.name.clone(),
                state: component.state.name(),
                incarnation: component.incarnation,
                lost: gone.contains(condition),
            })
            .collect(),
        verdicts: course.verdicts,
        emergency_stop: course.emergency,
        reaches: course.reaches,
    }
}
