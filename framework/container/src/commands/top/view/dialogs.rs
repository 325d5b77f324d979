//! What stands in front of the table.

use ratatui::Frame;
use ratatui::layout::{Constraint, Flex, Layout, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::{Block, Clear, Paragraph};

use crate::commands::top::model::{INJECTIONS, Model};

const HELP: &str = "\
↑ ↓ Home End  choose a component
r             reset it; a stopped one works again
s             stop it, and what needs it (asks first)
i             inject a fault (choose the kind)
c             clear its newest fault, else the newest
?             this help
q, Ctrl-C     quit; the application goes on

LEVEL  OK
       WARN   works; in recovery or an open fault
       ERROR  should run and does not
       STALE  was stopped
LOAD   how much of its period its executor's
       cycle takes; over 100 it runs over";

pub(super) fn help(frame: &mut Frame<'_>) {
    let lines: Vec<Line<'_>> = HELP.lines().map(Line::raw).collect();
    show(frame, " help, any key closes it ", lines);
}

pub(super) fn stop(frame: &mut Frame<'_>, model: &Model) {
    let name = model.chosen_name().unwrap_or_default();
    let lines = vec![
        Line::raw(format!("Stop {name}, and what needs it?")),
        Line::raw("y stops it, any other key does not"),
    ];
    show(frame, " stop ", lines);
}

pub(super) fn inject(frame: &mut Frame<'_>, model: &Model, kind: usize) {
    let name = model.chosen_name().unwrap_or_default();
    let mut lines = vec![Line::raw(format!(
        "Inject into the next callback of {name}:"
    ))];
    for (index, (words, _)) in INJECTIONS.iter().enumerate() {
        lines.push(match index == kind {
            true => Line::styled(
                format!("> {words}"),
                Style::new().add_modifier(Modifier::REVERSED),
            ),
            false => Line::raw(format!("  {words}")),
        });
    }
    lines.push(Line::raw("↑ ↓ choose  Enter inject  Esc leave"));
    show(frame, " inject ", lines);
}

/// A frame around the lines in the middle of the screen, as large as it must be and can be.
fn show(frame: &mut Frame<'_>, title: &str, lines: Vec<Line<'_>>) {
    let width = lines.iter().map(Line::width).max().unwrap_or_default();
    let width = u16::try_from(width.max(title.chars().count()) + 4).unwrap_or(u16::MAX);
    let height = u16::try_from(lines.len() + 2).unwrap_or(u16::MAX);
    let area = middle(frame.area(), width, height);
    frame.render_widget(Clear, area);
    let block = Block::bordered().title(title.to_owned());
    let inside = Rect {
        x: area.x + 2.min(area.width),
        width: area.width.saturating_sub(4),
        ..block.inner(area)
    };
    frame.render_widget(block, area);
    frame.render_widget(Paragraph::new(lines), inside);
}

fn middle(area: Rect, width: u16, height: u16) -> Rect {
    let [area] = Layout::horizontal([Constraint::Length(width)])
        .flex(Flex::Center)
        .areas(area);
    let [area] = Layout::vertical([Constraint::Length(height)])
        .flex(Flex::Center)
        .areas(area);
    area
}
