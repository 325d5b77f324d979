//! The feed of faults, the newest first.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Borders, Paragraph};
use serde_json::Value;

use super::colour;
use crate::commands::top::model::Model;
use crate::commands::words::word;

pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, model: &Model) {
    let shown = model.faults.iter().take(usize::from(area.height));
    let lines: Vec<Line<'_>> = match model.faults.is_empty() {
        true => vec![Line::raw("none so far")],
        false => shown.map(line).collect(),
    };
    let block = Block::new()
        .borders(Borders::TOP)
        .title(" faults, newest first ");
    frame.render_widget(Paragraph::new(lines).block(block), area);
}

/// `12.345 s  3 HEALED     camera: segfault; reset camera: done`.
fn line(fault: &Value) -> Line<'static> {
    let time_ns = fault["confirmed_ns"].as_u64().unwrap_or_default();
    let time_s = std::time::Duration::from_nanos(time_ns).as_secs_f64();
    let state = word(&fault["state"]);
    let style = colour(&state);
    let of = fault["cause"].get("consequence_of");
    let cause = of.map_or_else(String::new, |id| format!(" (of {})", word(id)));
    let actions = fault["actions"].as_array();
    let done = actions.and_then(|actions| actions.last()).map(|action| {
        let outcome = word(&action["outcome"]).replace('_', " ");
        format!("; {}: {outcome}", word(&action["action"]))
    });
    Line::from(vec![
        Span::raw(format!("{time_s:9.3} s {:>4} ", word(&fault["id"]))),
        Span::styled(format!("{state:9} "), style),
        Span::raw(format!(
            "{}: {}{cause}{}",
            word(&fault["component"]),
            word(&fault["kind"]),
            done.unwrap_or_default()
        )),
    ])
}
