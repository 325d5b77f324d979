//! Links of a task become ports of the components that this system has of it.

use system_model::data_type::DataType;
use system_model::specification::PortDirection;
use system_model::task::{ComponentIndex, Placement, RobotIndex, TaskLink};

use super::binding::Part;
use super::known::{Known, misfit};
use super::wiring::PortKey;
use crate::assembly::AssemblyProblem;
use crate::library::PortDescription;

/// Where a component of this system meets a link of the task.
#[derive(Debug, Clone)]
pub struct LinkEnd {
    /// Position in the task's links.
    pub link: usize,
    /// The component.
    pub placement: Placement,
    /// Where it takes the data of the link; none for the first component.
    pub input: Option<PortKey>,
    /// Where it gives them on; none for the last.
    pub output: Option<PortKey>,
    /// What the data are.
    pub data_type: DataType,
}

/// All ends of links that a robot of this system has.
pub(super) fn link_ends(
    links: &[TaskLink],
    robot: RobotIndex,
    parts: &[Part],
    known: &Known<'_>,
    problems: &mut Vec<AssemblyProblem>,
) -> Vec<LinkEnd> {
    let component = |component: ComponentIndex| {
        let placement = Placement { component, robot };
        let part = parts.iter().find(|it| it.placement == placement);
        part.map(|part| part.component)
    };
    let mut all = Vec::new();
    for (link, rule) in links.iter().enumerate() {
        let (from, to) = (component(rule.from), component(rule.to));
        let (output, input) = match (from, to) {
            (Some(from), Some(to)) => match both_ends(rule, from, to, known, problems) {
                Some((output, input)) => (Some(output), Some(input)),
                None => continue,
            },
            (from, to) => {
                let output = from.map(|from| {
                    let name = rule.ports.output.as_deref();
                    one_end(rule, from, PortDirection::Output, name, known)
                });
                let input = to.map(|to| {
                    let name = rule.ports.input.as_deref();
                    one_end(rule, to, PortDirection::Input, name, known)
                });
                (
                    found(output.transpose(), problems),
                    found(input.transpose(), problems),
                )
            }
        };
        let data_type = output.as_ref().or(input.as_ref()).map(|(_, it)| it.clone());
        let mut end = |component, input, output, data_type| {
            let placement = Placement { component, robot };
            all.push(LinkEnd {
                link,
                placement,
                input,
                output,
                data_type,
            });
        };
        for (position, index) in rule.through.iter().enumerate() {
            let Some(between) = component(*index) else {
                continue;
            };
            let none = (None, None);
            let names = rule.ports.through.get(position).unwrap_or(&none);
            match stage(rule, between, names, data_type.as_ref(), known) {
                Ok((input, output, data_type)) => {
                    end(*index, Some(input), Some(output), data_type);
                }
                Err(problem) => problems.push(problem),
            }
        }
        if let Some((key, data_type)) = output {
            end(rule.from, None, Some(key), data_type);
        }
        if let Some((key, data_type)) = input {
            end(rule.to, Some(key), None, data_type);
        }
    }
    all
}

fn found<T>(
    end: Result<Option<T>, AssemblyProblem>,
    problems: &mut Vec<AssemblyProblem>,
) -> Option<T> {
    end.unwrap_or_else(|problem| {
        problems.push(problem);
        None
    })
}

/// The ports of a component that may stand in between: those that carry the type of the link; where
/// the robot has neither end of it, the only pair of the component's that carries one type.
fn stage(
    link: &TaskLink,
    component: usize,
    (input, output): &(Option<String>, Option<String>),
    data_type: Option<&DataType>,
    known: &Known<'_>,
) -> Result<(PortKey, PortKey, DataType), AssemblyProblem> {
    let place = &link.ports.place;
    let port = |direction, name: &Option<String>, data_type: &DataType| {
        known.only_port(component, direction, name.as_deref(), data_type, place)
    };
    if let Some(data_type) = data_type {
        let input = port(PortDirection::Input, input, data_type)?;
        let output = port(PortDirection::Output, output, data_type)?;
        return Ok((input, output, data_type.clone()));
    }
    let pairs = pairs(component, component, (output, input), known);
    match &pairs[..] {
        [(out, into, data_type)] => Ok((
            key(component, into),
            key(component, out),
            (*data_type).clone(),
        )),
        _ => Err(misfit(
            place,
            format!(
                "'{}' has {} pairs of ports that could stand in this link",
                known.specification.components[component].name,
                pairs.len()
            ),
            "write input=\"…\" and output=\"…\" in its <through>",
        )),
    }
}

/// A port with the type that it carries.
type TypedPort = (PortKey, DataType);

/// The port of a component whose other end is on another robot: the one that is named; else the only
/// one that faces this way, or of several the only one that the application connects.
fn one_end(
    link: &TaskLink,
    component: usize,
    direction: PortDirection,
    name: Option<&str>,
    known: &Known<'_>,
) -> Result<TypedPort, AssemblyProblem> {
    let ports = known.data_ports(component, direction);
    let mut ports: Vec<_> = ports
        .filter(|port| name.is_none_or(|name| name == port.name))
        .collect();
    if ports.len() > 1 {
        ports.retain(|port| is_connected(component, port, known));
    }
    if let [port] = ports[..]
        && let Some(data_type) = &port.data_type
    {
        return Ok((key(component, port), data_type.clone()));
    }
    let (what, help) = match direction {
        PortDirection::Input => ("inputs", "write input=\"…\" in the <link>"),
        PortDirection::Output => ("outputs", "write output=\"…\" in the <link>"),
    };
    Err(misfit(
        &link.ports.place,
        format!(
            "'{}' has {} {what} that this link could mean",
            known.specification.components[component].name,
            ports.len()
        ),
        help,
    ))
}

/// The ports at both ends of a link: those that are named; else the only pair that fits, or of
/// several the only one that the application connects.
fn both_ends(
    link: &TaskLink,
    from: usize,
    to: usize,
    known: &Known<'_>,
    problems: &mut Vec<AssemblyProblem>,
) -> Option<(TypedPort, TypedPort)> {
    let names = (&link.ports.output, &link.ports.input);
    let mut pairs = pairs(from, to, names, known);
    if pairs.len() > 1 {
        pairs.retain(|(output, input, _)| {
            is_connected(from, output, known) && is_connected(to, input, known)
        });
    }
    if let [(output, input, data_type)] = pairs[..] {
        let (output, input) = (key(from, output), key(to, input));
        return Some(((output, data_type.clone()), (input, data_type.clone())));
    }
    let name = |component: usize| &known.specification.components[component].name;
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

/// Outputs of one component that fit inputs of another, or of the same.
fn pairs<'a>(
    from: usize,
    to: usize,
    (output_name, input_name): (&Option<String>, &Option<String>),
    known: &'a Known<'_>,
) -> Vec<(&'a PortDescription, &'a PortDescription, &'a DataType)> {
    let named = |name: &Option<String>, port: &PortDescription| {
        name.as_ref().is_none_or(|name| *name == port.name)
    };
    let mut pairs = Vec::new();
    for output in known.data_ports(from, PortDirection::Output) {
        for input in known.data_ports(to, PortDirection::Input) {
            let (Some(one), Some(other)) = (&output.data_type, &input.data_type) else {
                continue;
            };
            if one.fits(other) && named(output_name, output) && named(input_name, input) {
                pairs.push((output, input, one));
            }
        }
    }
    pairs
}

fn is_connected(component: usize, port: &PortDescription, known: &Known<'_>) -> bool {
    let mut connections = known.specification.connections.iter();
    connections.any(|it| {
        let (source, target) = (&it.source, &it.target);
        (source.component, source.port.as_str()) == (component, port.name.as_str())
            || (target.component, target.port.as_str()) == (component, port.name.as_str())
    })
}

fn key(component: usize, port: &PortDescription) -> PortKey {
    PortKey {
        component,
        port: port.name.clone(),
    }
}
