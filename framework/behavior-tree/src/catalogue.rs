//! The nodes that are built in: what they are called, how many children they have, what their ports are.

use crate::definition::{Direction, Format, NodeClass};
use crate::plan::Kind;

/// A node that is built in.
#[derive(Debug, Clone, Copy)]
pub struct BuiltIn {
    /// The name in files.
    pub id: &'static str,
    /// What it is.
    pub class: NodeClass,
    /// The fewest and the most children it may have.
    pub children: (usize, usize),
    /// Its ports.
    pub ports: &'static [Port],
    pub(crate) kind: Kind,
}

/// A port of a node that is built in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Port {
    /// The name in files.
    pub name: &'static str,
    /// Which way data go.
    pub direction: Direction,
    /// What is expected there.
    pub content: Content,
    /// What holds if a file does not say; `None` for a port that may be left out and is nothing then.
    pub default: Option<&'static str>,
    /// Whether a file must say.
    pub is_required: bool,
}

/// What is expected at a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// Anything.
    Any,
    /// A number.
    Number,
    /// `true` or `false`.
    Boolean,
    /// The word of a status.
    Status,
    /// The name of an entry of the blackboard, with or without braces.
    Entry,
    /// A script.
    Script,
}

const fn input(name: &'static str, content: Content) -> Port {
    Port {
        name,
        direction: Direction::Input,
        content,
        default: None,
        is_required: false,
    }
}

const fn required(name: &'static str, content: Content) -> Port {
    Port {
        is_required: true,
        ..input(name, content)
    }
}

const fn default(name: &'static str, content: Content, value: &'static str) -> Port {
    Port {
        default: Some(value),
        ..input(name, content)
    }
}

const fn written(name: &'static str, direction: Direction) -> Port {
    Port {
        direction,
        ..input(name, Content::Any)
    }
}

const fn leaf(id: &'static str, kind: Kind, ports: &'static [Port]) -> BuiltIn {
    BuiltIn {
        id,
        class: NodeClass::Action,
        children: (0, 0),
        ports,
        kind,
    }
}

const fn condition(id: &'static str, kind: Kind, ports: &'static [Port]) -> BuiltIn {
    BuiltIn {
        class: NodeClass::Condition,
        ..leaf(id, kind, ports)
    }
}

const fn decorator(id: &'static str, kind: Kind, ports: &'static [Port]) -> BuiltIn {
    BuiltIn {
        id,
        class: NodeClass::Decorator,
        children: (1, 1),
        ports,
        kind,
    }
}

const fn control(
    id: &'static str,
    kind: Kind,
    children: (usize, usize),
    ports: &'static [Port],
) -> BuiltIn {
    BuiltIn {
        id,
        class: NodeClass::Control,
        children,
        ports,
        kind,
    }
}

/// A control node may have as many children as a file has elements.
const MANY: (usize, usize) = (1, usize::MAX);

const SWITCH: &[Port] = &[
    input("variable", Content::Any),
    input("case_1", Content::Any),
    input("case_2", Content::Any),
    input("case_3", Content::Any),
    input("case_4", Content::Any),
    input("case_5", Content::Any),
    input("case_6", Content::Any),
];

const LOOP: &[Port] = &[
    required("queue", Content::Any),
    default("if_empty", Content::Status, "SUCCESS"),
    written("value", Direction::Both),
];

const ENTRY: &[Port] = &[required("entry", Content::Entry)];

const WEIGHTS: &[Port] = &[
    required("performance_weight", Content::Number),
    required("resource_weight", Content::Number),
    default("retries", Content::Number, "3"),
    default("fallback_no_reconfig", Content::Boolean, "false"),
];

const COSTS: &[Port] = &[
    input("performance_cost", Content::Any),
    input("resource_cost", Content::Any),
];

/// All of them.
pub const BUILT_IN: &[BuiltIn] = &[
    control("Sequence", Kind::Sequence, MANY, &[]),
    control("AsyncSequence", Kind::AsyncSequence, MANY, &[]),
    control("SequenceWithMemory", Kind::SequenceWithMemory, MANY, &[]),
    control("ReactiveSequence", Kind::ReactiveSequence, MANY, &[]),
    control("Fallback", Kind::Fallback, MANY, &[]),
    control("AsyncFallback", Kind::AsyncFallback, MANY, &[]),
    control("ReactiveFallback", Kind::ReactiveFallback, MANY, &[]),
    control("IfThenElse", Kind::IfThenElse, (2, 3), &[]),
    control("WhileDoElse", Kind::WhileDoElse, (2, 3), &[]),
    control("TryCatch", Kind::TryCatch, (2, usize::MAX), &[]),
    control(
        "Parallel",
        Kind::Parallel,
        MANY,
        &[
            default("success_count", Content::Number, "-1"),
            default("failure_count", Content::Number, "1"),
        ],
    ),
    control(
        "ParallelAll",
        Kind::ParallelAll,
        MANY,
        &[default("max_failures", Content::Number, "1")],
    ),
    control("Switch2", Kind::Switch, (3, 3), SWITCH.split_at(3).0),
    control("Switch3", Kind::Switch, (4, 4), SWITCH.split_at(4).0),
    control("Switch4", Kind::Switch, (5, 5), SWITCH.split_at(5).0),
    control("Switch5", Kind::Switch, (6, 6), SWITCH.split_at(6).0),
    control("Switch6", Kind::Switch, (7, 7), SWITCH),
    control(
        "RecoveryNode",
        Kind::Recovery,
        (2, 2),
        &[default("number_of_retries", Content::Number, "1")],
    ),
    control("PipelineSequence", Kind::PipelineSequence, MANY, &[]),
    control("RoundRobin", Kind::RoundRobin, MANY, &[]),
    control("NonblockingSequence", Kind::NonblockingSequence, MANY, &[]),
    control(
        "PersistentSequence",
        Kind::PersistentSequence,
        MANY,
        &[written("current_child_idx", Direction::Both)],
    ),
    control("ReFRESH_Module", Kind::Module, (1, 3), COSTS),
    control("ReFRESH_Decider", Kind::Decider, MANY, WEIGHTS),
    control("ReFRESH_Reactor", Kind::Reactor, MANY, WEIGHTS),
    decorator("Inverter", Kind::Inverter, &[]),
    decorator("ForceSuccess", Kind::ForceSuccess, &[]),
    decorator("ForceFailure", Kind::ForceFailure, &[]),
    decorator(
        "Repeat",
        Kind::Repeat,
        &[required("num_cycles", Content::Number)],
    ),
    decorator(
        "RetryUntilSuccessful",
        Kind::Retry,
        &[required("num_attempts", Content::Number)],
    ),
    decorator(
        "Timeout",
        Kind::Timeout,
        &[required("msec", Content::Number)],
    ),
    decorator(
        "Delay",
        Kind::Delay,
        &[required("delay_msec", Content::Number)],
    ),
    decorator(
        "KeepRunningUntilFailure",
        Kind::KeepRunningUntilFailure,
        &[],
    ),
    decorator(
        "RunOnce",
        Kind::RunOnce,
        &[default("then_skip", Content::Boolean, "true")],
    ),
    decorator(
        "Precondition",
        Kind::Precondition,
        &[
            required("if", Content::Script),
            default("else", Content::Status, "FAILURE"),
        ],
    ),
    decorator("SkipUnlessUpdated", Kind::SkipUnlessUpdated, ENTRY),
    decorator("WaitValueUpdate", Kind::WaitValueUpdate, ENTRY),
    decorator("LoopInt", Kind::Loop, LOOP),
    decorator("LoopBool", Kind::Loop, LOOP),
    decorator("LoopDouble", Kind::Loop, LOOP),
    decorator("LoopString", Kind::Loop, LOOP),
    decorator(
        "RateController",
        Kind::RateController,
        &[default("hz", Content::Number, "10")],
    ),
    decorator("SingleTrigger", Kind::SingleTrigger, &[]),
    leaf("AlwaysSuccess", Kind::AlwaysSuccess, &[]),
    leaf("AlwaysFailure", Kind::AlwaysFailure, &[]),
    leaf("Script", Kind::Script, &[required("code", Content::Script)]),
    condition(
        "ScriptCondition",
        Kind::ScriptCondition,
        &[required("code", Content::Script)],
    ),
    leaf(
        "SetBlackboard",
        Kind::SetBlackboard,
        &[
            required("value", Content::Any),
            required("output_key", Content::Entry),
        ],
    ),
    leaf(
        "UnsetBlackboard",
        Kind::UnsetBlackboard,
        &[required("key", Content::Entry)],
    ),
    leaf("Sleep", Kind::Sleep, &[required("msec", Content::Number)]),
    condition("WasEntryUpdated", Kind::WasEntryUpdated, ENTRY),
];

/// The node of a name, in a file of a format.
pub fn built_in(id: &str, format: Format) -> Option<&'static BuiltIn> {
    // Names of BehaviorTree.CPP 2 and 3, and their meaning today.
    let id = match (format, id) {
        (Format::V3, "SequenceStar") => "SequenceWithMemory",
        (Format::V3, "FallbackStar") => "Fallback",
        (Format::V3, "ParallelNode") => "Parallel",
        (Format::V3, "RetryUntilSuccesful") => "RetryUntilSuccessful",
        (_, id) => id,
    };
    BUILT_IN.iter().find(|node| node.id == id)
}

/// A port's name today, in a file of a format.
pub(crate) fn port_name(format: Format, node: &BuiltIn, name: &str) -> &'static str {
    let renamed = match (format, node.kind, name) {
        (Format::V3, Kind::Parallel, "success_threshold" | "threshold") => "success_count",
        (Format::V3, Kind::Parallel, "failure_threshold") => "failure_count",
        (_, _, name) => name,
    };
    let found = node.ports.iter().find(|port| port.name == renamed);
    found.map_or("", |port| port.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_defaults_can_be_read() {
        for (number, node) in BUILT_IN.iter().enumerate() {
            let twice = BUILT_IN[..number].iter().any(|other| other.id == node.id);
            assert!(!twice, "{}", node.id);
            for port in node.ports {
                let Some(default) = port.default else {
                    continue;
                };
                let fits = match port.content {
                    Content::Number => default.parse::<f64>().is_ok(),
                    Content::Boolean => default.parse::<bool>().is_ok(),
                    Content::Status => crate::Status::named(default).is_some(),
                    _ => false,
                };
                assert!(fits, "{}.{}", node.id, port.name);
            }
        }
    }

    #[test]
    fn old_names_mean_what_they_meant() {
        for (old, new) in [
            ("SequenceStar", "SequenceWithMemory"),
            ("FallbackStar", "Fallback"),
            ("RetryUntilSuccesful", "RetryUntilSuccessful"),
        ] {
            assert_eq!(built_in(old, Format::V3).map(|node| node.id), Some(new));
            assert!(built_in(old, Format::V4).is_none(), "{old}");
        }
        let parallel = built_in("ParallelNode", Format::V3).expect("known");
        assert_eq!(
            port_name(Format::V3, parallel, "threshold"),
            "success_count"
        );
        assert_eq!(port_name(Format::V4, parallel, "threshold"), "");
    }
}
