//! Which components move something, and where their commands come in.

use std::sync::Arc;

use system_model::specification::{PortDirection, PortKind};

use super::Subjects;
use crate::supervision::{Actuator, SafetyGate};

/// All actuators of an application. Each has one gate in front of all its data inputs.
pub(super) fn find(subjects: &Subjects<'_>) -> Vec<Actuator> {
    let rules = subjects.rules.components.iter().enumerate();
    let actuators = rules.filter_map(|(component, rules)| {
        let rule = rules.actuator.as_ref()?;
        Some(Actuator {
            component,
            category: rule.value.stop_category,
            gate: Arc::new(SafetyGate::default()),
        })
    });
    actuators.collect()
}

/// Whether a port is one by which commands come in.
pub(super) fn takes_commands(kind: PortKind, direction: PortDirection) -> bool {
    (kind, direction) == (PortKind::Data, PortDirection::Input)
}
