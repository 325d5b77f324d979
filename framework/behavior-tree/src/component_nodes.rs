//! Nodes whose work is done with the components of a running system: what they are called, and what
//! their ports mean. Whoever has the components implements them as [`Leaf`](crate::Leaf).
//!
//! Names of components, ports, fields and the like are fixed when a tree is assembled: they stand in
//! the file, or come from the sub-tree's attribute that the port refers to.

use std::sync::LazyLock;

use system_model::profile::Located;
use system_model::specification::Place;

use crate::definition::{Direction, NodeClass, NodeModel, PortModel};

/// A node over components.
#[derive(Debug, Clone, Copy)]
pub struct ComponentNode {
    /// The name in files.
    pub id: &'static str,
    /// What it does.
    pub kind: ComponentNodeKind,
    /// Whether it only looks.
    pub is_condition: bool,
    /// Its ports.
    pub ports: &'static [ComponentPort],
}

/// What a node does with components.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ComponentNodeKind {
    /// Starts a component that was stopped; SUCCESS once it works.
    Start,
    /// Stops a component, and what needs it; SUCCESS once it is stopped.
    Stop,
    /// Resets a component; SUCCESS once it works again.
    Reset,
    /// Puts a secondary in a component's place; SUCCESS once that works.
    Replace,
    /// Executor of a Module: starts a component, is RUNNING while it works, and stops it when halted.
    Run,
    /// SUCCESS once a datum arrives that was sent after the node began.
    WaitForData,
    /// SUCCESS once an event arrives that was raised after the node began.
    WaitForEvent,
    /// Puts a field of the newest datum on the blackboard; FAILURE if there is none, or it is too old.
    ReadPort,
    /// Sends a datum to an input port that nobody else sends to.
    WritePort,
    /// Raises an event at an input event port.
    RaiseEvent,
    /// Calls a method that a component provides; SUCCESS once it has answered.
    CallService,
    /// Reports a fault: of a component, or of the tree itself.
    RaiseFault,
    /// SUCCESS once a fault is present.
    AwaitFault,
    /// Ends what has healed or is latched.
    ClearFault,
    /// SUCCESS if a component works, else FAILURE.
    Works,
    /// SUCCESS if a component is in a state of its life cycle.
    InState,
    /// SUCCESS if a confirmed fault is present.
    FaultPresent,
    /// Evaluator of a Module: how old the newest datum is, or the newest whose field has a value, as a
    /// share of what is tolerated; RUNNING.
    EvaluateAge,
    /// Evaluator of a Module: how far a field is from its target, as a share of what is tolerated;
    /// RUNNING.
    EvaluateDeviation,
    /// Estimator of a Module: whether a component could work, and at what cost.
    Estimate,
}

/// A port of such a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ComponentPort {
    /// The name in files.
    pub name: &'static str,
    /// What stands there.
    pub meaning: PortMeaning,
    /// What holds if a file does not say.
    pub default: Option<&'static str>,
    /// Whether a file must say.
    pub is_required: bool,
}

/// What stands at a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PortMeaning {
    /// Name of a component; fixed.
    Component,
    /// Name of one of its output data ports; fixed.
    DataOutput,
    /// Name of one of its input data ports; fixed.
    DataInput,
    /// Name of one of its output event ports; fixed.
    EventOutput,
    /// Name of one of its input event ports; fixed.
    EventInput,
    /// Name of one of its provided service ports; fixed.
    Service,
    /// Another name or word, which the container looks up; fixed.
    Word,
    /// One of these words; fixed.
    Choice(&'static [&'static str]),
    /// A number that is not negative, or an entry of the blackboard.
    Number,
    /// Anything, or an entry of the blackboard.
    Any,
    /// An entry of the blackboard that is written.
    Entry,
}

impl PortMeaning {
    /// Whether the value must be known when the tree is assembled.
    pub fn is_fixed(self) -> bool {
        !matches!(self, Self::Number | Self::Any | Self::Entry)
    }
}

const fn required(name: &'static str, meaning: PortMeaning) -> ComponentPort {
    ComponentPort {
        name,
        meaning,
        default: None,
        is_required: true,
    }
}

const fn optional(name: &'static str, meaning: PortMeaning) -> ComponentPort {
    ComponentPort {
        is_required: false,
        ..required(name, meaning)
    }
}

const fn default(name: &'static str, meaning: PortMeaning, value: &'static str) -> ComponentPort {
    ComponentPort {
        default: Some(value),
        ..optional(name, meaning)
    }
}

const COMPONENT: ComponentPort = required("component", PortMeaning::Component);

/// Longer than any recovery that is not stuck, short enough for a person who waits.
const TIMEOUT: ComponentPort = default("timeout_ms", PortMeaning::Number, "5000");

/// The states of a component's life cycle, as profiles and records name them.
const STATES: &[&str] = &[
    "CREATED",
    "READY",
    "ACTIVE",
    "INACTIVE",
    "ERROR",
    "DESTROYED",
];

const fn action(
    id: &'static str,
    kind: ComponentNodeKind,
    ports: &'static [ComponentPort],
) -> ComponentNode {
    ComponentNode {
        id,
        kind,
        is_condition: false,
        ports,
    }
}

const fn condition(
    id: &'static str,
    kind: ComponentNodeKind,
    ports: &'static [ComponentPort],
) -> ComponentNode {
    ComponentNode {
        is_condition: true,
        ..action(id, kind, ports)
    }
}

/// All of them.
pub const COMPONENT_NODES: &[ComponentNode] = {
    use ComponentNodeKind as Kind;
    use PortMeaning as Means;
    &[
        action("StartComponent", Kind::Start, &[COMPONENT, TIMEOUT]),
        action("StopComponent", Kind::Stop, &[COMPONENT, TIMEOUT]),
        action("ResetComponent", Kind::Reset, &[COMPONENT, TIMEOUT]),
        action(
            "ReplaceComponent",
            Kind::Replace,
            &[COMPONENT, optional("secondary", Means::Word), TIMEOUT],
        ),
        action(
            "RunComponent",
            Kind::Run,
            &[
                COMPONENT,
                TIMEOUT,
                default("overlap_ms", Means::Number, "0"),
            ],
        ),
        action(
            "WaitForData",
            Kind::WaitForData,
            &[COMPONENT, required("port", Means::DataOutput), TIMEOUT],
        ),
        action(
            "WaitForEvent",
            Kind::WaitForEvent,
            &[COMPONENT, required("port", Means::EventOutput), TIMEOUT],
        ),
        action(
            "ReadPort",
            Kind::ReadPort,
            &[
                COMPONENT,
                required("port", Means::DataOutput),
                required("field", Means::Word),
                required("value", Means::Entry),
                optional("max_age_ms", Means::Number),
            ],
        ),
        action(
            "WritePort",
            Kind::WritePort,
            &[
                COMPONENT,
                required("port", Means::DataInput),
                required("field", Means::Word),
                required("value", Means::Any),
            ],
        ),
        action(
            "RaiseEvent",
            Kind::RaiseEvent,
            &[COMPONENT, required("port", Means::EventInput)],
        ),
        action(
            "CallService",
            Kind::CallService,
            &[
                COMPONENT,
                required("port", Means::Service),
                required("method", Means::Word),
                optional("field", Means::Word),
                optional("value", Means::Any),
                optional("reply_field", Means::Word),
                optional("reply", Means::Entry),
                default("timeout_ms", Means::Number, "1000"),
            ],
        ),
        action(
            "RaiseFault",
            Kind::RaiseFault,
            &[
                optional("component", Means::Component),
                required("message", Means::Any),
            ],
        ),
        action(
            "AwaitFault",
            Kind::AwaitFault,
            &[COMPONENT, optional("kind", Means::Word), TIMEOUT],
        ),
        action(
            "ClearFault",
            Kind::ClearFault,
            &[COMPONENT, optional("kind", Means::Word)],
        ),
        condition("ComponentWorks", Kind::Works, &[COMPONENT]),
        condition(
            "ComponentInState",
            Kind::InState,
            &[COMPONENT, required("state", Means::Choice(STATES))],
        ),
        condition(
            "FaultPresent",
            Kind::FaultPresent,
            &[COMPONENT, optional("kind", Means::Word)],
        ),
        action(
            "EvaluateAge",
            Kind::EvaluateAge,
            &[
                COMPONENT,
                required("port", Means::DataOutput),
                optional("field", Means::Word),
                optional("target", Means::Any),
                required("max_age_ms", Means::Number),
                required("cost", Means::Entry),
            ],
        ),
        action(
            "EvaluateDeviation",
            Kind::EvaluateDeviation,
            &[
                COMPONENT,
                required("port", Means::DataOutput),
                required("field", Means::Word),
                required("target", Means::Any),
                required("tolerance", Means::Number),
                required("cost", Means::Entry),
            ],
        ),
        action(
            "EstimateComponent",
            Kind::Estimate,
            &[
                COMPONENT,
                default("performance", Means::Number, "0.5"),
                default("resource", Means::Number, "0.5"),
                optional("performance_cost", Means::Entry),
                optional("resource_cost", Means::Entry),
            ],
        ),
    ]
};

/// The node of a name.
pub fn component_node(id: &str) -> Option<&'static ComponentNode> {
    COMPONENT_NODES.iter().find(|node| node.id == id)
}

/// What a palette would say of them.
pub(crate) fn models() -> &'static [NodeModel] {
    static MODELS: LazyLock<Vec<NodeModel>> =
        LazyLock::new(|| COMPONENT_NODES.iter().map(model).collect());
    &MODELS
}

fn model(node: &ComponentNode) -> NodeModel {
    let located = |name: &str| Located {
        value: name.to_owned(),
        place: Place::default(),
    };
    let port = |port: &ComponentPort| PortModel {
        name: located(port.name),
        direction: match port.meaning {
            PortMeaning::Entry => Direction::Output,
            _ => Direction::Input,
        },
        default: port.default.map(str::to_owned),
    };
    NodeModel {
        id: located(node.id),
        class: match node.is_condition {
            true => NodeClass::Condition,
            false => NodeClass::Action,
        },
        ports: node.ports.iter().map(port).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::BUILT_IN;

    #[test]
    fn no_name_is_taken_twice() {
        for (number, node) in COMPONENT_NODES.iter().enumerate() {
            let before = COMPONENT_NODES[..number].iter().map(|other| other.id);
            let mut others = before.chain(BUILT_IN.iter().map(|other| other.id));
            assert!(others.all(|other| other != node.id), "{}", node.id);
        }
    }

    #[test]
    fn what_a_file_need_not_say_can_be_read() {
        let ports = COMPONENT_NODES.iter().flat_map(|node| node.ports);
        for (port, default) in ports.filter_map(|port| Some((port, port.default?))) {
            assert!(!port.is_required, "{}", port.name);
            match port.meaning {
                PortMeaning::Number => assert!(default.parse::<f64>().is_ok_and(|it| it >= 0.0)),
                PortMeaning::Choice(words) => assert!(words.contains(&default)),
                _ => {}
            }
        }
    }
}
