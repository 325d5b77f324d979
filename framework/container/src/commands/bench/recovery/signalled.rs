//! A signal to a thread that computes: how long until the thread has been through its handler. It is
//! what a hang's way out is measured against.

use std::io;
use std::os::unix::thread::JoinHandleExt as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use nix::sys::pthread::pthread_kill;
use nix::sys::signal::Signal;

use super::real_time::{PRIORITY, ask_for_real_time};

/// Any signal that nobody else in this process uses.
const SIGNAL: Signal = Signal::SIGUSR1;

/// How long the thread has computed when the signal is sent: it runs by then.
const COMPUTING: Duration = Duration::from_micros(300);

/// A signal that takes longer than this is lost.
const PATIENCE: Duration = Duration::from_secs(5);

/// A thread to be signalled.
pub(super) struct Signalled {
    thread: JoinHandle<()>,
    begin: Sender<()>,
    noticed: Receiver<Instant>,
}

impl Signalled {
    /// Starts the thread.
    ///
    /// # Errors
    /// If the system refuses the thread or the handler.
    pub(super) fn start() -> io::Result<Self> {
        let flag = Arc::new(AtomicBool::new(false));
        signal_hook::flag::register(SIGNAL as i32, Arc::clone(&flag))?;
        let (begin, begun) = channel();
        let (notice, noticed) = channel();
        let thread = std::thread::Builder::new()
            .name("signalled".to_owned())
            .spawn(move || {
                // Below whoever signals, as a component is below the watchdog.
                let _without = ask_for_real_time(PRIORITY - 1);
                while begun.recv().is_ok() {
                    let start = Instant::now();
                    while !flag.swap(false, Ordering::AcqRel) && start.elapsed() < PATIENCE {
                        std::hint::spin_loop();
                    }
                    if notice.send(Instant::now()).is_err() {
                        return;
                    }
                }
            })?;
        Ok(Self {
            thread,
            begin,
            noticed,
        })
    }

    /// Signals the thread while it computes; nanoseconds from before the signal was sent until the
    /// thread had been through the handler.
    ///
    /// # Errors
    /// If the thread does not answer.
    pub(super) fn time(&self) -> io::Result<u64> {
        let gone = |_| io::Error::other("the thread to be signalled has ended");
        self.begin.send(()).map_err(|_| gone(()))?;
        std::thread::sleep(COMPUTING);
        let start = Instant::now();
        pthread_kill(self.thread.as_pthread_t(), SIGNAL)?;
        let end = self.noticed.recv_timeout(2 * PATIENCE);
        let end = end.map_err(|_| gone(()))?;
        let took = end.saturating_duration_since(start);
        Ok(u64::try_from(took.as_nanos()).unwrap_or(u64::MAX))
    }
}
