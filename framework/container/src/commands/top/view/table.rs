//! The table of components.

use ratatui::Frame;
use ratatui::layout::{Alignment, Constraint, Rect};
use ratatui::style::{Modifier, Style};
use ratatui::text::{Line, Text};
use ratatui::widgets::{Block, Borders, Cell, Row, Table, TableState};
use serde_json::Value;

use super::colour;
use crate::commands::top::model::Model;
use crate::commands::words::{number, word};

const HEADINGS: [&str; 9] = [
    "COMPONENT",
    "LEVEL",
    "STATE",
    "TIER",
    "RATE/Hz",
    "LOAD/%",
    "OVER",
    "INC",
    "LAST FAULT",
];

/// Columns whose content is a number.
fn is_number(column: usize) -> bool {
    (4..=7).contains(&column)
}

pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, model: &Model) {
    let longest = model.names.iter().map(|name| name.chars().count()).max();
    let longest = u16::try_from(longest.unwrap_or_default()).unwrap_or(u16::MAX);
    // The name may take a third of a narrow terminal: what follows it matters as much.
    let name_width = longest.clamp(9, (area.width / 3).max(9));
    let widths = [name_width, 5, 9, 7, 7, 6, 4, 3].map(Constraint::Length);
    let widths = widths.into_iter().chain([Constraint::Fill(1)]);
    let rows = model
        .names
        .iter()
        .map(|name| row(name, &model.status["components"][name]));
    let headings = HEADINGS
        .iter()
        .enumerate()
        .map(|(column, heading)| cell(column, heading));
    let title = format!(" {} components ", model.names.len());
    let table = Table::new(rows, widths)
        .header(Row::new(headings).style(Style::new().add_modifier(Modifier::BOLD)))
        .row_highlight_style(Style::new().add_modifier(Modifier::REVERSED))
        .highlight_symbol("> ")
        .block(Block::new().borders(Borders::TOP).title(title));
    let mut state = TableState::new().with_selected(Some(model.chosen));
    frame.render_stateful_widget(table, area, &mut state);
}

fn row<'row>(name: &'row str, one: &Value) -> Row<'row> {
    let level = word(&one["level"]);
    let style = colour(&level);
    let cells = [
        name.to_owned(),
        level,
        word(&one["state"]),
        word(&one["tier"]),
        number(&one["rate_hz"], 1),
        number(&one["load_percent"], 1),
        word(&one["overruns"]),
        word(&one["incarnation"]),
        word(&one["last_fault"]),
    ];
    let cells = cells.iter().enumerate();
    let cells = cells.map(|(column, text)| match column {
        1 | 2 => cell(column, text).style(style),
        _ => cell(column, text),
    });
    Row::new(cells.collect::<Vec<_>>())
}

fn cell(column: usize, text: &str) -> Cell<'static> {
    let alignment = match is_number(column) {
        true => Alignment::Right,
        false => Alignment::Left,
    };
    Cell::new(Text::from(Line::raw(text.to_owned())).alignment(alignment))
}
