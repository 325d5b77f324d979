//! A diagram for Graphviz.

use std::fmt::Write as _;

use super::diagram::{Diagram, Edge, EdgeKind, End, Node, NodeKind};

/// The graph in the DOT language; executors that run several components are clusters.
pub fn text(diagram: &Diagram) -> String {
    let mut text = format!(
        "digraph {} {{\n  rankdir=LR;\n  node [shape=record, fontname=\"sans-serif\", fontsize=10];\n  \
         edge [fontname=\"sans-serif\", fontsize=9];\n",
        quoted(&diagram.title)
    );
    for (number, executor) in diagram.executors.iter().enumerate() {
        if executor.members.len() > 1 {
            // Writing to memory does not fail.
            let _infallible = writeln!(
                text,
                "  subgraph \"cluster_{number}\" {{\n    label={};\n    style=rounded;",
                quoted(&executor.label)
            );
            for member in &executor.members {
                let _infallible = writeln!(text, "    n{member};");
            }
            text += "  }\n";
        }
    }
    for (number, node) in diagram.nodes.iter().enumerate() {
        let _infallible = writeln!(
            text,
            "  n{number} [label={}{}];",
            quoted(&label(node)),
            look(node.kind)
        );
    }
    for edge in &diagram.edges {
        text += &line(diagram, edge);
    }
    text += "}\n";
    text
}

/// Inputs, name with notes, outputs; ports are called `i0`, `i1`, ..., `o0`, `o1`, ...
fn label(node: &Node) -> String {
    let ports = |names: &[String], letter: char| {
        let fields = names.iter().enumerate();
        let fields: Vec<String> = fields
            .map(|(index, name)| format!("<{letter}{index}> {}", field(name)))
            .collect();
        format!("{{{}}}", fields.join("|"))
    };
    let mut middle = field(&node.name);
    for note in &node.notes {
        middle += "\\n";
        middle += &field(note);
    }
    match (node.inputs.as_slice(), node.outputs.as_slice()) {
        ([], []) => middle,
        (inputs, []) => format!("{{{}|{middle}}}", ports(inputs, 'i')),
        ([], outputs) => format!("{{{middle}|{}}}", ports(outputs, 'o')),
        (inputs, outputs) => {
            format!(
                "{{{}|{middle}|{}}}",
                ports(inputs, 'i'),
                ports(outputs, 'o')
            )
        }
    }
}

fn look(kind: NodeKind) -> &'static str {
    match kind {
        NodeKind::Component => "",
        NodeKind::Actuator => ", penwidth=2",
        NodeKind::ProcessModel | NodeKind::Voter => ", style=dashed",
        NodeKind::FaultManager => ", style=filled, fillcolor=\"#eef1f5\"",
    }
}

fn line(diagram: &Diagram, edge: &Edge) -> String {
    let look = match edge.kind {
        EdgeKind::Data => "",
        EdgeKind::Event => " [style=dashed, arrowhead=vee]",
        EdgeKind::Service => " [arrowhead=odot]",
        EdgeKind::Watch => " [style=dotted, arrowhead=none]",
        EdgeKind::Dependency => {
            " [style=dotted, arrowhead=empty, label=\"needs\", constraint=false]"
        }
    };
    format!(
        "  {} -> {}{look};\n",
        end(diagram, &edge.source),
        end(diagram, &edge.target)
    )
}

fn end(diagram: &Diagram, end: &End) -> String {
    let node = &diagram.nodes[end.node];
    let find = |names: &[String]| {
        let port = end.port.as_ref()?;
        names.iter().position(|name| name == port)
    };
    let number = end.node;
    match (find(&node.inputs), find(&node.outputs)) {
        (Some(index), _) => format!("n{number}:i{index}"),
        (None, Some(index)) => format!("n{number}:o{index}"),
        (None, None) => format!("n{number}"),
    }
}

/// A quoted identifier; backslashes are those of escapes already.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\\\""))
}

/// Text in a field of a record, in which some characters mean something.
fn field(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        if matches!(letter, '\\' | '{' | '}' | '|' | '<' | '>' | ' ') {
            escaped.push('\\');
        }
        escaped.push(letter);
    }
    escaped
}
