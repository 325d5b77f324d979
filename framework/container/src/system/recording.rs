//! A recording of a system: every port gets its recorder.

use std::sync::Arc;
use std::time::Duration;

use system_model::data_type::DataType;
use system_model::specification::{PortDirection, PortKind};

use super::applications::Applications;
use super::{ClockKind, RunOptions, StartError};
use crate::assembly::Assembly;
use crate::component::{Component, Environment, OutputTap, PortEnd};
use crate::event_log::Event;
use crate::lane::SETUP_TOKEN;
use crate::library::PortDescription;
use crate::recording::{EventRecorder, Recorder, RecordingThread};

/// Begins the recording: every data output and event output, and every data input at which rules or
/// injections stand, which may read something else than was sent. All other inputs read what is
/// recorded at the outputs that they are connected to. What else is recorded has been added already.
///
/// # Errors
/// If a file cannot be made, or there is no thread.
pub(super) fn record(
    mut recorder: Recorder,
    applications: &Applications,
    assembly: &Assembly,
    environment: &Arc<Environment>,
    options: &RunOptions,
) -> Result<RecordingThread, StartError> {
    for (index, cell) in assembly.components.iter().enumerate() {
        let Some(mut component) = cell.enter(SETUP_TOKEN, Duration::ZERO) else {
            continue;
        };
        for (number, port) in assembly.interfaces[index].iter().enumerate() {
            attach(&mut recorder, &mut component, number, port);
        }
    }
    if !recorder.left_out().is_empty() {
        let message = format!(
            "not recorded, because a datum is longer than --record-max-bytes-per-datum: {}",
            recorder.left_out().join(", ")
        );
        let now_ns = environment.clock.now_ns();
        environment.events.record(now_ns, Event::Notice { message });
    }
    let parts = applications.parts.iter();
    let components = parts.flat_map(|part| {
        let specification = &part.application.specification;
        let components = specification.components.iter();
        components.map(|it| (it.name.as_str(), specification.name.as_str()))
    });
    recorder.start(environment, components, about(applications, options))
}

/// Finds the ports of the recording that is played, if one is, and lets time begin where it does.
///
/// # Errors
/// If the recording does not fit.
pub(super) fn play(
    applications: &Applications,
    assembly: &Assembly,
    environment: &Environment,
) -> Result<(), StartError> {
    if let Some(score) = &environment.score {
        score
            .bind(&applications.specification, assembly)
            .map_err(StartError::Assembly)?;
        environment.clock.advance_to(score.first_ns());
    }
    Ok(())
}

/// What the file says of the run.
fn about(applications: &Applications, options: &RunOptions) -> Vec<(&'static str, String)> {
    let mut about = vec![
        ("application", applications.specification.name.clone()),
        ("clock", options.clock.name().to_owned()),
        ("seed", options.seed.to_string()),
    ];
    // A simulated run has no time of day, and says the same every time.
    if options.clock == ClockKind::Real {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let now_ns = now.unwrap_or_default().as_nanos();
        about.push(("started_unix_ns", now_ns.to_string()));
    }
    about
}

fn attach(
    recorder: &mut Recorder,
    component: &mut Component,
    number: usize,
    port: &PortDescription,
) {
    let name = component.name().to_string();
    let Some(end) = component.services_mut().port_mut(number) else {
        return;
    };
    match (end, &port.data_type) {
        (PortEnd::DataOutput(output), Some(data_type)) => {
            let size = output.size;
            if let Some(recorder) = recorder.port(&name, &port.name, "output", data_type) {
                let tap = output
                    .tap
                    .get_or_insert_with(|| Box::new(OutputTap::new(size)));
                tap.recorder = Some(recorder);
            }
        }
        (PortEnd::DataInput(input), Some(data_type)) => {
            if let Some(tap) = &mut input.tap {
                tap.recorder = recorder.port(&name, &port.name, "input", data_type);
            }
        }
        (PortEnd::EventOutput(output), data_type) => {
            debug_assert_eq!(
                (port.kind, port.direction),
                (PortKind::Event, PortDirection::Output)
            );
            let data_type = data_type.clone().unwrap_or_else(without_content);
            let recorder = recorder.port(&name, &port.name, "event", &data_type);
            output.recorder = recorder.map(|port| {
                let scratch = vec![0; data_type.size].into_boxed_slice();
                Box::new(EventRecorder { scratch, port })
            });
        }
        _ => {}
    }
}

/// The type of an event that has happened and says no more.
fn without_content() -> DataType {
    DataType {
        name: "Event".to_owned(),
        size: 0,
        layout_hash: 0,
        fields: Vec::new(),
    }
}
