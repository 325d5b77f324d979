//! A diagram as a picture of its own.

mod boxes;

use std::fmt::Write as _;

use boxes::{Drawn, text_width};

use super::diagram::{Diagram, Edge, EdgeKind, NodeKind};
use super::layout::{Area, Group, Layout, Line, Link, layout};
use crate::commands::explain::escaped;

/// Size of what is written on frames and in the legend.
const SMALL: f64 = 11.0;

/// Height of the title.
const TITLE: f64 = 40.0;

/// Height of the legend.
const LEGEND: f64 = 30.0;

const STYLE: &str = "text { font-family: \"DejaVu Sans\", Verdana, \"Noto Sans CJK KR\", sans-serif; fill: #1c2430 }\n\
    .box { fill: #ffffff; stroke: #4a5a70; stroke-width: 1.2 }\n\
    .actuator { stroke: #9a3412; stroke-width: 2.6 }\n\
    .model { fill: #f4f0fa; stroke: #6b4f9a; stroke-dasharray: 5 3 }\n\
    .voter { fill: #eef6ee; stroke: #3f7d4f }\n\
    .manager { fill: #eef1f5 }\n\
    .frame { fill: #f6f8fb; stroke: #b6c2d2; stroke-dasharray: 2 3 }\n\
    .name { font-weight: bold } .note { fill: #4a5568 } .port { fill: #1f4e79 }\n\
    .line { fill: none; stroke-width: 1.4 }\n\
    .data { stroke: #2b6cb0 } .event { stroke: #b7791f; stroke-dasharray: 7 4 }\n\
    .service { stroke: #2f855a; stroke-dasharray: 1 3; stroke-width: 2.2 }\n\
    .watch { stroke: #6b4f9a; stroke-dasharray: 3 4 }\n";

/// The picture.
pub fn text(diagram: &Diagram) -> String {
    let drawn: Vec<Drawn> = diagram.nodes.iter().map(Drawn::new).collect();
    let edges = || {
        let all = diagram.edges.iter();
        all.filter(|edge| edge.kind != EdgeKind::Dependency)
    };
    let links: Vec<Link> = edges().map(|edge| link(edge, &drawn)).collect();
    let shared = || {
        let all = diagram.executors.iter();
        all.filter(|executor| executor.members.len() > 1)
    };
    let groups: Vec<Group> = shared()
        .map(|executor| Group {
            members: executor.members.clone(),
            label_width: text_width(&executor.label, SMALL),
        })
        .collect();
    let extents: Vec<_> = drawn.iter().map(|one| one.extent).collect();
    let layout = layout(&extents, &links, &groups);
    let labels: Vec<&str> = shared().map(|executor| executor.label.as_str()).collect();
    let mut svg = head(diagram, &layout);
    for (group, area) in &layout.frames {
        svg += &frame(labels[*group], area);
    }
    for (edge, line) in edges().zip(&layout.lines) {
        svg += &path(edge.kind, line);
    }
    for ((node, drawn), area) in diagram.nodes.iter().zip(&drawn).zip(&layout.boxes) {
        svg += &drawn.at(area, class(node.kind));
    }
    svg += &legend(layout.size.height);
    svg += "</g>\n</svg>\n";
    svg
}

fn link(edge: &Edge, drawn: &[Drawn]) -> Link {
    let (source, target) = (&edge.source, &edge.target);
    Link {
        source: source.node,
        source_y: drawn[source.node].output_y(source.port.as_deref()),
        target: target.node,
        target_y: drawn[target.node].input_y(target.port.as_deref()),
    }
}

fn head(diagram: &Diagram, layout: &Layout) -> String {
    let title = escaped(&diagram.title);
    let least = text_width(&diagram.title, 20.0) + 48.0;
    let width = layout.size.width.max(least).max(LEGEND_WIDTH);
    let height = layout.size.height + TITLE + LEGEND;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n\
         <defs>\n{}</defs>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
         <text x=\"24\" y=\"32\" font-size=\"20\" class=\"name\">{title}</text>\n\
         <g transform=\"translate(0 {TITLE})\">\n",
        arrows()
    )
}

/// The head of an arrow in each colour.
fn arrows() -> String {
    let colours = [
        ("data", "#2b6cb0"),
        ("event", "#b7791f"),
        ("service", "#2f855a"),
    ];
    let arrow = |(name, colour): (&str, &str)| {
        format!(
            "<marker id=\"{name}\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" markerWidth=\"7\" \
             markerHeight=\"7\" markerUnits=\"userSpaceOnUse\" orient=\"auto\">\
             <path d=\"M0 0 L8 4 L0 8 z\" fill=\"{colour}\"/></marker>\n"
        )
    };
    colours.into_iter().map(arrow).collect()
}

fn frame(label: &str, area: &Area) -> String {
    let (x, y) = (area.x + 6.0, area.y + 15.0);
    format!(
        "<rect class=\"frame\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" rx=\"6\"/>\n\
         <text class=\"note\" x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{SMALL}\">{}</text>\n",
        area.x,
        area.y,
        area.width,
        area.height,
        escaped(label)
    )
}

fn path(kind: EdgeKind, line: &Line) -> String {
    let mut path = String::new();
    for (index, (x, y)) in line.points.iter().enumerate() {
        let before = index.checked_sub(1).map(|before| line.points[before]);
        let _infallible = match before {
            None => write!(path, "M{x:.1} {y:.1}"),
            Some((_, level)) if line.leads_back || level.to_bits() == y.to_bits() => {
                write!(path, " L{x:.1} {y:.1}")
            }
            Some((left, level)) => {
                let middle = f64::midpoint(left, *x);
                write!(
                    path,
                    " C{middle:.1} {level:.1} {middle:.1} {y:.1} {x:.1} {y:.1}"
                )
            }
        };
    }
    let (class, head) = match kind {
        EdgeKind::Data => ("data", " marker-end=\"url(#data)\""),
        EdgeKind::Event => ("event", " marker-end=\"url(#event)\""),
        EdgeKind::Service => ("service", " marker-end=\"url(#service)\""),
        EdgeKind::Watch | EdgeKind::Dependency => ("watch", ""),
    };
    format!("<path class=\"line {class}\" d=\"{path}\"{head}/>\n")
}

fn class(kind: NodeKind) -> &'static str {
    match kind {
        NodeKind::Component => "box",
        NodeKind::Actuator => "box actuator",
        NodeKind::ProcessModel => "box model",
        NodeKind::Voter => "box voter",
        NodeKind::FaultManager => "box manager",
    }
}

/// What the legend takes.
const LEGEND_WIDTH: f64 = 700.0;

fn legend(y: f64) -> String {
    let y = y + 12.0;
    let mut legend = String::new();
    let kinds = [
        ("data", "data", 0.0),
        ("event", "events", 110.0),
        ("service", "calls", 220.0),
        ("watch", "a process model looks on", 330.0),
    ];
    for (class, words, x) in kinds {
        let (from, to) = (x + 24.0, x + 54.0);
        let _infallible = writeln!(
            legend,
            "<path class=\"line {class}\" d=\"M{from} {y} L{to} {y}\"/>\
             <text class=\"note\" x=\"{}\" y=\"{}\" font-size=\"{SMALL}\">{words}</text>",
            to + 6.0,
            y + 4.0
        );
    }
    let (x, top) = (570.0, y - 6.0);
    let _infallible = writeln!(
        legend,
        "<rect class=\"box actuator\" x=\"{x}\" y=\"{top}\" width=\"26\" height=\"12\" rx=\"2\"/>\
         <text class=\"note\" x=\"{}\" y=\"{}\" font-size=\"{SMALL}\">actuator</text>",
        x + 34.0,
        y + 4.0
    );
    legend
}
