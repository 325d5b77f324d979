//! A supposition as a person writes it: `obstacle_avoidance segfault`, `front_sonar.range drop`.

use system_model::specification::{PortDirection, PortKind};

use super::InputPort;
use super::supposition::{Inapplicable, SupposedFault, Supposition};
use crate::system::Scope;

/// Why a question is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum QueryError {
    /// It is not of the form `COMPONENT FAULT` or `COMPONENT.PORT FAULT`.
    #[error(
        "'{0}' is no question: write \"COMPONENT FAULT\", or \"COMPONENT.PORT FAULT\" for a fault of data"
    )]
    Form(String),
    /// It names no input data port.
    #[error("'{0}' is no input data port: write COMPONENT.PORT")]
    Input(String),
    /// No application has such a component.
    #[error("there is no component '{name}'; there are: {known}")]
    Component {
        /// The name as written.
        name: String,
        /// All components.
        known: String,
    },
    /// Several applications have such a component.
    #[error("several applications have a component '{name}': write APPLICATION/{name}")]
    Ambiguous {
        /// The name as written.
        name: String,
    },
    /// There is no such fault.
    #[error("there is no fault '{name}'; there are: {known}")]
    Fault {
        /// The name as written.
        name: String,
        /// All faults.
        known: String,
    },
    /// The component cannot have it.
    #[error(transparent)]
    Inapplicable(#[from] Inapplicable),
}

/// Reads `COMPONENT FAULT` or `COMPONENT.PORT FAULT`; a component may be called
/// `APPLICATION/COMPONENT`.
///
/// # Errors
/// What is not understood, or why the component cannot have the fault.
pub fn parse(scopes: &[Scope], text: &str) -> Result<Supposition, QueryError> {
    let mut words = text.split_whitespace();
    let (Some(subject), Some(fault), None) = (words.next(), words.next(), words.next()) else {
        return Err(QueryError::Form(text.to_owned()));
    };
    let fault = SupposedFault::find(fault).ok_or_else(|| QueryError::Fault {
        name: fault.to_owned(),
        known: SupposedFault::ALL.map(SupposedFault::name).join(", "),
    })?;
    let (application, component, port) = subject_of(scopes, subject)?;
    let supposition = Supposition {
        application,
        component,
        port,
        fault,
    };
    supposition.check(scopes)?;
    Ok(supposition)
}

/// Finds a component by its name: application and component.
///
/// # Errors
/// That there is none of that name, or several.
pub fn find(scopes: &[Scope], name: &str) -> Result<(usize, usize), QueryError> {
    component(scopes, name)?.ok_or_else(|| unknown(scopes, name))
}

/// Reads `COMPONENT.PORT`, an input data port.
///
/// # Errors
/// What is not understood, or that there is no such port.
pub fn input_port(scopes: &[Scope], text: &str) -> Result<InputPort, QueryError> {
    let (application, component, port) = subject_of(scopes, text.trim())?;
    let own = &scopes[application].specification.components[component];
    let port = port.ok_or_else(|| QueryError::Input(text.to_owned()))?;
    let is_meant = |kind: PortKind, direction: PortDirection, name: &str| {
        kind == PortKind::Data && direction == PortDirection::Input && name == port
    };
    let known = own.ports.iter();
    if !known
        .clone()
        .any(|it| is_meant(it.kind, it.direction, &it.name))
    {
        return Err(QueryError::Input(text.to_owned()));
    }
    Ok(InputPort {
        application,
        component,
        port,
    })
}

/// Application, component, port. Names of components may have dots of their own.
fn subject_of(
    scopes: &[Scope],
    subject: &str,
) -> Result<(usize, usize, Option<String>), QueryError> {
    if let Some((application, component)) = component(scopes, subject)? {
        return Ok((application, component, None));
    }
    if let Some((name, port)) = subject.rsplit_once('.')
        && let Some((application, component)) = component(scopes, name)?
    {
        return Ok((application, component, Some(port.to_owned())));
    }
    let name = subject.rsplit_once('.').map_or(subject, |(name, _)| name);
    Err(unknown(scopes, name))
}

fn unknown(scopes: &[Scope], name: &str) -> QueryError {
    let names = scopes.iter().flat_map(|it| &it.specification.components);
    let names: Vec<&str> = names.map(|component| component.name.as_str()).collect();
    QueryError::Component {
        name: name.to_owned(),
        known: names.join(", "),
    }
}

fn component(scopes: &[Scope], name: &str) -> Result<Option<(usize, usize)>, QueryError> {
    let all = scopes.iter().enumerate().flat_map(|(application, scope)| {
        let components = scope.specification.components.iter().enumerate();
        components.map(move |(index, component)| (application, index, scope, component))
    });
    let mut found = all.filter(|(.., scope, component)| {
        let own = component.name == name;
        let of_application = name
            .strip_prefix(scope.specification.name.as_str())
            .and_then(|rest| rest.strip_prefix('/'));
        own || of_application == Some(component.name.as_str())
    });
    let first = found
        .next()
        .map(|(application, index, ..)| (application, index));
    match found.next() {
        Some(_) => Err(QueryError::Ambiguous {
            name: name.to_owned(),
        }),
        None => Ok(first),
    }
}
