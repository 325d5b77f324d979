//! The fault manager's event ports, connected as applications ask for it.

use std::sync::Arc;

use fault_manager::DetectorKind;
use system_model::specification::{ManagerConnection, PortDirection};

use super::{Subjects, misfit};
use crate::assembly::{AssemblyProblem, EVENT_QUEUE};
use crate::component::{Inbox, PortEnd};
use crate::port::mailbox;
use crate::supervision::ManagerOutputs;
use crate::wake::Wake;

/// Connects all components of all applications that ask for it.
pub(super) fn connect(
    subjects: &Subjects<'_>,
    problems: &mut Vec<AssemblyProblem>,
) -> ManagerOutputs {
    let mut outputs = ManagerOutputs::default();
    for connection in &subjects.specification.manager_connections {
        let end = &connection.component;
        let Some((index, port)) = subjects.port(end.component, &end.port) else {
            // A port that the library lacks is reported at its declaration.
            continue;
        };
        if let Some(data_type) = &port.data_type {
            problems.push(carries(subjects, connection, &data_type.name));
            continue;
        }
        match connection.manager.direction() {
            PortDirection::Output => listen(subjects, connection, index, &mut outputs),
            PortDirection::Input => hear(subjects, end.component, index),
        }
    }
    outputs
}

fn carries(
    subjects: &Subjects<'_>,
    connection: &ManagerConnection,
    data_type: &str,
) -> AssemblyProblem {
    let end = &connection.component;
    let component = &subjects.specification.components[end.component];
    misfit(
        &connection.place,
        format!(
            "in the library port '{}' of component '{}' carries '{data_type}'",
            end.port, component.name
        ),
        "events of and for the fault manager have no content".to_owned(),
    )
}

/// From one of the fault manager's outputs to an inbox of the component.
fn listen(
    subjects: &Subjects<'_>,
    connection: &ManagerConnection,
    index: usize,
    outputs: &mut ManagerOutputs,
) {
    let end = &connection.component;
    let (Some(wake), Ok(port)) = (wake_of(subjects, end.component), u32::try_from(index)) else {
        return;
    };
    let (sender, messages) = mailbox(EVENT_QUEUE, 0);
    let name = subjects.specification.components[end.component]
        .name
        .clone();
    outputs.connect(connection.manager, name, sender, wake);
    subjects.with_component(end.component, |component| {
        component.services_mut().add_inbox(Inbox {
            port,
            method: None,
            messages,
            in_work: None,
            deaths: 0,
        });
    });
}

/// Each event of the component's output is a fault that it reports. A rule that names the port says
/// how it is judged.
fn hear(subjects: &Subjects<'_>, component: usize, index: usize) {
    let reported = subjects.detector(component, DetectorKind::FaultEvent(None));
    subjects.with_component(component, |component| {
        if let Some(PortEnd::EventOutput(output)) = component.services_mut().port_mut(index) {
            output.fault = output.fault.or(reported);
        }
    });
}

fn wake_of(subjects: &Subjects<'_>, component: usize) -> Option<Arc<Wake>> {
    let runs = |member: &crate::executor::Member| usize::try_from(member.number) == Ok(component);
    let mut executors = subjects.assembly.executors.iter();
    let executor = executors.find(|executor| executor.members.iter().any(runs))?;
    Some(Arc::clone(&executor.wake))
}
