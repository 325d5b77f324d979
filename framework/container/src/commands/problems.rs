//! Problems of files as a person reads them.

use std::io::{self, Write};

use miette::{GraphicalReportHandler, GraphicalTheme};
use system_profile::Problem;

/// Writes problems for people, each with the offending text underlined. `colours` says whether
/// `output` is a terminal; a person who sets NO_COLOR gets none even there.
pub fn write(output: &mut impl Write, problems: &[Problem], colours: bool) -> io::Result<()> {
    let handler = GraphicalReportHandler::new().with_context_lines(1);
    let handler = match colours && std::env::var_os("NO_COLOR").is_none() {
        true => handler,
        false => handler.with_theme(GraphicalTheme::unicode_nocolor()),
    };
    for problem in problems {
        let mut text = String::new();
        if handler.render_report(&mut text, problem).is_err() {
            text = format!("{}: {problem}", problem.severity.name());
        }
        if !problem.has_snippet() {
            writeln!(output, "{}", problem.place)?;
        }
        writeln!(output, "{}\n", text.trim_end())?;
    }
    Ok(())
}

/// The same as text.
pub fn render(problems: &[Problem], colours: bool) -> String {
    let mut output = Vec::new();
    // Writing to memory does not fail.
    let _infallible = write(&mut output, problems, colours);
    String::from_utf8_lossy(&output).into_owned()
}
