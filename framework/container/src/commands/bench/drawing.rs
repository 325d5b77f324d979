//! Parts of pictures: what all of them draw by hand, because a crate for plots brings fonts and
//! layouts that a picture in a README has no need of.

use std::fmt::Write as _;

/// A line from one point to another; `dash` as SVG has it, empty for none.
pub(super) fn line(svg: &mut String, [x1, y1, x2, y2]: [f64; 4], colour: &str, dash: &str) {
    let _infallible = writeln!(
        svg,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{colour}\" \
         stroke-dasharray=\"{dash}\"/>"
    );
}

/// A text that is anchored at a point.
pub(super) fn text(svg: &mut String, x: f64, y: f64, anchor: &str, text: &str) {
    let _infallible = writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"
    );
}
