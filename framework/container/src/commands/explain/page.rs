//! The table as a page that needs nothing but itself: a row for each component, a column for each
//! fault, a colour for what comes of it; each cell opens what is done.

use std::fmt::Write as _;

use fault_manager::Scope;
use fault_manager::what_if::{Answer, Cell, Row, SupposedFault, Table};

use super::table::{indispensable, steps, unanswered};
use super::what_if::{name, outcome};

/// Looks of the page. Colours are told apart by people who see red and green alike, and each cell
/// has a word as well.
const STYLE: &str = "\
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em; color: #1c2430; background: #fff }\n\
table { border-collapse: collapse }\n\
th, td { border: 1px solid #c9d1dc; padding: 2px; text-align: left; vertical-align: top; \
font-size: 12px }\n\
thead th { background: #eef1f5; position: sticky; top: 0; writing-mode: vertical-rl; \
transform: rotate(180deg); white-space: nowrap }\n\
thead th:first-child { writing-mode: horizontal-tb; transform: none; vertical-align: bottom }\n\
tbody th { background: #eef1f5; position: sticky; left: 0; white-space: nowrap }\n\
summary { cursor: pointer }\n\
td div { padding: 2px 4px }\n\
ul { margin: 2px 0 2px 16px; padding: 0 }\n\
.stop { background: #f7c9c2 } .lost { background: #fbe2b8 } .replaced { background: #dfe4fb }\n\
.reset { background: #d6eaf8 } .record { background: #efe7f5 } .nothing { background: #f4f4f4; \
color: #5a6472 } .none { color: #8a93a0 }\n\
.port { color: #5a6472 }\n\
.wide { overflow-x: auto }\n";

/// The page.
pub fn html(scopes: &[Scope], table: &Table) -> String {
    let names = scopes.iter().map(|scope| scope.specification.name.as_str());
    let title = escaped(&names.collect::<Vec<_>>().join(", "));
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <title>What if: {title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <h1>What if a component of {title} fails?</h1>\n\
         <p>Each cell is what the fault manager does about a fault of a component by the rules; \
         click it for the steps. Faults of data are of each port.</p>\n"
    );
    page += &list(
        "Components whose loss stops the robot",
        &indispensable(scopes, table),
    );
    page += "<div class=\"wide\">\n<table>\n<thead>\n<tr><th>component</th>";
    for fault in SupposedFault::ALL {
        let _infallible = write!(page, "<th>{}</th>", fault.name());
    }
    page += "<th>cannot be brought back</th></tr>\n</thead>\n<tbody>\n";
    for row in &table.rows {
        page += &line(scopes, row);
    }
    page += "</tbody>\n</table>\n</div>\n";
    page += &list("Faults that end in nothing", &unanswered(scopes, table));
    page += "</body>\n</html>\n";
    page
}

fn line(scopes: &[Scope], row: &Row) -> String {
    let who = escaped(&name(scopes, row.application, row.component));
    let mut line = format!("<tr><th>{who}</th>");
    for fault in SupposedFault::ALL {
        let cells = row.cells.iter();
        let cells = cells.filter(|cell| cell.supposition.fault == fault);
        line += "<td>";
        line.extend(cells.map(content));
        line += "</td>";
    }
    let _infallible = match &row.loss {
        Ok(loss) => writeln!(
            line,
            "<td class=\"{}\">{}</td></tr>",
            class(loss),
            opened(loss)
        ),
        Err(_) => writeln!(line, "<td class=\"none\">-</td></tr>"),
    };
    line
}

fn content(cell: &Cell) -> String {
    let port = cell.supposition.port.iter();
    let port: String = port
        .map(|port| format!("<span class=\"port\">{}: </span>", escaped(port)))
        .collect();
    match &cell.answer {
        Ok(answer) => format!(
            "<div class=\"{}\">{port}{}</div>",
            class(answer),
            opened(answer)
        ),
        Err(reason) => format!("<div title=\"{}\">-</div>", escaped(&reason.to_string())),
    }
}

/// What comes of it, and what is done to be opened.
fn opened(answer: &Answer) -> String {
    let steps = steps(answer).into_iter();
    let steps: String = steps
        .map(|step| format!("<li>{}</li>", escaped(&step)))
        .collect();
    match steps.is_empty() {
        true => outcome(answer).to_owned(),
        false => format!(
            "<details><summary>{}</summary><ul>{steps}</ul></details>",
            outcome(answer)
        ),
    }
}

/// The look of an answer.
fn class(answer: &Answer) -> &'static str {
    match outcome(answer) {
        "emergency stop" | "application stopped" => "stop",
        "goes on without some" => "lost",
        "replaced" => "replaced",
        "reset" => "reset",
        "recorded only" => "record",
        _ => "nothing",
    }
}

fn list(heading: &str, items: &[String]) -> String {
    let items: String = match items {
        [] => "<li>none</li>\n".to_owned(),
        items => items
            .iter()
            .map(|item| format!("<li>{}</li>\n", escaped(item)))
            .collect(),
    };
    format!("<h2>{heading}</h2>\n<ul>\n{items}</ul>\n")
}

/// Text as it may stand in a page, in content and in attributes.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            letter => escaped.push(letter),
        }
    }
    escaped
}
