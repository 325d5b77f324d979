//! `steadfast top`: a running application on a terminal, redrawn several times a second, with keys to
//! act on it.

mod link;
mod model;
mod picture;
mod screen;
mod view;

use std::io::{self, IsTerminal as _, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use container::control::client::ClientError;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;

use super::exit_code::{self, DONE};
use super::operator::{Target, unanswered};
use model::Model;

/// The size that every terminal has.
const USUAL_SIZE: (u16, u16) = (80, 24);

/// What `steadfast top` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = super::manual::TOP)]
pub struct TopArguments {
    #[command(flatten)]
    target: Target,
    /// Print one frame as text and leave: for scripts and logs
    #[arg(long)]
    once: bool,
    /// Draw one frame into a file and leave
    #[arg(long, value_name = "FILE.svg", conflicts_with = "once")]
    picture: Option<PathBuf>,
    /// Columns and rows of --once and --picture
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = size, default_value = "80x24")]
    size: (u16, u16),
}

/// Shows the running application.
pub fn run(arguments: &TopArguments) -> ExitCode {
    if !arguments.once && arguments.picture.is_none() {
        return watch(arguments);
    }
    let model = match link::look(&arguments.target) {
        Ok(model) => model,
        Err(error) => return unanswered(&error),
    };
    let buffer = frame(&model, arguments.size);
    let Some(path) = &arguments.picture else {
        // A closed pipe: whoever reads has seen enough.
        let _unread = write!(io::stdout(), "{}", picture::text(&buffer));
        return ExitCode::from(DONE);
    };
    match std::fs::write(path, picture::svg(&buffer)) {
        Ok(()) => ExitCode::from(DONE),
        Err(error) => complain(&format!("{} cannot be written: {error}", path.display())),
    }
}

fn watch(arguments: &TopArguments) -> ExitCode {
    if !io::stdout().is_terminal() || !io::stdin().is_terminal() {
        return complain(
            "there is no terminal\n  help: --once prints one frame, --picture draws it into a file",
        );
    }
    // Several that run: which one is meant does not become clear by waiting.
    if let Err(error @ (ClientError::Several(_) | ClientError::Folder(_))) = arguments.target.path()
    {
        return unanswered(&error);
    }
    match screen::watch(&arguments.target) {
        Ok(()) => ExitCode::from(DONE),
        Err(error) => complain(&format!("the terminal cannot be used: {error}")),
    }
}

fn complain(text: &str) -> ExitCode {
    // If nobody reads the text the exit code still tells.
    let _unread = writeln!(io::stderr(), "{text}");
    ExitCode::from(exit_code::FILE)
}

/// One frame of this size.
fn frame(model: &Model, (width, height): (u16, u16)) -> Buffer {
    let terminal = Terminal::new(TestBackend::new(width, height));
    let Ok(mut terminal) = terminal;
    // Drawing into memory does not fail.
    let Ok(_drawn) = terminal.draw(|frame| view::draw(frame, model));
    terminal.backend().buffer().clone()
}

/// `120x40`.
fn size(text: &str) -> Result<(u16, u16), String> {
    let (width, height) = text.split_once('x').unwrap_or((text, ""));
    let side = |text: &str, least: u16| {
        let side = text.parse().ok();
        side.filter(|side| (least..=500).contains(side))
    };
    side(width, 20).zip(side(height, 5)).ok_or_else(|| {
        let (width, height) = USUAL_SIZE;
        format!("columns (20 to 500) and rows (5 to 500) are wanted, as in {width}x{height}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        for (text, expected) in [
            ("80x24", Some((80, 24))),
            ("500x500", Some((500, 500))),
            ("80", None),
            ("19x24", None),
            ("80x501", None),
            ("x", None),
            ("80x24x3", None),
        ] {
            assert_eq!(size(text).ok(), expected, "{text}");
        }
    }
}
