//! One container, as its parent sees it.

use std::io::{self, ErrorKind, Read as _};
use std::os::fd::{AsFd as _, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::process::Command;
use std::time::Duration;

use rustix::process::Signal;

use super::Plan;
use crate::descriptor_line::DescriptorLine;
use crate::outer_supervision::judgement::{Circumstances, End};
use crate::outer_supervision::liveness::{Limits, Liveness, Phase};
use crate::outer_supervision::messages::{LINE_LIMIT, Sign, Welcome};
use crate::outer_supervision::process::{KILL_LIMIT, Process};
use crate::outer_supervision::service_manager::{
    SOCKET_VARIABLE, WATCHDOG_PROCESS_VARIABLE, WATCHDOG_VARIABLE,
};

/// Signs that are read at once: more than a socket holds of messages of one byte.
const SIGNS_AT_ONCE: usize = 1024;

/// A container that was started.
pub(super) struct Container {
    process: Process,
    /// None once it has closed its end, which alone means nothing.
    line: Option<UnixStream>,
    liveness: Liveness,
    has_run: bool,
    /// When it was heard last, or started.
    heard: Duration,
    /// When it was killed, and how long it had been silent.
    killed: Option<(Duration, Duration)>,
}

impl Container {
    /// Starts a container and tells it what it needs to know.
    pub(super) fn start(
        plan: &Plan,
        limits: Limits,
        welcome: &Welcome,
        world: Option<UnixStream>,
        now: Duration,
    ) -> io::Result<Self> {
        let (here, there) = UnixStream::pair()?;
        let mut command = Command::new(&plan.executable);
        command
            .args(&plan.arguments)
            .args(["--supervised-by", &std::process::id().to_string()])
            .env_remove(SOCKET_VARIABLE)
            .env_remove(WATCHDOG_VARIABLE)
            .env_remove(WATCHDOG_PROCESS_VARIABLE);
        let mut line = DescriptorLine::new(here, LINE_LIMIT)?;
        line.send(welcome, world.as_ref().map(|world| world.as_fd()))?;
        let process = Process::start(&mut command, there.into())?;
        let line = line.into_stream();
        line.set_nonblocking(true)?;
        Ok(Self {
            process,
            line: Some(line),
            liveness: Liveness::new(limits, now),
            has_run: false,
            heard: now,
            killed: None,
        })
    }

    /// Hears what it has to say; the phase that it has entered with that.
    pub(super) fn listen(&mut self, now: Duration) -> Option<Phase> {
        let mut buffer = [0; SIGNS_AT_ONCE];
        let read = self.line.as_mut()?.read(&mut buffer);
        let count = match read {
            Err(error) if error.kind() == ErrorKind::WouldBlock => return None,
            Ok(0) | Err(_) => {
                self.line = None;
                return None;
            }
            Ok(count) => count,
        };
        self.heard = now;
        let signs = buffer[..count].iter();
        let mut entered = None;
        for sign in signs.filter_map(|byte| Sign::from_byte(*byte)) {
            if self.liveness.hear(sign, now) {
                entered = Some(self.liveness.phase());
            }
            self.has_run |= sign == Sign::Beat;
        }
        entered
    }

    /// Passes a signal on and expects it to stop.
    pub(super) fn ask_to_stop(&mut self, signal: Signal, now: Duration) {
        self.process.signal(signal);
        self.liveness.stop(now);
    }

    /// When something is due if it is not heard before.
    pub(super) fn due(&self) -> Duration {
        match self.killed {
            Some((killed, _)) => killed + KILL_LIMIT,
            None => self.liveness.due(),
        }
    }

    /// Whether it should have been heard, or have ended.
    pub(super) fn is_overdue(&self, now: Duration) -> bool {
        self.due() <= now
    }

    /// Kills it; false if that has been done, and it has not ended.
    pub(super) fn kill_overdue(&mut self, now: Duration) -> bool {
        if self.killed.is_some() {
            return false;
        }
        self.process.signal(Signal::KILL);
        self.killed = Some((now, self.liveness.silence(now)));
        true
    }

    /// Whether it was killed by this parent.
    pub(super) fn is_killed(&self) -> bool {
        self.killed.is_some()
    }

    /// How it ended; to be called once it has.
    pub(super) fn end(&mut self) -> io::Result<End> {
        // It may have said between two looks that it stops.
        self.listen(self.heard);
        let end = self.process.reap()?;
        Ok(match self.killed {
            Some((_, silence)) => End::Silence(silence),
            None => end,
        })
    }

    /// In what circumstances it ended.
    pub(super) fn circumstances(&self, is_restart: bool) -> Circumstances {
        Circumstances {
            is_restart,
            has_run: self.has_run,
            stopping: self.liveness.phase() == Phase::Stopping,
        }
    }

    /// When it was heard last.
    pub(super) fn heard(&self) -> Duration {
        self.heard
    }

    pub(super) fn process(&self) -> &Process {
        &self.process
    }

    /// What is readable when it has said something.
    pub(super) fn line(&self) -> Option<BorrowedFd<'_>> {
        self.line.as_ref().map(|line| line.as_fd())
    }
}
