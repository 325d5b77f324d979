//! Process-model monitors: samplers at the ports that they name.

use std::sync::Arc;
use std::time::Duration;

use fault_manager::detection::process_model::{InputMap, Monitor, ResidualMonitor};
use fault_manager::detection::{NumberReader, UnknownField};
use fault_manager::{DetectorId, DetectorKind};
use system_model::data_type::DataType;
use system_model::process_model::ProcessModel;
use system_model::rules::{DecisionRule, MonitorRule, RulePort};

use super::{Subjects, misfit};
use crate::assembly::AssemblyProblem;
use crate::component::{InputTap, OutputTap, PortEnd};
use crate::supervision::{Channel, ModelMonitor, Monitors, Reading, Reference, Sampler};

/// Every monitor, with samplers at its ports.
pub(super) fn watch(
    subjects: &Subjects<'_>,
    monitors: &mut Monitors,
    problems: &mut Vec<AssemblyProblem>,
) {
    for (number, rule) in subjects.rules.monitors.iter().enumerate() {
        match monitor(subjects, number, rule) {
            Ok(model) => monitors.models.extend(model),
            Err(found) => problems.extend(found),
        }
    }
}

fn monitor(
    subjects: &Subjects<'_>,
    number: usize,
    rule: &MonitorRule,
) -> Result<Option<ModelMonitor>, Vec<AssemblyProblem>> {
    let kind = DetectorKind::ProcessModel { monitor: number };
    let mut detectors = subjects.manager.detectors().iter().enumerate();
    let found = detectors.find(|(_, detector)| {
        detector.kind == kind && subjects.members.contains(&detector.component)
    });
    let Some((detector, blamed)) = found else {
        return Ok(None);
    };
    let (reference, inputs) = reference(subjects, rule)?;
    let outputs = readings(subjects, rule, &rule.outputs, Channel::Output)?;
    let status = Arc::clone(&subjects.assembly.statuses[blamed.component]);
    let method = method(rule.rule.value.method);
    let detector = DetectorId(detector);
    let monitor = ModelMonitor::new(rule.name.clone(), method, detector, status, reference);
    for (port, channel, reading) in inputs.into_iter().chain(outputs) {
        attach(subjects, &port, monitor.sampler(channel, reading));
    }
    Ok(Some(monitor))
}

/// What the process is compared with, a file or a component of the application, and what goes in.
fn reference(
    subjects: &Subjects<'_>,
    rule: &MonitorRule,
) -> Result<(Reference, Vec<Sampled>), Vec<AssemblyProblem>> {
    let problem = |message, help: &str| vec![misfit(&rule.rule.place, message, help.to_owned())];
    let wanted = &rule.rule.value.model;
    if let Some((_, model)) = subjects.models.iter().find(|(name, _)| name == wanted) {
        return state_space(subjects, rule, model);
    }
    let mut members = subjects.members.clone();
    let component = members.find(|index| subjects.named(*index) == wanted);
    let Some(component) = component else {
        return Err(problem(
            format!("monitor '{}' has no model '{wanted}'", rule.name),
            "name a process model's file, beside the rule file or on --search-path, or a component \
             of the application",
        ));
    };
    // Its outputs bear the names of those that they are compared with.
    let outputs = rule.outputs.iter().map(|output| RulePort {
        component,
        ..output.clone()
    });
    let outputs: Vec<RulePort> = outputs.collect();
    let missing = outputs
        .iter()
        .find(|output| subjects.port(component, &output.port).is_none());
    if let Some(missing) = missing {
        return Err(problem(
            format!(
                "monitor '{}': reference component '{wanted}' has no port '{}' to compare with",
                rule.name, missing.port
            ),
            "its outputs must bear the names of those that they are compared with",
        ));
    }
    let period = rule.outputs.first().map_or(Duration::ZERO, |output| {
        subjects.specification.components[output.component]
            .execution
            .period
    });
    let count = outputs.len();
    let monitor = ResidualMonitor::new(&rule.rule.value, count, period).map_err(|error| {
        problem(
            format!(
                "monitor '{}' cannot compare with '{wanted}': {error}",
                rule.name
            ),
            "a reference component has a period, and no covariance for chi_square",
        )
    })?;
    let inputs = readings(subjects, rule, &outputs, Channel::Input)?;
    Ok((Reference::Component(Box::new(monitor), count), inputs))
}

fn state_space(
    subjects: &Subjects<'_>,
    rule: &MonitorRule,
    model: &ProcessModel,
) -> Result<(Reference, Vec<Sampled>), Vec<AssemblyProblem>> {
    let problem = |message, help: &str| vec![misfit(&rule.rule.place, message, help.to_owned())];
    let monitor = Monitor::new(model, &rule.rule.value).map_err(|error| {
        problem(
            format!(
                "monitor '{}' cannot use model '{}': {error}",
                rule.name, model.name
            ),
            "see the model's file and the parameters of the monitor",
        )
    })?;
    if monitor.model().outputs() != rule.outputs.len() {
        return Err(problem(
            format!(
                "monitor '{}' compares {} outputs, model '{}' has {}",
                rule.name,
                rule.outputs.len(),
                model.name,
                monitor.model().outputs()
            ),
            "one <output> for each output of the model, in its order",
        ));
    }
    let inputs = input_readings(subjects, rule, model, monitor.model().inputs())?;
    Ok((Reference::Model(Box::new(monitor)), inputs))
}

fn method(rule: DecisionRule) -> &'static str {
    match rule {
        DecisionRule::Window => "window",
        DecisionRule::Cusum { .. } => "cusum",
        DecisionRule::ChiSquare => "chi_square",
    }
}

type Sampled = (RulePort, Channel, Reading);

fn input_readings(
    subjects: &Subjects<'_>,
    rule: &MonitorRule,
    model: &ProcessModel,
    wanted: usize,
) -> Result<Vec<Sampled>, Vec<AssemblyProblem>> {
    let mut readings = Vec::new();
    let mut count = 0;
    for port in &rule.inputs {
        let Some(data_type) = data_type(subjects, port) else {
            continue;
        };
        let (reading, inputs) = if model.inputs.is_empty() {
            let reader = NumberReader::compile(data_type, port.field.as_deref(), 0)
                .map_err(|unknown| vec![unknown_field(rule, port, &unknown)])?;
            (Reading::Number(reader), 1)
        } else {
            let map = InputMap::compile(&model.inputs, data_type).map_err(|unknown| {
                let each = unknown.iter();
                each.map(|unknown| unknown_field(rule, port, unknown))
                    .collect::<Vec<_>>()
            })?;
            let inputs = map.inputs();
            (Reading::Inputs(map), inputs)
        };
        readings.push((port.clone(), Channel::Input(count), reading));
        count += inputs;
    }
    if count == wanted {
        return Ok(readings);
    }
    Err(vec![misfit(
        &rule.rule.place,
        format!(
            "monitor '{}' gives its model {count} inputs, the model takes {wanted}",
            rule.name
        ),
        "one <input> for each input of the model, or one datum for a model with an input table"
            .to_owned(),
    )])
}

/// One number of each of these ports.
fn readings(
    subjects: &Subjects<'_>,
    rule: &MonitorRule,
    ports: &[RulePort],
    channel: fn(usize) -> Channel,
) -> Result<Vec<Sampled>, Vec<AssemblyProblem>> {
    let mut readings = Vec::new();
    for (index, port) in ports.iter().enumerate() {
        let Some(data_type) = data_type(subjects, port) else {
            continue;
        };
        let reader = NumberReader::compile(data_type, port.field.as_deref(), 0)
            .map_err(|unknown| vec![unknown_field(rule, port, &unknown)])?;
        readings.push((port.clone(), channel(index), Reading::Number(reader)));
    }
    Ok(readings)
}

fn data_type<'start>(subjects: &'start Subjects<'_>, port: &RulePort) -> Option<&'start DataType> {
    let (_, port) = subjects.port(port.component, &port.port)?;
    port.data_type.as_ref()
}

fn unknown_field(rule: &MonitorRule, port: &RulePort, unknown: &UnknownField) -> AssemblyProblem {
    misfit(
        &rule.rule.place,
        format!("monitor '{}', port '{}': {unknown}", rule.name, port.port),
        format!(
            "the fields of '{}' are {}",
            unknown.data_type,
            unknown.known.join(", ")
        ),
    )
}

fn attach(subjects: &Subjects<'_>, port: &RulePort, sampler: Sampler) {
    let Some((index, _)) = subjects.port(port.component, &port.port) else {
        return;
    };
    subjects.with_component(port.component, |component| {
        match component.services_mut().port_mut(index) {
            Some(PortEnd::DataOutput(output)) => {
                let size = output.size;
                let tap = output
                    .tap
                    .get_or_insert_with(|| Box::new(OutputTap::new(size)));
                tap.samplers.push(sampler);
            }
            Some(PortEnd::DataInput(input)) => {
                let tap = input
                    .tap
                    .get_or_insert_with(|| Box::new(InputTap::default()));
                tap.samplers.push(sampler);
            }
            _ => {}
        }
    });
}
