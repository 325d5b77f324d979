//! `steadfast top`, on a terminal that nobody looks at.

use std::time::Duration;

use rustix::process::Signal;
use tests::{Application, Member, Terminal, until};

/// Longer than anything here takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn application() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .connect("data", "counter.output", "recorder.input")
}

#[test]
fn keys_act_on_the_application_and_top_outlives_it() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    operator.socket();
    let mut terminal = Terminal::open(operator.command(&["top"]));
    terminal.wait_for("counter");
    terminal.press("r");
    operator.wait_for("reset", |faults| {
        faults
            .iter()
            .any(|fault| fault["plan"][0] == "reset counter")
    });
    terminal.press("i\r");
    operator.wait_for("segfault", |faults| {
        faults.iter().any(|fault| fault["kind"] == "segfault")
    });
    terminal.wait_for("segfault");
    // Down to the recorder; what is asked first is not done by any key.
    terminal.press("\x1b[B");
    terminal.press("s");
    terminal.wait_for("Stop recorder");
    terminal.press("n");
    terminal.wait_for("not stopped");
    assert_eq!(
        operator.status()["components"]["recorder"]["state"],
        "ACTIVE"
    );
    terminal.press("s");
    terminal.wait_for("Stop recorder");
    terminal.press("y");
    let stopped = || operator.status()["components"]["recorder"]["state"] == "INACTIVE";
    assert!(until(PATIENCE, stopped), "the recorder is not stopped");
    let _outcome = application.interrupt(run).ended_well();
    terminal.wait_for("no application answers");
    // The next one is found by itself.
    let run = application.start(&[]);
    operator.socket();
    terminal.wait_for("application ACTIVE");
    terminal.press("q");
    assert_eq!(terminal.ended(), Some(0));
    let _outcome = application.interrupt(run).ended_well();
}

#[test]
fn a_signal_leaves_the_terminal_as_it_was() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    operator.socket();
    let mut terminal = Terminal::open(operator.command(&["top"]));
    terminal.wait_for("counter");
    terminal.signal(Signal::TERM);
    assert_eq!(terminal.ended(), Some(0));
    let _outcome = application.interrupt(run).ended_well();
}

#[test]
fn one_frame_needs_no_terminal() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    operator.socket();
    let frame = operator.run(&["top", "--once", "--size", "100x20"]);
    assert_eq!(frame.code, Some(0), "{frame}");
    assert_eq!(frame.stdout.lines().count(), 20);
    assert!(frame.stdout.contains("recorder"), "{frame}");
    let picture = application.folder().join("top.svg");
    let drawn = operator.run(&["top", "--picture", &picture.display().to_string()]);
    assert_eq!(drawn.code, Some(0), "{drawn}");
    let drawn = std::fs::read_to_string(picture).expect("it is written");
    assert!(
        drawn.starts_with("<svg") && drawn.contains("recorder"),
        "{drawn}"
    );
    let blind = operator.run(&["top"]);
    assert_eq!(blind.code, Some(2), "{blind}");
    assert!(blind.stderr.contains("--once"), "{blind}");
    let _outcome = application.interrupt(run).ended_well();
    let gone = operator.run(&["top", "--once"]);
    assert_eq!(gone.code, Some(2), "{gone}");
}
