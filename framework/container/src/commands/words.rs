//! Answers of a running application as a person reads them. What comes is another program's: a part
//! that is missing or of another kind is shown as it is, or not at all.

use std::fmt::Write as _;

use serde_json::Value;

/// One word or number, without anything that a terminal would obey.
pub fn word(value: &Value) -> String {
    let text = match value {
        Value::Null => return String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    text.replace(char::is_control, "\u{FFFD}")
}

/// A number with so many digits behind the point; empty for anything else.
pub fn number(value: &Value, digits: usize) -> String {
    let number = value.as_f64();
    number.map_or_else(String::new, |number| format!("{number:.digits$}"))
}

/// A table whose first row are the headings; the columns that are named are flush right.
pub fn table<const COLUMNS: usize>(
    rows: &[[String; COLUMNS]],
    right: impl Fn(usize) -> bool,
) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: Vec<usize> = (0..COLUMNS).filter_map(width).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).enumerate();
        let cells: Vec<String> = cells
            .map(|(column, (cell, width))| match right(column) {
                true => format!("{cell:>width$}"),
                false => format!("{cell:width$}"),
            })
            .collect();
        // Writing to a text does not fail.
        let _infallible = writeln!(text, "{}", cells.join("  ").trim_end());
    }
    text
}

/// Everything, a line for each part, indented by `depth`.
pub fn parts(text: &mut String, depth: usize, value: &Value) {
    let indent = "  ".repeat(depth);
    let mut part = |name: &str, value: &Value| {
        let nested = match value {
            Value::Object(parts) => !parts.is_empty(),
            Value::Array(parts) => !parts.is_empty(),
            _ => false,
        };
        let _infallible = match nested {
            true => writeln!(text, "{indent}{name}:"),
            false => writeln!(text, "{indent}{name}: {}", word(value)),
        };
        if nested {
            parts(text, depth + 1, value);
        }
    };
    match value {
        Value::Object(parts) => parts.iter().for_each(|(name, value)| part(name, value)),
        Value::Array(parts) => parts.iter().for_each(|value| part("-", value)),
        single => {
            let _infallible = writeln!(text, "{indent}{}", word(single));
        }
    }
}
