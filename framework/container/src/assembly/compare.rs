//! Both ends of connections, compared.

use system_model::data_type::DataType;
use system_model::specification::{
    ApplicationSpecification, ConnectionSpecification, PortKind, PortReference,
};

use super::{AssemblyProblem, find_port, list};
use crate::library::{LoadedLibrary, MethodDescription, PortDescription};

/// Compares both ends of every connection; all that do not fit.
pub(super) fn check(
    specification: &ApplicationSpecification,
    libraries: &[LoadedLibrary],
) -> Vec<AssemblyProblem> {
    let mut problems = Vec::new();
    for connection in &specification.connections {
        let source = port_of(libraries, &connection.source);
        let target = port_of(libraries, &connection.target);
        let (Some(source), Some(target)) = (source, target) else {
            // A declared port that the library lacks is reported once, at its declaration.
            continue;
        };
        let mismatch = match connection.kind {
            PortKind::Data | PortKind::Event => types(source, target),
            PortKind::Service => methods(source, target),
        };
        if let Some((message, help)) = mismatch {
            problems.push(AssemblyProblem::Connection {
                place: connection.place.clone(),
                message: format!("{}: {message}", ends(specification, connection)),
                help,
            });
        }
    }
    problems
}

fn ends(specification: &ApplicationSpecification, connection: &ConnectionSpecification) -> String {
    let name = |end: &PortReference| {
        format!(
            "'{}.{}'",
            specification.components[end.component].name, end.port
        )
    };
    format!(
        "connection {} -> {}",
        name(&connection.source),
        name(&connection.target)
    )
}

pub(super) fn port_of<'library>(
    libraries: &'library [LoadedLibrary],
    end: &PortReference,
) -> Option<&'library PortDescription> {
    find_port(&libraries[end.component].description, &end.port)
}

pub(super) fn types(
    source: &PortDescription,
    target: &PortDescription,
) -> Option<(String, String)> {
    let fits = match (&source.data_type, &target.data_type) {
        (None, None) => true,
        (Some(source), Some(target)) => source.fits(target),
        _ => false,
    };
    (!fits).then(|| {
        let message = format!(
            "the source carries {}, the target takes {}",
            type_name(source.data_type.as_ref()),
            type_name(target.data_type.as_ref())
        );
        let help = "both must be built with the same definition of the type".to_owned();
        (message, help)
    })
}

pub(super) fn methods(
    required: &PortDescription,
    provided: &PortDescription,
) -> Option<(String, String)> {
    for method in &required.methods {
        let Some(other) = provided_method(provided, method) else {
            return Some((
                format!("the provider has no method '{}'", method.name),
                format!(
                    "it has {}",
                    list(provided.methods.iter().map(|method| &method.name))
                ),
            ));
        };
        let same = same_type(method.request.as_ref(), other.1.request.as_ref())
            && same_type(method.reply.as_ref(), other.1.reply.as_ref())
            && method.blocking == other.1.blocking;
        if !same {
            return Some((
                format!(
                    "method '{}' is declared differently on both sides",
                    method.name
                ),
                "request, reply and blocking must agree".to_owned(),
            ));
        }
    }
    None
}

pub(super) fn provided_method<'library>(
    provided: &'library PortDescription,
    method: &MethodDescription,
) -> Option<(usize, &'library MethodDescription)> {
    provided
        .methods
        .iter()
        .enumerate()
        .find(|(_, other)| other.name == method.name)
}

fn same_type(one: Option<&DataType>, other: Option<&DataType>) -> bool {
    match (one, other) {
        (None, None) => true,
        (Some(one), Some(other)) => one.fits(other),
        _ => false,
    }
}

fn type_name(data_type: Option<&DataType>) -> String {
    data_type.map_or_else(
        || "nothing".to_owned(),
        |data_type| {
            format!(
                "'{}' ({} bytes, layout {:x})",
                data_type.name, data_type.size, data_type.layout_hash
            )
        },
    )
}
