//! A diagram for Mermaid.

use std::fmt::Write as _;

use super::diagram::{Diagram, EdgeKind, Node, NodeKind};

/// A flow chart; executors that run several components are subgraphs, ports stand on the edges.
pub fn text(diagram: &Diagram) -> String {
    let mut text = "flowchart LR\n".to_owned();
    let mut grouped = vec![false; diagram.nodes.len()];
    for (number, executor) in diagram.executors.iter().enumerate() {
        if executor.members.len() > 1 {
            // Writing to memory does not fail.
            let _infallible = writeln!(text, "  subgraph e{number}[{}]", quoted(&executor.label));
            for member in &executor.members {
                grouped[*member] = true;
                let _infallible = writeln!(text, "    {}", node(*member, &diagram.nodes[*member]));
            }
            text += "  end\n";
        }
    }
    for (number, one) in diagram.nodes.iter().enumerate() {
        if !grouped[number] {
            let _infallible = writeln!(text, "  {}", node(number, one));
        }
    }
    for edge in &diagram.edges {
        let ports = [&edge.source.port, &edge.target.port].map(|port| port.as_deref());
        let label = match ports {
            [Some(source), Some(target)] if source != target => format!("{source} to {target}"),
            [Some(port), _] | [None, Some(port)] => port.to_owned(),
            [None, None] => "needs".to_owned(),
        };
        let arrow = match edge.kind {
            EdgeKind::Data => "-->",
            EdgeKind::Event => "-.->",
            EdgeKind::Service => "--o",
            EdgeKind::Watch => "-.-",
            EdgeKind::Dependency => "-.->",
        };
        let (source, target) = (edge.source.node, edge.target.node);
        let _infallible = writeln!(text, "  n{source} {arrow}|{}| n{target}", quoted(&label));
    }
    text
}

fn node(number: usize, node: &Node) -> String {
    let mut label = escaped(&node.name);
    for note in &node.notes {
        label += "<br/>";
        label += &escaped(note);
    }
    match node.kind {
        NodeKind::Component => format!("n{number}[\"{label}\"]"),
        NodeKind::Actuator => format!("n{number}[[\"{label}\"]]"),
        NodeKind::ProcessModel => format!("n{number}([\"{label}\"])"),
        NodeKind::Voter => format!("n{number}{{{{\"{label}\"}}}}"),
        NodeKind::FaultManager => format!("n{number}>\"{label}\"]"),
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", escaped(text))
}

/// Mermaid takes entities by number or name, with `#` for `&`.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '"' => escaped.push_str("#quot;"),
            '#' => escaped.push_str("#35;"),
            '<' => escaped.push_str("#lt;"),
            '>' => escaped.push_str("#gt;"),
            '&' => escaped.push_str("#amp;"),
            letter => escaped.push(letter),
        }
    }
    escaped
}
