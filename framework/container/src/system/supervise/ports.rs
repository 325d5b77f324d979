//! Rules of ports: taps on data, safe values, ages.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use fault_manager::DetectorKind;
use fault_manager::detection::UnknownField;
use fault_manager::detection::data_check::DataCheck;
use fault_manager::detection::liveness::Freshness;
use system_model::rules::{Arming, PortChecks, PortRules};
use system_model::specification::{Place, PortDirection};

use super::actuators::takes_commands;
use super::{Subjects, misfit};
use crate::assembly::AssemblyProblem;
use crate::component::{InputTap, OutputTap, PortEnd, SafeDatum, Watch};
use crate::library::PortDescription;
use crate::port::Newest;
use crate::supervision::{Emergency, InputAge, Monitors, SafetyGate, Subject};

/// Puts taps on all ports that rules are about, and on the command ports of actuators.
pub(super) fn watch(
    subjects: &Subjects<'_>,
    emergency: &Emergency,
    monitors: &mut Monitors,
    problems: &mut Vec<AssemblyProblem>,
) {
    let rules = subjects.rules.components.iter().enumerate();
    // Those before are another application's, and have been seen to.
    for (component, rules) in rules.skip(subjects.members.start) {
        let gate = emergency.gate(component);
        if let Some(gate) = &gate {
            shut_in_emergency(subjects, component, gate);
        }
        for (number, rules) in rules.ports.iter().enumerate() {
            let Some((index, port)) = subjects.port(component, &rules.port) else {
                // A port that the library lacks is reported at its declaration.
                continue;
            };
            let target = Target {
                subjects,
                component,
                rules_index: number,
                rules,
                index,
                port,
            };
            match rules.direction {
                PortDirection::Output => target.tap_output(problems),
                PortDirection::Input => target.tap_input(gate.as_ref(), monitors, problems),
            }
        }
    }
}

/// In front of every data input of an actuator, with a safe value or without.
fn shut_in_emergency(subjects: &Subjects<'_>, component: usize, gate: &Arc<SafetyGate>) {
    let ports = &subjects.assembly.interfaces[component];
    subjects.with_component(component, |component| {
        for (index, port) in ports.iter().enumerate() {
            if takes_commands(port.kind, port.direction)
                && let Some(PortEnd::DataInput(input)) = component.services_mut().port_mut(index)
            {
                input.tap = Some(Box::new(InputTap::new(Arc::clone(gate))));
            }
        }
    });
}

/// One port with its rules.
struct Target<'start> {
    subjects: &'start Subjects<'start>,
    component: usize,
    rules_index: usize,
    rules: &'start PortRules,
    index: usize,
    port: &'start PortDescription,
}

impl Target<'_> {
    fn tap_output(&self, problems: &mut Vec<AssemblyProblem>) {
        let watch = self.checks(problems);
        self.subjects.with_component(self.component, |component| {
            if let Some(PortEnd::DataOutput(output)) = component.services_mut().port_mut(self.index)
            {
                let size = output.size;
                let tap = output
                    .tap
                    .get_or_insert_with(|| Box::new(OutputTap::new(size)));
                tap.watch = watch;
            }
        });
    }

    fn tap_input(
        &self,
        gate: Option<&Arc<SafetyGate>>,
        monitors: &mut Monitors,
        problems: &mut Vec<AssemblyProblem>,
    ) {
        let watch = self.checks(problems);
        let safe = self.safe_datum(problems);
        let freshness = self.rules.checks.freshness.as_ref();
        self.subjects.with_component(self.component, |component| {
            if let Some(PortEnd::DataInput(input)) = component.services_mut().port_mut(self.index) {
                let gate = || gate.cloned().unwrap_or_default();
                let tap = input
                    .tap
                    .get_or_insert_with(|| Box::new(InputTap::new(gate())));
                tap.watch = watch;
                tap.safe = safe;
                tap.maximum_age = freshness.map(|rule| rule.value.maximum_age);
            }
        });
        if let Some(rule) = freshness {
            self.watch_age(
                Freshness::new(&rule.value),
                rule.value.judgement.arming,
                monitors,
            );
        }
    }

    /// The checks of the data, with their detectors.
    fn checks(&self, problems: &mut Vec<AssemblyProblem>) -> Option<Watch> {
        let checks = &self.rules.checks;
        if checks.validity.is_empty() && checks.rate_of_change.is_empty() && checks.stuck.is_empty()
        {
            return None;
        }
        let data_type = self.port.data_type.as_ref()?;
        let check = match DataCheck::compile(data_type, checks) {
            Ok(check) => check,
            Err(unknown) => {
                problems.extend(unknown.iter().map(|field| self.unknown(checks, field)));
                return None;
            }
        };
        let port = self.rules_index;
        let kinds = (0..checks.validity.len())
            .map(|rule| DetectorKind::Validity { port, rule })
            .chain(
                (0..checks.rate_of_change.len())
                    .map(|rule| DetectorKind::RateOfChange { port, rule }),
            )
            .chain((0..checks.stuck.len()).map(|rule| DetectorKind::Stuck { port, rule }));
        let detectors = kinds
            .filter_map(|kind| self.subjects.detector(self.component, kind))
            .collect();
        Some(Watch::new(
            self.port.name.clone(),
            data_type.clone(),
            check,
            detectors,
        ))
    }

    fn unknown(&self, checks: &PortChecks, unknown: &UnknownField) -> AssemblyProblem {
        let places = checks
            .validity
            .iter()
            .map(|rule| &rule.place)
            .chain(checks.rate_of_change.iter().map(|rule| &rule.place))
            .chain(checks.stuck.iter().map(|rule| &rule.place));
        let place = places.into_iter().nth(unknown.index).cloned();
        self.no_field(&place.unwrap_or_default(), &unknown.field)
    }

    fn no_field(&self, place: &Place, field: &str) -> AssemblyProblem {
        let data_type = self.port.data_type.as_ref();
        let known = data_type.map_or_else(Vec::new, |it| {
            it.fields.iter().map(|field| field.path.clone()).collect()
        });
        misfit(
            place,
            format!(
                "port '{}' carries '{}', which has no field '{field}'",
                self.rules.port,
                data_type.map_or("nothing", |it| it.name.as_str())
            ),
            format!("its fields are {}", known.join(", ")),
        )
    }

    fn safe_datum(&self, problems: &mut Vec<AssemblyProblem>) -> Option<SafeDatum> {
        let safe_values = &self.rules.checks.safe_values;
        let first = safe_values.first()?;
        let data_type = self.port.data_type.as_ref()?;
        let values = safe_values.iter().map(|rule| &rule.value);
        match SafeDatum::new(data_type, values) {
            Ok(datum) => Some(datum),
            Err(field) => {
                let named = |rule: &&system_model::profile::Located<_>| {
                    let rule: &system_model::rules::SafeValue = &rule.value;
                    rule.field.as_ref() == Some(&field)
                };
                let place = safe_values.iter().find(named).unwrap_or(first);
                problems.push(self.no_field(&place.place, &field));
                None
            }
        }
    }

    fn watch_age(&self, mut freshness: Freshness, arming: Arming, monitors: &mut Monitors) {
        let kind = DetectorKind::Freshness {
            port: self.rules_index,
        };
        let Some(detector) = self.subjects.detector(self.component, kind) else {
            return;
        };
        if arming == Arming::Always {
            freshness.arm(std::time::Duration::ZERO);
        }
        if let Some(newest) = self.newest() {
            let status = &self.subjects.assembly.statuses[self.component];
            monitors.inputs.push(InputAge {
                subject: Subject::new(detector, Arc::clone(status)),
                port: self.port.name.clone(),
                freshness,
                newest,
            });
        }
    }

    /// Where that time is left if another robot feeds the input.
    fn newest_from_afar(&self) -> Option<Arc<Newest>> {
        let mut newest = None;
        self.subjects.with_component(self.component, |component| {
            if let Some(PortEnd::DataInput(input)) = component.services_mut().port_mut(self.index) {
                newest.clone_from(&input.newest_from_afar);
            }
        });
        newest
    }

    /// Where the time of the input's newest datum is left: at the other end of its connection. An
    /// input that nothing is connected to never has one.
    fn newest(&self) -> Option<Arc<Newest>> {
        let connections = &self.subjects.specification.connections;
        let is_here = |end: &system_model::specification::PortReference| {
            end.component == self.component && end.port == self.port.name
        };
        let Some(connection) = connections.iter().find(|it| is_here(&it.target)) else {
            return self.newest_from_afar();
        };
        let source = connection.source.clone();
        let (index, _) = self.subjects.port(source.component, &source.port)?;
        // The n-th connection of an output, in document order, as they were made.
        let position = connections
            .iter()
            .filter(|it| it.source == source)
            .position(|it| is_here(&it.target))?;
        let mut newest = None;
        self.subjects.with_component(source.component, |component| {
            if let Some(PortEnd::DataOutput(output)) = component.services_mut().port_mut(index)
                && let Some((sender, _)) = output.connections.get_mut(position)
            {
                newest = Some(sender.watch());
            }
        });
        debug_assert!(
            newest
                .as_ref()
                .is_none_or(|it| it.load(Ordering::Relaxed) == 0)
        );
        newest
    }
}
