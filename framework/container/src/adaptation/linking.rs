//! Links of a task become connections of ports.

use system_model::data_type::DataType;
use system_model::specification::PortDirection;
use system_model::task::{ComponentIndex, TaskLink, TaskSpecification};

use super::binding::Part;
use super::known::{Known, misfit};
use super::wiring::{PortKey, Route, Stage};
use crate::assembly::AssemblyProblem;
use crate::library::PortDescription;

/// The links whose ends both are on this robot.
pub(super) fn routes(
    task: &TaskSpecification,
    parts: &[Option<Part>],
    known: &Known<'_>,
    problems: &mut Vec<AssemblyProblem>,
) -> Vec<Route> {
    let component = |index: ComponentIndex| parts[index].as_ref().map(|part| part.component);
    let mut routes = Vec::new();
    for link in &task.links {
        let (Some(from), Some(to)) = (component(link.from), component(link.to)) else {
            continue;
        };
        let Some((output, input, data_type)) = ends(link, from, to, known, problems) else {
            continue;
        };
        let through = link
            .through
            .iter()
            .enumerate()
            .filter_map(|(position, index)| {
                let between = component(*index)?;
                let none = (None, None);
                let (input, output) = link.ports.through.get(position).unwrap_or(&none);
                let place = &link.ports.place;
                let port = |direction, name: &Option<String>| {
                    known.only_port(between, direction, name.as_deref(), &data_type, place)
                };
                let input = port(PortDirection::Input, input);
                match (input, port(PortDirection::Output, output)) {
                    (Ok(input), Ok(output)) => Some(Stage {
                        component: *index,
                        input,
                        output,
                    }),
                    (input, output) => {
                        problems.extend([input, output].into_iter().filter_map(Result::err));
                        None
                    }
                }
            });
        routes.push(Route {
            through: through.collect(),
            from: output,
            to: input,
            size: data_type.size,
        });
    }
    routes
}

/// The ports at both ends of a link: those that are named; else the only pair that fits, or of
/// several the only one that the application connects.
fn ends(
    link: &TaskLink,
    from: usize,
    to: usize,
    known: &Known<'_>,
    problems: &mut Vec<AssemblyProblem>,
) -> Option<(PortKey, PortKey, DataType)> {
    let named = |name: &Option<String>, port: &PortDescription| {
        name.as_ref().is_none_or(|name| *name == port.name)
    };
    let mut pairs = Vec::new();
    for output in known.data_ports(from, PortDirection::Output) {
        for input in known.data_ports(to, PortDirection::Input) {
            let fits = match (&output.data_type, &input.data_type) {
                (Some(one), Some(other)) => one.fits(other),
                _ => false,
            };
            if fits && named(&link.ports.output, output) && named(&link.ports.input, input) {
                pairs.push((output, input));
            }
        }
    }
    if pairs.len() > 1 {
        let fed = |component: usize, port: &PortDescription| {
            let mut connections = known.specification.connections.iter();
            connections.any(|it| {
                let (source, target) = (&it.source, &it.target);
                (source.component, source.port.as_str()) == (component, port.name.as_str())
                    || (target.component, target.port.as_str()) == (component, port.name.as_str())
            })
        };
        pairs.retain(|(output, input)| fed(from, output) && fed(to, input));
    }
    let name = |component: usize| &known.specification.components[component].name;
    match pairs[..] {
        [(output, input)] => {
            let key = |component, port: &PortDescription| PortKey {
                component,
                port: port.name.clone(),
            };
            let data_type = output.data_type.clone()?;
            Some((key(from, output), key(to, input), data_type))
        }
        _ => {
            let found = match pairs.is_empty() {
                true => "no output of the one fits an input of the other",
                false => "several of their ports fit",
            };
            problems.push(misfit(
                &link.ports.place,
                format!("the link from '{}' to '{}': {found}", name(from), name(to)),
                "write output=\"…\" and input=\"…\" in the <link>",
            ));
            None
        }
    }
}
