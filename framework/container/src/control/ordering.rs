//! What an operator orders for a component, by its name.

use std::time::Duration;

use fault_manager::OperatorOrder;

use super::RunningSystem;
use super::protocol::Answer;

/// The fault manager sees an order within microseconds; after this it is so busy that the operator
/// should hear of that. Short, because the next client waits meanwhile.
pub(super) const ORDER_LIMIT: Duration = Duration::from_millis(200);

impl RunningSystem {
    /// The index of the component of a name; where several applications run, also of the only one
    /// whose name within its application this is.
    ///
    /// # Errors
    /// If there is none, or several.
    pub fn find(&self, name: &str) -> Result<usize, String> {
        let names: Vec<&str> = self.statuses.iter().map(|it| it.name.as_str()).collect();
        find(&names, name)
    }

    /// Gives an order; the answer has the verdict that tells what becomes of it.
    pub(super) fn order(&self, name: &str, order: &Wanted) -> Answer {
        let given = self.find(name).and_then(|component| {
            let order = self.understand(component, order)?;
            self.supervisor.order(component, order, ORDER_LIMIT)
        });
        match given {
            Ok(id) => Answer::done("ordered", id.0),
            Err(reason) => Answer::Refused(reason),
        }
    }

    fn understand(&self, component: usize, order: &Wanted) -> Result<OperatorOrder, String> {
        let secondary = match order {
            Wanted::Reset => return Ok(OperatorOrder::Reset),
            Wanted::Stop => return Ok(OperatorOrder::Stop),
            Wanted::Replacement(None) => return Ok(OperatorOrder::Replace { secondary: None }),
            Wanted::Replacement(Some(secondary)) => secondary,
        };
        let standbys = self.supervisor.standbys(component);
        let count = standbys.map_or(1, |it| it.factory().variants().len());
        let types: Vec<String> = (1..count).map(|it| self.variant(component, it)).collect();
        let chosen = types.iter().position(|known| known == secondary);
        match chosen {
            Some(index) => Ok(OperatorOrder::Replace {
                secondary: Some(index),
            }),
            None if types.is_empty() => Ok(OperatorOrder::Replace { secondary: None }),
            None => Err(format!(
                "'{secondary}' is no secondary of {}; there are: {}",
                self.statuses[component].name,
                types.join(", ")
            )),
        }
    }
}

/// What is wanted of a component, as a request says it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Wanted {
    Reset,
    /// By a secondary of this component type, or by the next one.
    Replacement(Option<String>),
    Stop,
}

fn find(names: &[&str], wanted: &str) -> Result<usize, String> {
    if let Some(index) = names.iter().position(|name| *name == wanted) {
        return Ok(index);
    }
    let ends_so = |name: &str| {
        let within = name.split_once('/');
        within.is_some_and(|(_, own)| own == wanted)
    };
    let found: Vec<usize> = (0..names.len()).filter(|it| ends_so(names[*it])).collect();
    match found[..] {
        [index] => Ok(index),
        [] => Err(format!(
            "there is no component '{wanted}'; there are: {}",
            names.join(", ")
        )),
        _ => {
            let several: Vec<&str> = found.iter().map(|index| names[*index]).collect();
            Err(format!(
                "several components are called '{wanted}': {}; say which",
                several.join(", ")
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names() {
        let names = ["patrol/camera", "patrol/planner", "map/camera", "arm/a/b"];
        for (wanted, expected) in [
            ("patrol/camera", Ok(0)),
            ("planner", Ok(1)),
            ("a/b", Ok(3)),
            ("b", Err("there is no component 'b'")),
            ("camera", Err("patrol/camera, map/camera; say which")),
            ("", Err("there are: patrol/camera")),
        ] {
            match (find(&names, wanted), expected) {
                (Err(reason), Err(part)) => assert!(reason.contains(part), "{reason}"),
                (found, expected) => assert_eq!(found, expected.map_err(str::to_owned)),
            }
        }
    }
}
