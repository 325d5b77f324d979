//! What evaluators and estimators say (Definition 1), and what the task says beforehand.

use std::time::Duration;

use system_model::task::{Condition, Placement, TaskSpecification};

use crate::quality::ComponentPerformance;

/// The answer of the evaluators of what runs, or of a candidate's estimators.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// One performance for each placement, in the order of the placements.
    Performances(Vec<ComponentPerformance>),
    /// One of them crashed; how.
    Crashed(String),
    /// One of them had not answered after this time.
    Silent(Duration),
    /// They were not asked, because there is no room for the candidate anyway.
    NotAsked,
}

/// Why a performance cannot be one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Implausible {
    /// It is not a number.
    NotANumber,
    /// It is infinite.
    Infinite,
    /// It is less than nothing.
    Negative,
    /// There are more or fewer numbers than components or resources.
    Incomplete,
}

impl Implausible {
    /// In a sentence that begins with "an estimate".
    pub fn in_words(self) -> &'static str {
        match self {
            Self::NotANumber => "is not a number",
            Self::Infinite => "is infinite",
            Self::Negative => "is negative",
            Self::Incomplete => "is incomplete",
        }
    }
}

/// The first placement whose performance cannot be one, by its position.
pub fn implausible(
    task: &TaskSpecification,
    placements: &[Placement],
    performances: &[ComponentPerformance],
) -> Option<(usize, Implausible)> {
    if performances.len() != placements.len() {
        let position = performances.len().min(placements.len().saturating_sub(1));
        return Some((position, Implausible::Incomplete));
    }
    let found = performances.iter().map(|performance| {
        if performance.use_of_resources.len() != task.resources.len() {
            return Some(Implausible::Incomplete);
        }
        let numbers = [performance.functional].into_iter();
        let mut numbers = numbers.chain(performance.use_of_resources.iter().copied());
        numbers.find_map(|number| match number {
            number if number.is_nan() => Some(Implausible::NotANumber),
            number if number.is_infinite() => Some(Implausible::Infinite),
            number if number < 0.0 => Some(Implausible::Negative),
            _ => None,
        })
    });
    let mut found = found.enumerate();
    found.find_map(|(position, implausible)| Some((position, implausible?)))
}

/// The performances of placements as the task gives them: each functional error is the first of
/// its instance whose conditions hold, and 0 where there is none; what a component uses is what it
/// needs.
pub fn given(task: &TaskSpecification, placements: &[Placement]) -> Vec<ComponentPerformance> {
    let holds = |condition: &Condition| {
        let mut placements = placements.iter();
        placements.any(|placement| {
            placement.component == condition.component
                && condition.robot.is_none_or(|robot| robot == placement.robot)
        })
    };
    let performances = placements.iter().map(|placement| {
        let instance = task.instance(*placement);
        let estimates = instance.map_or(&[][..], |instance| &instance.estimates);
        let counts = estimates
            .iter()
            .find(|estimate| estimate.with.iter().all(holds));
        ComponentPerformance {
            functional: counts.map_or(0.0, |estimate| estimate.functional),
            use_of_resources: instance.map_or_else(Vec::new, |instance| instance.demand.clone()),
        }
    });
    performances.collect()
}

/// What evaluators say of `running`, in the order of a candidate that is made of the same.
pub(crate) fn reordered(answer: &Answer, running: &[Placement], candidate: &[Placement]) -> Answer {
    let Answer::Performances(performances) = answer else {
        return answer.clone();
    };
    let of = |placement| {
        let position = running.iter().position(|it| it == placement)?;
        performances.get(position).cloned()
    };
    let in_order: Option<Vec<_>> = candidate.iter().map(of).collect();
    match in_order {
        Some(in_order) if performances.len() == in_order.len() => Answer::Performances(in_order),
        // As many as there should be they are not; whoever judges it says that.
        _ => answer.clone(),
    }
}
