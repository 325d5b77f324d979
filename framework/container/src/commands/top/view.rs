//! The picture: a pure function of the model. Colours follow OK, WARN, ERROR and STALE, and every one
//! of them is also a word.

mod dialogs;
mod feed;
mod table;

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::Paragraph;

use super::model::{Dialog, Model};
use crate::commands::status::text;
use crate::commands::words::{number, word};

/// Lines of the head.
const HEAD_HEIGHT: u16 = 2;
/// The feed gets this part of what is left, in percent; components are more important.
const FEED_PERCENT: u16 = 35;

/// Draws the model.
pub fn draw(frame: &mut Frame<'_>, model: &Model) {
    let layout = Layout::vertical([
        Constraint::Length(HEAD_HEIGHT + tree_lines(model)),
        Constraint::Fill(1),
        Constraint::Percentage(FEED_PERCENT),
        Constraint::Length(1),
    ]);
    let [head, components, faults, foot] = layout.areas(frame.area());
    frame.render_widget(Paragraph::new(head_lines(model)), head);
    table::draw(frame, components, model);
    feed::draw(frame, faults, model);
    frame.render_widget(Paragraph::new(foot_line(model, foot)), foot);
    match model.dialog {
        Dialog::None => {}
        Dialog::Help => dialogs::help(frame),
        Dialog::Stop => dialogs::stop(frame, model),
        Dialog::Inject(kind) => dialogs::inject(frame, model, kind),
    }
}

/// The colour of a level or of a state of a fault.
fn colour(word: &str) -> Style {
    match word {
        "OK" | "ACTIVE" | "HEALED" => Style::new().fg(Color::Green),
        "WARN" | "DEGRADED" | "PREFAILED" => Style::new().fg(Color::Yellow),
        "ERROR" | "CONFIRMED" => Style::new().fg(Color::Red).add_modifier(Modifier::BOLD),
        "STALE" | "STOPPED" | "CLEARED" => Style::new().fg(Color::DarkGray),
        _ => Style::new(),
    }
}

fn head_lines(model: &Model) -> Vec<Line<'_>> {
    if let Some((reason, absent)) = &model.absence {
        let seconds = absent.as_secs();
        return vec![
            Line::styled(
                format!("no application answers (for {seconds} s); waiting, q quits"),
                colour("ERROR"),
            ),
            Line::raw(reason.lines().next().unwrap_or_default().to_owned()),
        ];
    }
    let status = &model.status;
    let mut first = Vec::new();
    for (name, state) in status["applications"].as_object().into_iter().flatten() {
        let state = word(state);
        let style = colour(&state);
        first.push(Span::raw(format!("{name} ")));
        first.push(Span::styled(format!("{state}  "), style));
    }
    first.push(Span::raw(format!(
        "{} s {}",
        number(&status["time_s"], 1),
        word(&status["clock"])
    )));
    if status["emergency_stop"] == true {
        let style = colour("ERROR").add_modifier(Modifier::REVERSED);
        first.push(Span::raw("  "));
        first.push(Span::styled(" EMERGENCY STOP ", style));
    }
    let container = &status["container"];
    let second = format!(
        "process {}  up {} s  threads {}  restarts {}  dropped: {} data, {} events",
        word(&container["process"]),
        number(&container["uptime_s"], 0),
        word(&container["threads"]),
        word(&container["restarts"]),
        word(&container["port_data_dropped"]),
        word(&container["events_lost"]),
    );
    let trees = text::trees(&status["trees"]);
    let trees = trees.lines().map(|line| Line::raw(line.to_owned()));
    let lines = [Line::from(first), Line::raw(second)].into_iter();
    lines.chain(trees).collect()
}

/// How many lines behaviour trees take.
fn tree_lines(model: &Model) -> u16 {
    /// More trees than this leave no room for components.
    const MOST: usize = 4;
    let trees = model.status["trees"].as_object().map_or(0, |it| it.len());
    let shown = if model.absence.is_some() { 0 } else { trees };
    u16::try_from(shown.min(MOST)).unwrap_or_default()
}

fn foot_line(model: &Model, area: Rect) -> Line<'_> {
    const KEYS: &str = "↑↓ choose  r reset  s stop  i inject  c clear  ? help  q quit";
    if model.message.is_empty() {
        return Line::styled(KEYS, Style::new().add_modifier(Modifier::DIM));
    }
    let width = usize::from(area.width);
    let message: String = model.message.replace('\n', " ");
    Line::raw(message.chars().take(width).collect::<String>())
}

#[cfg(test)]
mod tests;
