//! Process-model monitors: samplers at the ports that they name.

use std::sync::Arc;

use fault_manager::detection::process_model::{InputMap, Monitor};
use fault_manager::detection::{NumberReader, UnknownField};
use fault_manager::{DetectorId, DetectorKind};
use system_model::data_type::DataType;
use system_model::process_model::ProcessModel;
use system_model::rules::{DecisionRule, MonitorRule, RulePort};

use super::{Subjects, misfit};
use crate::assembly::AssemblyProblem;
use crate::component::{InputTap, OutputTap, PortEnd};
use crate::supervision::{Channel, ModelMonitor, Monitors, Reading, Sampler};

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
    let problem = |message, help: &str| vec![misfit(&rule.rule.place, message, help.to_owned())];
    let wanted = &rule.rule.value.model;
    let found = subjects.models.iter().find(|(name, _)| name == wanted);
    let Some((_, model)) = found else {
        return Err(problem(
            format!("monitor '{}' has no model '{wanted}'", rule.name),
            "name a process model's file, beside the rule file or on --search-path",
        ));
    };
    let kind = DetectorKind::ProcessModel { monitor: number };
    let mut detectors = subjects.manager.detectors().iter().enumerate();
    let Some((detector, blamed)) = detectors.find(|(_, detector)| detector.kind == kind) else {
        return Ok(None);
    };
    let detector = DetectorId(detector);
    let watching = Monitor::new(model, &rule.rule.value).map_err(|error| {
        problem(
            format!(
                "monitor '{}' cannot use model '{wanted}': {error}",
                rule.name
            ),
            "see the model's file and the parameters of the monitor",
        )
    })?;
    if watching.model().outputs() != rule.outputs.len() {
        return Err(problem(
            format!(
                "monitor '{}' compares {} outputs, model '{wanted}' has {}",
                rule.name,
                rule.outputs.len(),
                watching.model().outputs()
            ),
            "one <output> for each output of the model, in its order",
        ));
    }
    let inputs = input_readings(subjects, rule, model, watching.model().inputs())?;
    let outputs = output_readings(subjects, rule)?;
    let status = Arc::clone(&subjects.assembly.statuses[blamed.component]);
    let method = method(rule.rule.value.method);
    let monitor = ModelMonitor::new(rule.name.clone(), method, detector, status, watching);
    for (port, channel, reading) in inputs.into_iter().chain(outputs) {
        attach(subjects, port, monitor.sampler(channel, reading));
    }
    Ok(Some(monitor))
}

fn method(rule: DecisionRule) -> &'static str {
    match rule {
        DecisionRule::Window => "window",
        DecisionRule::Cusum { .. } => "cusum",
        DecisionRule::ChiSquare => "chi_square",
    }
}

type Sampled<'rule> = (&'rule RulePort, Channel, Reading);

fn input_readings<'rule>(
    subjects: &Subjects<'_>,
    rule: &'rule MonitorRule,
    model: &ProcessModel,
    wanted: usize,
) -> Result<Vec<Sampled<'rule>>, Vec<AssemblyProblem>> {
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
        readings.push((port, Channel::Input(count), reading));
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

fn output_readings<'rule>(
    subjects: &Subjects<'_>,
    rule: &'rule MonitorRule,
) -> Result<Vec<Sampled<'rule>>, Vec<AssemblyProblem>> {
    let mut readings = Vec::new();
    for (index, port) in rule.outputs.iter().enumerate() {
        let Some(data_type) = data_type(subjects, port) else {
            continue;
        };
        let reader = NumberReader::compile(data_type, port.field.as_deref(), 0)
            .map_err(|unknown| vec![unknown_field(rule, port, &unknown)])?;
        readings.push((port, Channel::Output(index), Reading::Number(reader)));
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
