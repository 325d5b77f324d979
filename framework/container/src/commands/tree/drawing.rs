//! A tree as text, as a Mermaid flow chart and as JSON.

use std::fmt::Write as _;

use behavior_tree::definition::NodeClass;
use behavior_tree::{NodeDescription, NodeId, Plan};
use serde_json::{Value, json};

/// One line for each node, children below their parent.
pub(super) fn text(plan: &Plan) -> String {
    let mut text = format!("{}\n", plan.id);
    // Whether further children follow, of each parent up to the root.
    let mut open: Vec<bool> = Vec::new();
    let mut waiting = vec![(NodeId::ROOT, 0, true)];
    while let Some((node, depth, is_last)) = waiting.pop() {
        open.truncate(depth);
        let stem = open.iter().map(|open| if *open { "│  " } else { "   " });
        let stem: String = stem.collect();
        let branch = if is_last { "└─ " } else { "├─ " };
        let line = label(plan.describe(node), true);
        // Writing to memory does not fail.
        let _infallible = writeln!(text, "{stem}{branch}{line}");
        open.push(!is_last);
        let children = plan.children(node);
        let children = children.iter().enumerate().rev();
        let last = plan.children(node).len();
        waiting.extend(children.map(|(at, child)| (*child, depth + 1, at + 1 == last)));
    }
    text
}

/// A flow chart: controls are hexagons, decorators slanted, conditions round, actions boxes.
pub(super) fn mermaid(plan: &Plan) -> String {
    let mut text = "flowchart TD\n".to_owned();
    for node in plan.node_ids() {
        let description = plan.describe(node);
        let label = label(description, false).replace('"', "#quot;");
        let (begin, end) = match description.class {
            NodeClass::Control => ("{{", "}}"),
            NodeClass::Decorator => ("[/", "/]"),
            NodeClass::Condition => ("(", ")"),
            NodeClass::SubTree => ("[[", "]]"),
            NodeClass::Action => ("[", "]"),
        };
        let id = node.index();
        // Writing to memory does not fail.
        let _infallible = writeln!(text, "  n{id}{begin}\"{label}\"{end}");
        for child in plan.children(node) {
            let _infallible = writeln!(text, "  n{id} --> n{}", child.index());
        }
    }
    text
}

/// All that is known of each node.
pub(super) fn json(plan: &Plan) -> Value {
    let nodes = plan.node_ids().map(|node| {
        let description = plan.describe(node);
        let children = plan.children(node).iter().map(|child| child.index());
        json!({
            "number": node.index(),
            "kind": description.id,
            "name": description.name,
            "path": description.path,
            "class": description.class.name(),
            "stub": description.is_stub,
            "ports": pairs(description.ports.iter().map(|(name, value)| (name, json!(value)))),
            "conditions": pairs(description.conditions.iter().map(|(name, value)| (name, json!(value)))),
            "children": children.collect::<Vec<_>>(),
            "file": description.place.file.to_string_lossy(),
            "line": description.place.line,
            "column": description.place.column,
        })
    });
    json!({ "tree": plan.id, "nodes": nodes.collect::<Value>() })
}

fn pairs<'a>(pairs: impl Iterator<Item = (&'a String, Value)>) -> Value {
    Value::Object(pairs.map(|(name, value)| (name.clone(), value)).collect())
}

fn label(node: &NodeDescription, with_ports: bool) -> String {
    let mut label = match node.class {
        NodeClass::SubTree => format!("SubTree {}", node.id),
        _ => node.id.clone(),
    };
    if node.name != node.id {
        label.push_str(&format!(" \"{}\"", node.name));
    }
    if !with_ports {
        return label;
    }
    let said = node.ports.iter();
    let said = said.filter_map(|(name, value)| Some((name, value.as_ref()?)));
    for (name, value) in said.chain(node.conditions.iter().map(|(name, value)| (name, value))) {
        label.push_str(&format!(" {name}={value}"));
    }
    label
}
