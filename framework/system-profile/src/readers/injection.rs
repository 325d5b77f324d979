//! `fault_injections`: each injection typed, names as written. What the names mean is found out by
//! `resolve::injections`.

mod kind;
mod timing;

use system_model::injection::{
    CallbackName, ContainerFailure, Distortion, MAX_INJECTIONS, Misbehaviour, WorldFault,
};
use system_model::profile::Located;
use system_model::specification::Place;

use super::header::required_attribute;
use crate::node::Node;
pub(crate) use timing::DeclaredTrigger;
use timing::Timing;

/// The outermost element of an injection file.
pub(crate) const INJECTIONS_ROOT: &str = "fault_injections";

/// The element of one injection; it may also stand alone, in a request to a running system.
pub(crate) const INJECTION: &str = "inject";

/// A file of injections.
#[derive(Debug)]
pub(crate) struct DeclaredInjections {
    /// Name of the application.
    pub(crate) application: Located<String>,
    /// Those that could be understood.
    pub(crate) injections: Vec<DeclaredInjection>,
}

/// One injection, names as written.
#[derive(Debug)]
pub(crate) struct DeclaredInjection {
    pub(crate) component: Option<Located<String>>,
    pub(crate) timing: Timing,
    pub(crate) what: DeclaredFault,
    /// The KIND as written.
    pub(crate) kind: Located<String>,
    pub(crate) place: Place,
}

/// What is to go wrong, names as written.
#[derive(Debug)]
pub(crate) enum DeclaredFault {
    Callback {
        /// Where none is written it has the place of the KIND.
        callback: Located<CallbackName>,
        misbehaviour: Misbehaviour,
    },
    Port {
        port: Located<String>,
        field: Option<String>,
        distortion: Distortion,
    },
    World(WorldFault),
    /// `unplug_sonar` of the component that is named.
    UnplugSonarOfComponent,
    Container(ContainerFailure),
}

/// Reads an injection file.
pub(crate) fn read(root: &Node<'_>) -> Option<DeclaredInjections> {
    let nodes = root.children(INJECTION);
    if nodes.len() > MAX_INJECTIONS {
        root.error(
            format!(
                "{} injections; at most {MAX_INJECTIONS} are read",
                nodes.len()
            ),
            Some("let one injection begin several times: repeat=\"3\" every=\"2s\"".into()),
        );
        return None;
    }
    let injections = DeclaredInjections {
        application: required_attribute(root, "application"),
        injections: nodes.iter().filter_map(injection).collect(),
    };
    root.pass_over(&["name", "version", "description", "copyright"]);
    root.pass_over_attributes(&["name", "version"]);
    root.finish();
    Some(injections)
}

/// Reads one injection; none if something of it is missing or cannot be understood, which has then
/// been reported.
pub(crate) fn injection(node: &Node<'_>) -> Option<DeclaredInjection> {
    let kind = node.required_attribute("fault");
    let component = node.attribute("component").map(|value| value.located());
    let timing = timing::read(node);
    let what = kind
        .as_ref()
        .and_then(|kind| kind::read(node, kind, component.is_some()));
    if what.is_none() {
        // Which attributes belong here depends on a KIND that is not known.
        node.pass_over_attributes(&kind::ATTRIBUTES);
    }
    node.pass_over(&["description"]);
    node.pass_over_attributes(&["description"]);
    node.finish();
    Some(DeclaredInjection {
        component,
        timing: timing?,
        what: what?,
        kind: kind?.located(),
        place: node.place(),
    })
}
