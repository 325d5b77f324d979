//! `steadfast top`, on a terminal that nobody looks at.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::os::fd::OwnedFd;
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{LocalModes, Winsize, tcgetattr, tcsetwinsize};
use tests::{Application, Member, Operator, until};

/// Longer than anything here takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A pseudo terminal with `steadfast top` on it.
struct Terminal {
    keyboard: File,
    /// The other side of it, to be looked at afterwards.
    line: OwnedFd,
    output: Receiver<Vec<u8>>,
    /// Everything that was drawn.
    seen: String,
    child: Child,
}

impl Terminal {
    fn open(operator: &Operator) -> Self {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
        let keyboard = openpt(flags).expect("a pseudo terminal");
        grantpt(&keyboard)
            .and_then(|()| unlockpt(&keyboard))
            .expect("it can be opened");
        let path = ptsname(&keyboard, Vec::new()).expect("it has a name");
        let path = path.into_string().expect("its name is a text");
        let line = File::options()
            .read(true)
            .write(true)
            .open(path)
            .expect("it opens");
        let size = Winsize {
            ws_row: 24,
            ws_col: 80,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        tcsetwinsize(&keyboard, size).expect("it has a size");
        let copy = || Stdio::from(line.try_clone().expect("a second descriptor"));
        let child = operator
            .command(&["top"])
            .env("TERM", "xterm")
            .stdin(copy())
            .stdout(copy())
            .stderr(copy())
            .spawn()
            .expect("top starts");
        let keyboard = File::from(keyboard);
        let mut screen = keyboard.try_clone().expect("a second descriptor");
        let (sender, output) = channel();
        std::thread::spawn(move || {
            let mut chunk = [0; 4096];
            while let Ok(count @ 1..) = screen.read(&mut chunk) {
                if sender.send(chunk[..count].to_vec()).is_err() {
                    return;
                }
            }
        });
        Self {
            keyboard,
            line: line.into(),
            output,
            seen: String::new(),
            child,
        }
    }

    fn press(&mut self, keys: &str) {
        self.seen.clear();
        self.keyboard
            .write_all(keys.as_bytes())
            .expect("it takes keys");
    }

    /// Waits until this was drawn since the last key.
    #[track_caller]
    fn wait_for(&mut self, words: &str) {
        let deadline = Instant::now() + PATIENCE;
        while !self.seen.contains(words) {
            let left = deadline.saturating_duration_since(Instant::now());
            let chunk = self.output.recv_timeout(left);
            let chunk = chunk.unwrap_or_else(|_| panic!("no {words:?} in {:?}", self.seen));
            self.seen += &String::from_utf8_lossy(&chunk);
        }
    }

    /// Waits for its end; the terminal must be as it was.
    fn ended(&mut self) -> Option<i32> {
        let mut status = None;
        let has_ended = || {
            status = self.child.try_wait().expect("a child can be asked");
            status.is_some()
        };
        assert!(until(PATIENCE, has_ended), "it does not end");
        let modes = tcgetattr(&self.line).expect("it has modes").local_modes;
        assert!(
            modes.contains(LocalModes::ICANON | LocalModes::ECHO),
            "it is left raw"
        );
        status.and_then(|status| status.code())
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        // Gone already, unless a test failed.
        let _gone = self.child.kill();
        let _reaped = self.child.wait();
    }
}

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
    let mut terminal = Terminal::open(&operator);
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
    application.interrupt(run).ended_well();
    terminal.wait_for("no application answers");
    // The next one is found by itself.
    let run = application.start(&[]);
    operator.socket();
    terminal.press("x");
    terminal.wait_for("ACTIVE");
    terminal.press("q");
    assert_eq!(terminal.ended(), Some(0));
    application.interrupt(run).ended_well();
}

#[test]
fn a_signal_leaves_the_terminal_as_it_was() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    operator.socket();
    let mut terminal = Terminal::open(&operator);
    terminal.wait_for("counter");
    let process = i32::try_from(terminal.child.id()).expect("process ids are small");
    let process = rustix::process::Pid::from_raw(process).expect("not 0");
    rustix::process::kill_process(process, rustix::process::Signal::TERM).expect("it runs");
    assert_eq!(terminal.ended(), Some(0));
    application.interrupt(run).ended_well();
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
    assert_eq!(blind.code, Some(3), "{blind}");
    assert!(blind.stderr.contains("--once"), "{blind}");
    application.interrupt(run).ended_well();
    let gone = operator.run(&["top", "--once"]);
    assert_eq!(gone.code, Some(2), "{gone}");
}
