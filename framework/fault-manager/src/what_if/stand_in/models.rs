//! Process models, of which nothing is known but when what they compare cannot fit any more.

use std::time::Duration;

use system_model::fault::FaultKind;
use system_model::rules::RulePort;

use super::data::{Datum, Port};
use super::{BEGIN, StandIn, State};
use crate::manager::FaultManager;
use crate::observation::{DetectorId, DetectorKind};
use crate::system::Scope;

/// One process model.
#[derive(Debug)]
pub(super) struct Model {
    detector: DetectorId,
    /// The component to blame, whose recovery begins the comparison anew.
    component: usize,
    inputs: Vec<Port>,
    outputs: Vec<Port>,
    /// Outputs of a component that was recovered and begins at nothing, as its filters do, while the
    /// process goes on.
    unsettled: Vec<Port>,
    /// What was compared since the last look does not fit.
    wrong: bool,
}

/// All process models of all applications.
pub(super) fn models(scopes: &[Scope], firsts: &[usize], manager: &FaultManager) -> Vec<Model> {
    let mut models = Vec::new();
    for (scope, first) in scopes.iter().zip(firsts) {
        let components = *first..first + scope.specification.components.len();
        for (monitor, rule) in scope.rules.monitors.iter().enumerate() {
            let kind = DetectorKind::ProcessModel { monitor };
            let found = components
                .clone()
                .find_map(|one| Some((one, manager.detector(one, &kind)?)));
            let ports = |ports: &[RulePort]| -> Vec<Port> {
                let ports = ports.iter();
                ports
                    .map(|port| (first + port.component, port.port.clone()))
                    .collect()
            };
            models.extend(found.map(|(component, detector)| Model {
                detector,
                component,
                inputs: ports(&rule.inputs),
                outputs: ports(&rule.outputs),
                unsettled: Vec::new(),
                wrong: false,
            }));
        }
    }
    models
}

impl StandIn<'_> {
    /// A datum passes a port that a model may look at. Its inputs go to the process as well, so it
    /// fits whatever they are, unless they are beyond everything.
    pub(super) fn sample(&mut self, port: &Port, datum: Datum) {
        for model in &mut self.models {
            let is_output = model.outputs.contains(port);
            if datum.no_number || !(is_output || model.inputs.contains(port)) {
                continue;
            }
            model.wrong |= datum.far || (is_output && (datum.same || datum.late));
            if let Some(index) = model.unsettled.iter().position(|one| one == port) {
                model.unsettled.swap_remove(index);
                model.wrong = true;
            }
        }
    }

    /// A component was recovered.
    pub(super) fn begin_models_anew(&mut self, component: usize) {
        for model in &mut self.models {
            if model.component == component {
                model.wrong = false;
                model.unsettled.clear();
            } else {
                let own = model.outputs.iter().filter(|port| port.0 == component);
                let own: Vec<Port> = own.cloned().collect();
                model.unsettled.extend(own);
            }
        }
    }

    /// What does not fit is a symptom. Where an input is stale the process gets a safe value, or
    /// stops by itself, while the model goes on with the last datum.
    pub(super) fn look_at_models(&mut self) {
        for index in 0..self.models.len() {
            let model = &self.models[index];
            let starved = model.inputs.iter().any(|port| self.is_starved(port));
            let (component, detector) = (model.component, model.detector);
            let wrong = std::mem::take(&mut self.models[index].wrong);
            if (wrong || starved) && self.now > BEGIN {
                self.complain(component, detector, FaultKind::ProcessModel, "");
            }
        }
    }

    /// Whether a component that runs has got nothing at an input for longer than its rule allows.
    fn is_starved(&self, port: &Port) -> bool {
        let rules = &self.manager.system.components[port.0].rules.ports;
        let rule = rules.iter().find(|rules| rules.port == port.1);
        let fresh = rule.and_then(|rules| rules.checks.freshness.as_ref());
        let age = self
            .wiring
            .delivered(port)
            .map(|at| self.now.saturating_sub(at));
        let too_old = |maximum: Duration| age.is_some_and(|age| age > maximum);
        self.components[port.0].state == State::Active
            && fresh.is_some_and(|rule| too_old(rule.value.maximum_age))
    }
}
