//! Rejections in words, with the names of the task.

use system_model::task::{ComponentIndex, TaskSpecification};

use crate::resources::Shortage;
use crate::verdict::Rejection;

impl Rejection {
    /// One line, without a full stop.
    pub fn in_words(&self, task: &TaskSpecification) -> String {
        let quality = &task.quality;
        match self {
            Self::NoRoom(shortages) => shortages_in_words(task, shortages),
            Self::RoomUnknown(shortages) => format!(
                "{}; the search for another placement was given up",
                shortages_in_words(task, shortages)
            ),
            Self::Functional { performance, over } => {
                let threshold = quality.functional_threshold;
                let sentence = format!("P_F {performance:.4} does not exceed {threshold}");
                over.iter().fold(sentence, |sentence, (component, error)| {
                    format!("{sentence}; {}", over_in_words(task, *component, *error))
                })
            }
            Self::NonFunctional(performance) => format!(
                "P_NF {performance:.4} does not exceed {}",
                quality.non_functional_threshold
            ),
            Self::Implausible { placement, what } => {
                let whose = placement.map(|it| format!(" of {}", task.placement_name(it)));
                format!(
                    "an estimate{} {}",
                    whose.unwrap_or_default(),
                    what.in_words()
                )
            }
            Self::Crashed(how) => format!("an estimator crashed: {how}"),
            Self::Silent(time) => format!("an estimator had not answered after {time:?}"),
            Self::ChangeFailed(why) => {
                format!("it was chosen, but could not be brought about: {why}")
            }
            Self::Lost => "one of its instances has been lost meanwhile".to_owned(),
            Self::NotBetter { chosen, total } => {
                format!("candidate {chosen} has P_T {total:.4}")
            }
            Self::NotBetterByEnough { kept, total } => format!(
                "not better by {} % than candidate {kept}, which runs and has P_T {total:.4}",
                task.decision.hysteresis * 100.0
            ),
        }
    }
}

fn shortages_in_words(task: &TaskSpecification, shortages: &[Shortage]) -> String {
    let parts = shortages.iter().map(|shortage| {
        let resource = &task.resources[shortage.resource];
        let unit = match resource.unit.is_empty() {
            true => String::new(),
            false => format!(" {}", resource.unit),
        };
        format!(
            "{} has {}{unit} of {}, {} needed",
            task.robots[shortage.robot].name,
            rounded(shortage.available),
            resource.name,
            rounded(shortage.needed)
        )
    });
    parts.collect::<Vec<_>>().join("; ")
}

fn over_in_words(task: &TaskSpecification, component: ComponentIndex, error: f64) -> String {
    let component = &task.components[component];
    let (name, threshold) = (&component.name, component.threshold);
    format!("the error {error} of {name} is not below {threshold}")
}

/// Without the digits that only rounding has brought about.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
