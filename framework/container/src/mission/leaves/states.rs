//! Conditions: whether a component works, and in which state of its life cycle it is.

use std::sync::Arc;

use behavior_tree::{Leaf, LeafContext, Status};

use crate::mission::reach::Reach;

/// Looks at a component's state.
pub(in crate::mission) struct State {
    pub(in crate::mission) reach: Arc<Reach>,
    pub(in crate::mission) component: usize,
    /// The word of the state; none: that it works.
    pub(in crate::mission) wanted: Option<String>,
}

impl Leaf for State {
    fn tick(&mut self, _context: &mut LeafContext<'_>) -> Result<Status, String> {
        let holds = match &self.wanted {
            None => self.reach.works(self.component),
            Some(word) => {
                let state = self.reach.state(self.component);
                state.is_some_and(|state| state.name() == word)
            }
        };
        Ok(match holds {
            true => Status::Success,
            false => Status::Failure,
        })
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}

/// Could a component work, and at what cost: the estimator of a Module.
pub(in crate::mission) struct Estimate {
    pub(in crate::mission) reach: Arc<Reach>,
    pub(in crate::mission) component: usize,
}

impl Leaf for Estimate {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        use fault_manager::Condition::{Destroyed, Lost};
        for (from, to) in [
            ("performance", "performance_cost"),
            ("resource", "resource_cost"),
        ] {
            let cost = super::number(context, from)?;
            if context.has_output(to) {
                context.output(to, behavior_tree::Value::Number(cost))?;
            }
        }
        let is_gone = matches!(self.reach.condition(self.component), Destroyed | Lost);
        let has_fault = self.reach.supervisor().has_fault(self.component, None);
        Ok(match is_gone || has_fault {
            true => Status::Failure,
            false => Status::Success,
        })
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}
