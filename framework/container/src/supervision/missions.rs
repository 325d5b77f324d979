//! What behaviour trees ask of the fault manager, from threads of their own: each answers at once.

use std::sync::Arc;

use fault_manager::{Condition, DetectorId, DetectorKind, FaultId, Observation, OperatorOrder};
use system_model::life_cycle::LifeCycleState;

use super::{Orders, Supervisor};

impl Supervisor {
    /// How a component is doing, as far as the fault manager knows.
    pub fn condition(&self, component: usize) -> Condition {
        let condition = self.lock().manager.condition(component);
        condition.unwrap_or(Condition::Destroyed)
    }

    /// Whether a component works: nothing is done or to be done for it, and it is active.
    pub fn works(&self, component: usize) -> bool {
        let is_active = self.state(component) == Some(LifeCycleState::Active);
        is_active && self.condition(component) == Condition::Working
    }

    /// The state of a component in its life cycle.
    pub fn state(&self, component: usize) -> Option<LifeCycleState> {
        self.statuses.get(component).map(|status| status.state())
    }

    /// Which instance of a component it is.
    pub fn incarnation(&self, component: usize) -> u32 {
        let status = self.statuses.get(component);
        status.map_or(0, |status| status.incarnation())
    }

    /// A tree has something done with a component.
    ///
    /// # Errors
    /// Why it makes no sense now.
    pub fn order_by_tree(
        &self,
        tree: usize,
        component: usize,
        order: OperatorOrder,
    ) -> Result<(), String> {
        if let Some(reason) = self.lock().manager.refusal(component, order) {
            return Err(reason);
        }
        self.observe(Observation::OrderedByTree {
            tree,
            component,
            order,
        });
        Ok(())
    }

    /// Whether a fault of a component, of a kind if one is named, is confirmed and has not healed.
    pub fn has_fault(&self, component: usize, kind: Option<&str>) -> bool {
        let core = self.lock();
        core.manager
            .present_faults(component, kind)
            .next()
            .is_some()
    }

    /// The numbers of these faults.
    pub fn present_faults(&self, component: usize, kind: Option<&str>) -> Vec<FaultId> {
        self.lock()
            .manager
            .present_faults(component, kind)
            .collect()
    }

    /// What is asked of a tree, by its index behind all components.
    pub fn orders_of(&self, tree: usize) -> Arc<Orders> {
        let orders = self.orders.get(tree).cloned();
        // There is one for each tree; without it none would be taken.
        orders.unwrap_or_else(|| Arc::new(Orders::new(Arc::default())))
    }

    /// The detector of a component, or of a tree, if there is one.
    pub fn detector(&self, component: usize, kind: &DetectorKind) -> Option<DetectorId> {
        self.lock().manager.detector(component, kind)
    }
}
