//! One frame as text, or as a picture that needs no terminal: the cells of the buffer as SVG.

use std::fmt::Write as _;

use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};

/// A cell in pixels: the usual ratio of monospaced fonts at a size of 14.
const CELL: (f64, f64) = (8.4, 18.0);
/// Where the text stands in its cell.
const BASELINE: f64 = 13.5;
/// Around the frame.
const MARGIN: f64 = 12.0;

/// Dark, as most terminals are.
const BACKGROUND: &str = "#14181d";
const FOREGROUND: &str = "#d8dee6";

/// The frame as lines of text.
pub(super) fn text(buffer: &Buffer) -> String {
    let rows = buffer
        .content()
        .chunks(usize::from(buffer.area.width).max(1));
    let mut text = String::new();
    for row in rows {
        let line: String = row.iter().map(Cell::symbol).collect();
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// The frame as an SVG document.
pub(super) fn svg(buffer: &Buffer) -> String {
    let (width, height) = (f64::from(buffer.area.width), f64::from(buffer.area.height));
    let (width, height) = (
        width * CELL.0 + 2.0 * MARGIN,
        height * CELL.1 + 2.0 * MARGIN,
    );
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.1} {height:.1}\" \
         width=\"{width:.0}\" height=\"{height:.0}\" font-size=\"14\" \
         font-family=\"DejaVu Sans Mono, Menlo, Consolas, monospace\">\n\
         <title>steadfast top</title>\n\
         <rect width=\"100%\" height=\"100%\" rx=\"8\" fill=\"{BACKGROUND}\"/>\n"
    );
    let rows = buffer
        .content()
        .chunks(usize::from(buffer.area.width).max(1));
    for (row, cells) in rows.enumerate() {
        let mut column = 0;
        // Cells of one style are drawn as one text.
        for run in cells.chunk_by(|one, other| look(one) == look(other)) {
            draw(&mut svg, row, column, run);
            column += run.len();
        }
    }
    svg + "</svg>\n"
}

/// Everything about a cell but its text.
#[derive(Debug, PartialEq, Eq)]
struct Look {
    foreground: &'static str,
    background: &'static str,
    bold: bool,
    dim: bool,
}

fn look(cell: &Cell) -> Look {
    let foreground = colour(cell.fg).unwrap_or(FOREGROUND);
    let background = colour(cell.bg).unwrap_or(BACKGROUND);
    let has = |modifier| cell.modifier.contains(modifier);
    let (foreground, background) = match has(Modifier::REVERSED) {
        true => (background, foreground),
        false => (foreground, background),
    };
    Look {
        foreground,
        background,
        bold: has(Modifier::BOLD),
        dim: has(Modifier::DIM),
    }
}

/// The colours of the view; none for that of the terminal.
fn colour(colour: Color) -> Option<&'static str> {
    match colour {
        Color::Green => Some("#5fbf77"),
        Color::Yellow => Some("#e0b450"),
        Color::Red => Some("#f0655f"),
        Color::DarkGray => Some("#7f8a96"),
        _ => None,
    }
}

fn draw(svg: &mut String, row: usize, column: usize, run: &[Cell]) {
    let Some(look) = run.first().map(look) else {
        return;
    };
    let (x, y) = (
        MARGIN + as_number(column) * CELL.0,
        MARGIN + as_number(row) * CELL.1,
    );
    let width = as_number(run.len()) * CELL.0;
    if look.background != BACKGROUND {
        // Writing to a text does not fail.
        let _infallible = writeln!(
            svg,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{:.1}\" fill=\"{}\"/>",
            CELL.1, look.background
        );
    }
    let text: String = run.iter().map(Cell::symbol).collect();
    if text.trim().is_empty() {
        return;
    }
    let escaped = text.replace('&', "&amp;").replace('<', "&lt;");
    let weight = if look.bold {
        " font-weight=\"bold\""
    } else {
        ""
    };
    let opacity = if look.dim { " opacity=\"0.7\"" } else { "" };
    let _infallible = writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{:.1}\" textLength=\"{width:.1}\" fill=\"{}\"{weight}{opacity} \
         xml:space=\"preserve\">{escaped}</text>",
        y + BASELINE,
        look.foreground
    );
}

/// Columns and rows are 500 at most.
fn as_number(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use ratatui::layout::Rect;
    use ratatui::style::Style;

    use super::*;

    fn buffer() -> Buffer {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 6, 2));
        buffer.set_string(0, 0, "a<&", Style::new().fg(Color::Red));
        buffer.set_string(0, 1, "ok", Style::new().add_modifier(Modifier::REVERSED));
        buffer
    }

    #[test]
    fn a_frame_as_text_has_no_blanks_at_the_end() {
        assert_eq!(text(&buffer()), "a<&\nok\n");
    }

    #[test]
    fn a_frame_as_a_picture_is_well_formed_and_coloured() {
        let svg = svg(&buffer());
        assert!(
            svg.contains("fill=\"#f0655f\" xml:space=\"preserve\">a&lt;&amp;</text>"),
            "{svg}"
        );
        let reversed = format!("height=\"18.0\" fill=\"{FOREGROUND}\"/>");
        assert!(svg.contains(&reversed), "{svg}");
        assert_eq!(svg.matches("<text").count(), 2);
        assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
    }
}
