//! State 3 and the first half of state 4 of the decider: each candidate's numbers by Equations (3)
//! to (8), whether it is feasible, and which one is the best.

use system_model::task::{ComponentIndex, Placement, TaskSpecification};

use crate::estimate::{Answer, implausible};
use crate::generator::{Candidate, Room};
use crate::quality::{
    ComponentPerformance, Quality, exceeds, functional_performance, non_functional_performance,
    task_performance,
};
use crate::resources::{shortages, sums};
use crate::verdict::{Judged, Nearest, Rejection};

/// Equations (3), (4) and (8) of placed components whose performances are plausible.
pub fn quality(
    task: &TaskSpecification,
    placements: &[Placement],
    performances: &[ComponentPerformance],
) -> Quality {
    let pairs = placements.iter().zip(performances);
    let pairs = pairs.map(|(placement, performance)| {
        let threshold = task.components[placement.component].threshold;
        (threshold, performance.functional)
    });
    let functional = functional_performance(task.quality.functional_weight, pairs);
    let uses = performances.iter().map(|it| &it.use_of_resources[..]);
    let non_functional = non_functional_performance(&sums(task, placements, uses));
    Quality {
        functional,
        non_functional,
        total: task_performance(functional, non_functional),
    }
}

/// Equation (5), and what it rests on: the quality, if the answer is one, and all that speaks against
/// the placements. They are feasible if that is nothing.
pub fn judge(
    task: &TaskSpecification,
    placements: &[Placement],
    answer: &Answer,
) -> (Option<Quality>, Vec<Rejection>) {
    let performances = match answer {
        Answer::Performances(performances) => performances,
        Answer::Crashed(how) => return (None, vec![Rejection::Crashed(how.clone())]),
        Answer::Silent(time) => return (None, vec![Rejection::Silent(*time)]),
        Answer::NotAsked => return (None, Vec::new()),
    };
    if let Some((position, what)) = implausible(task, placements, performances) {
        let placement = placements.get(position).copied();
        return (None, vec![Rejection::Implausible { placement, what }]);
    }
    let quality = quality(task, placements, performances);
    let mut rejections = Vec::new();
    let uses = performances.iter().map(|it| &it.use_of_resources[..]);
    let shortages = shortages(&sums(task, placements, uses));
    if !shortages.is_empty() {
        rejections.push(Rejection::NoRoom(shortages));
    }
    if !exceeds(quality.functional, task.quality.functional_threshold) {
        rejections.push(Rejection::Functional {
            performance: quality.functional,
            over: over_threshold(task, placements, performances),
        });
    }
    if !exceeds(
        quality.non_functional,
        task.quality.non_functional_threshold,
    ) {
        rejections.push(Rejection::NonFunctional(quality.non_functional));
    }
    (Some(quality), rejections)
}

/// Components whose own error has reached their threshold.
fn over_threshold(
    task: &TaskSpecification,
    placements: &[Placement],
    performances: &[ComponentPerformance],
) -> Vec<(ComponentIndex, f64)> {
    let pairs = placements.iter().zip(performances);
    let pairs = pairs.map(|(placement, performance)| (placement.component, performance.functional));
    let over = |(component, error): &(ComponentIndex, f64)| {
        *error > 0.0 && *error >= task.components[*component].threshold
    };
    pairs.filter(over).collect()
}

/// Judges all candidates; they are numbered from 1.
pub fn judge_all(
    task: &TaskSpecification,
    candidates: &[Candidate],
    answers: &[Answer],
) -> Vec<Judged> {
    let pairs = candidates.iter().zip(answers).enumerate();
    let judged = pairs.map(|(index, (candidate, answer))| {
        let (quality, mut rejections) = judge(task, &candidate.placements, answer);
        let has_no_room = |it: &Rejection| matches!(it, Rejection::NoRoom(_));
        match &candidate.room {
            Room::Lacking(shortages) if !rejections.iter().any(has_no_room) => {
                rejections.insert(0, Rejection::NoRoom(shortages.clone()));
            }
            Room::Unknown(shortages) => {
                rejections.retain(|it| !has_no_room(it));
                rejections.insert(0, Rejection::RoomUnknown(shortages.clone()));
            }
            _ => {}
        }
        // What was not asked for want of room has been rejected; nothing else is feasible unasked.
        let is_feasible = quality.is_some() && rejections.is_empty();
        Judged {
            number: index + 1,
            candidate: candidate.clone(),
            quality,
            is_feasible,
            rejections,
        }
    });
    judged.collect()
}

/// Which candidate it is to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// The candidate of this number.
    Take(usize),
    /// What runs is the candidate of this number, is feasible, and no other is better by enough.
    Keep(usize),
    /// None is feasible.
    Nothing,
}

/// The feasible candidate of the largest P_T, of equal ones the first; what runs is given up only for
/// one that is better by the task's hysteresis. The others get their rejection.
pub fn choose(
    task: &TaskSpecification,
    judged: &mut [Judged],
    running: Option<&[Placement]>,
) -> Choice {
    let best = judged
        .iter()
        .filter(|it| it.is_feasible)
        .max_by(|one, other| {
            let by_number = other.number.cmp(&one.number);
            one.total().total_cmp(&other.total()).then(by_number)
        });
    let Some(best) = best.map(|best| (best.number, best.total())) else {
        return Choice::Nothing;
    };
    let kept = judged.iter().find(|it| {
        it.is_feasible && running.is_some_and(|running| it.candidate.is_made_of(running))
    });
    let kept = kept.map(|kept| (kept.number, kept.total()));
    let hysteresis = task.decision.hysteresis;
    let keeps = kept.filter(|(_, total)| best.1 <= total * (1.0 + hysteresis));
    let (chosen, total) = keeps.unwrap_or(best);
    for other in judged
        .iter_mut()
        .filter(|it| it.is_feasible && it.number != chosen)
    {
        let rejection = match other.total() > total {
            true => Rejection::NotBetterByEnough {
                kept: chosen,
                total,
            },
            false => Rejection::NotBetter { chosen, total },
        };
        other.rejections = vec![rejection];
    }
    match keeps {
        Some((number, _)) => Choice::Keep(number),
        None => Choice::Take(chosen),
    }
}

/// The infeasible candidate that lacks least, of equal ones the first: relative shortfalls of
/// resources and of performances are added up; what has no numbers comes last.
pub fn nearest(task: &TaskSpecification, judged: &[Judged]) -> Option<Nearest> {
    let quality = &task.quality;
    let relative = |value: f64, threshold: f64| match threshold > 0.0 {
        true => (1.0 - value / threshold).clamp(0.0, 1.0),
        false => 0.0,
    };
    let shortfall = |rejection: &Rejection| match rejection {
        Rejection::NoRoom(shortages) | Rejection::RoomUnknown(shortages) => {
            let parts = shortages.iter();
            parts.map(|it| 1.0 - it.available / it.needed).sum::<f64>()
        }
        Rejection::Functional { performance, over } => {
            relative(*performance, quality.functional_threshold) + over.len() as f64
        }
        Rejection::NonFunctional(performance) => {
            relative(*performance, quality.non_functional_threshold)
        }
        _ => f64::INFINITY,
    };
    let infeasible = judged.iter().filter(|it| !it.is_feasible);
    let measured = infeasible.map(|it| (it, it.rejections.iter().map(shortfall).sum::<f64>()));
    let nearest = measured.min_by(|(_, one), (_, other)| one.total_cmp(other));
    nearest.map(|(judged, _)| Nearest {
        number: judged.number,
        lacks: judged.rejections.clone(),
    })
}
