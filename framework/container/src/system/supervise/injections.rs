//! Faults that are made on purpose from the start.

use std::time::Duration;

use system_model::injection::{InjectedFault, Injection};

use super::misfit;
use crate::assembly::{Assembly, AssemblyProblem};
use crate::component::Environment;
use crate::lane::SETUP_TOKEN;

/// Adds all of them; distortions of ports get a tap there.
///
/// # Errors
/// Those that do not fit the libraries.
pub(in crate::system) fn inject(
    injections: &[Injection],
    assembly: &Assembly,
    environment: &Environment,
) -> Result<(), Vec<AssemblyProblem>> {
    let mut problems = Vec::new();
    for injection in injections {
        let port = match &injection.what {
            InjectedFault::Port {
                component, port, ..
            } => {
                let interface = &assembly.interfaces[*component];
                let found = interface.iter().position(|it| it.name == *port);
                found.and_then(|index| {
                    tap(assembly, *component, index);
                    Some((index, interface[index].data_type.as_ref()?))
                })
            }
            _ => None,
        };
        if let Err(error) = environment
            .injections
            .add(injection.clone(), Duration::ZERO, port)
        {
            problems.push(misfit(
                &injection.place,
                format!("injected fault '{}': {error}", injection.what.name()),
                "see the data type of the port".to_owned(),
            ));
        }
    }
    if problems.is_empty() {
        Ok(())
    } else {
        Err(problems)
    }
}

fn tap(assembly: &Assembly, component: usize, port: usize) {
    let cell = &assembly.components[component];
    if let Some(mut component) = cell.enter(SETUP_TOKEN, Duration::ZERO) {
        component.services_mut().tap(port);
    }
}
