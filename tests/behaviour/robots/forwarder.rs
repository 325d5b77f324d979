//! A line between robots that can be cut and healed.

use std::io::{ErrorKind, Read as _, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often the threads look whether the line was cut.
const LOOK_PERIOD: Duration = Duration::from_millis(5);

/// How a line is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cut {
    /// Connections end, and new ones end at once: a switch that is off.
    Closed,
    /// Connections stay, and nothing passes: a robot behind a hill.
    Silent,
}

/// As [`Cut`]: whole, closed, silent; and over.
const WHOLE: u8 = 0;
const CLOSED: u8 = 1;
const SILENT: u8 = 2;
const OVER: u8 = 3;

/// A port that leads to another one of this machine.
pub struct Forwarder {
    port: u16,
    state: Arc<AtomicU8>,
    accepting: Option<JoinHandle<()>>,
}

impl Forwarder {
    /// A line to a port that somebody may listen at later.
    pub fn to(target: u16) -> Self {
        let listener = TcpListener::bind(("127.0.0.1", 0)).expect("a free port");
        let port = listener.local_addr().expect("its address").port();
        listener.set_nonblocking(true).expect("it need not wait");
        let state = Arc::new(AtomicU8::new(WHOLE));
        let of_thread = Arc::clone(&state);
        let accepting = std::thread::spawn(move || accept(&listener, target, &of_thread));
        Self {
            port,
            state,
            accepting: Some(accepting),
        }
    }

    /// Where it begins.
    pub fn port(&self) -> u16 {
        self.port
    }

    /// Cuts it.
    pub fn cut(&self, cut: Cut) {
        let state = match cut {
            Cut::Closed => CLOSED,
            Cut::Silent => SILENT,
        };
        self.state.store(state, Ordering::SeqCst);
    }

    /// Makes it whole again. What was sent into a silent line arrives now, as by TCP it does.
    pub fn heal(&self) {
        self.state.store(WHOLE, Ordering::SeqCst);
    }
}

impl Drop for Forwarder {
    fn drop(&mut self) {
        self.state.store(OVER, Ordering::SeqCst);
        let accepting = self.accepting.take().expect("it is dropped once");
        let _panicked = accepting.join();
    }
}

fn accept(listener: &TcpListener, target: u16, state: &Arc<AtomicU8>) {
    loop {
        std::thread::sleep(LOOK_PERIOD);
        match state.load(Ordering::SeqCst) {
            OVER => return,
            SILENT => continue,
            _ => {}
        }
        let Ok((near, _)) = listener.accept() else {
            continue;
        };
        if state.load(Ordering::SeqCst) != WHOLE {
            continue;
        }
        // Nobody listens there yet: the connection ends, and is tried again.
        let Ok(far) = TcpStream::connect(("127.0.0.1", target)) else {
            continue;
        };
        let (near_again, far_again) = (copy_of(&near), copy_of(&far));
        for (from, into) in [(near, far), (far_again, near_again)] {
            let state = Arc::clone(state);
            std::thread::spawn(move || pass(from, into, &state));
        }
    }
}

fn copy_of(stream: &TcpStream) -> TcpStream {
    stream.try_clone().expect("a second descriptor")
}

/// Passes on what comes until one end, or the line, is closed.
fn pass(mut from: TcpStream, mut into: TcpStream, state: &AtomicU8) {
    let limited = from.set_read_timeout(Some(LOOK_PERIOD));
    limited.expect("reading has a deadline");
    let mut bytes = vec![0; 1 << 16];
    loop {
        match state.load(Ordering::SeqCst) {
            WHOLE => {}
            SILENT => {
                std::thread::sleep(LOOK_PERIOD);
                continue;
            }
            _ => break,
        }
        match from.read(&mut bytes) {
            Ok(0) => break,
            Ok(length) => {
                if into.write_all(&bytes[..length]).is_err() {
                    break;
                }
            }
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(_) => break,
        }
    }
    for end in [from, into] {
        let _closed_already = end.shutdown(Shutdown::Both);
    }
}
