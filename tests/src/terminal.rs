//! A program on a pseudo terminal that nobody looks at: keys in, and what stands on the screen out.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::os::fd::OwnedFd;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{LocalModes, Winsize, tcgetattr, tcsetwinsize};

use crate::watchdog::until;

/// What is waited for takes a second at most; a busy machine gets more.
const PATIENCE: Duration = Duration::from_secs(60);

/// Columns and rows.
const SIZE: (u16, u16) = (80, 24);

/// The terminal with its program; that is killed when this is dropped.
pub struct Terminal {
    keyboard: File,
    /// The program's side of it, to be looked at afterwards.
    line: OwnedFd,
    output: Receiver<Vec<u8>>,
    screen: Screen,
    child: Child,
}

impl Terminal {
    /// Starts a program on a terminal of 80 columns and 24 rows.
    ///
    /// # Panics
    /// If there is no terminal, or the program does not start.
    pub fn open(mut command: Command) -> Self {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
        let keyboard = openpt(flags).expect("a pseudo terminal");
        let granted = grantpt(&keyboard).and_then(|()| unlockpt(&keyboard));
        granted.expect("it can be opened");
        let path = ptsname(&keyboard, Vec::new()).expect("it has a name");
        let path = path.into_string().expect("its name is a text");
        let line = File::options().read(true).write(true).open(path);
        let line = line.expect("it opens");
        let size = Winsize {
            ws_row: SIZE.1,
            ws_col: SIZE.0,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        tcsetwinsize(&keyboard, size).expect("it has a size");
        let copy = || Stdio::from(line.try_clone().expect("a second descriptor"));
        let child = command
            .env("TERM", "xterm")
            .stdin(copy())
            .stdout(copy())
            .stderr(copy())
            .spawn()
            .expect("the program starts");
        let keyboard = File::from(keyboard);
        let output = read(keyboard.try_clone().expect("a second descriptor"));
        Self {
            keyboard,
            line: line.into(),
            output,
            screen: Screen::default(),
            child,
        }
    }

    /// Presses keys.
    ///
    /// # Panics
    /// If the terminal takes none.
    pub fn press(&mut self, keys: &str) {
        let pressed = self.keyboard.write_all(keys.as_bytes());
        pressed.expect("it takes keys");
    }

    /// Sends the program a signal.
    ///
    /// # Panics
    /// If it is gone.
    pub fn signal(&self, signal: Signal) {
        let process = i32::try_from(self.child.id()).expect("process ids are small");
        let process = Pid::from_raw(process).expect("a child's id is not 0");
        kill_process(process, signal).expect("the program runs");
    }

    /// Waits until this stands on the screen.
    ///
    /// # Panics
    /// If it never does.
    #[track_caller]
    pub fn wait_for(&mut self, words: &str) {
        let deadline = Instant::now() + PATIENCE;
        while !self.screen.text().contains(words) {
            let left = deadline.saturating_duration_since(Instant::now());
            let chunk = self.output.recv_timeout(left);
            let chunk = chunk.unwrap_or_else(|_| panic!("no {words:?} on\n{}", self.screen.text()));
            self.screen.take(&String::from_utf8_lossy(&chunk));
        }
    }

    /// Waits for the end of the program; its exit code. The terminal must be as it was.
    ///
    /// # Panics
    /// If it does not end, or leaves the terminal raw.
    pub fn ended(&mut self) -> Option<i32> {
        let mut status = None;
        let has_ended = || {
            status = self.child.try_wait().expect("a child can be asked");
            status.is_some()
        };
        assert!(until(PATIENCE, has_ended), "it does not end");
        let modes = tcgetattr(&self.line).expect("it has modes").local_modes;
        let usual = LocalModes::ICANON | LocalModes::ECHO;
        assert!(modes.contains(usual), "the terminal is left raw");
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

/// Whatever is written to the terminal.
fn read(mut output: File) -> Receiver<Vec<u8>> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        let mut chunk = [0; 4096];
        while let Ok(count @ 1..) = output.read(&mut chunk) {
            if sender.send(chunk[..count].to_vec()).is_err() {
                return;
            }
        }
    });
    receiver
}

/// What stands on a screen, of a program that only puts texts at places and clears all of it.
#[derive(Default)]
struct Screen {
    rows: Vec<Vec<char>>,
    row: usize,
    column: usize,
    /// Of a sequence that has not come whole.
    rest: String,
}

impl Screen {
    fn take(&mut self, output: &str) {
        let output = std::mem::take(&mut self.rest) + output;
        let mut letters = output.char_indices();
        while let Some((start, letter)) = letters.next() {
            match letter {
                '\x1b' => {
                    let is_end = |(_, letter): &(usize, char)| letter.is_ascii_alphabetic();
                    let Some((end, command)) = letters.find(is_end) else {
                        self.rest = output[start..].to_owned();
                        return;
                    };
                    self.obey(command, output[start + 1..end].trim_start_matches('['));
                }
                letter if letter.is_control() => {}
                letter => self.put(letter),
            }
        }
    }

    fn obey(&mut self, command: char, arguments: &str) {
        match command {
            'H' => {
                let (row, column) = arguments.split_once(';').unwrap_or(("1", "1"));
                let place = |text: &str| text.parse::<usize>().unwrap_or(1).saturating_sub(1);
                (self.row, self.column) = (place(row), place(column));
            }
            'J' => self.rows.clear(),
            _ => {}
        }
    }

    fn put(&mut self, letter: char) {
        let rows = self.rows.len().max(self.row + 1);
        self.rows.resize(rows, Vec::new());
        let row = &mut self.rows[self.row];
        row.resize(row.len().max(self.column + 1), ' ');
        row[self.column] = letter;
        self.column += 1;
    }

    fn text(&self) -> String {
        let rows = self.rows.iter().map(|row| row.iter().collect::<String>());
        rows.collect::<Vec<_>>().join("\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_stand_where_they_were_put() {
        let mut screen = Screen::default();
        screen.take("\x1b[2J\x1b[1;1Hstop\x1b[2;3H\x1b[1mc\x1b[0mam\x1b[1");
        screen.take(";2Hlo\x1b[?25l");
        assert_eq!(screen.text(), "slop\n  cam");
        screen.take("\x1b[2J");
        assert_eq!(screen.text(), "");
    }
}
