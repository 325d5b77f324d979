//! A child process of the parent's own: started, signalled, reaped, and never left behind.

use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::process::{Child, Command};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{Pid, PidfdFlags, Signal, kill_process_group, pidfd_open, pidfd_send_signal};

use super::judgement::End;

/// After SIGKILL the kernel takes a process down as soon as it leaves the system call that it is in.
/// What is in one for longer waits for hardware that does not answer.
pub(super) const KILL_LIMIT: Duration = Duration::from_secs(10);

/// A child, in a process group of its own: what it starts itself goes with it, and a terminal's
/// Ctrl-C reaches it only by way of the parent.
#[derive(Debug)]
pub(super) struct Process {
    child: Child,
    group: Pid,
    descriptor: OwnedFd,
}

impl Process {
    /// Starts a child with this standard input. Must be called on the parent's main thread: children
    /// die with the thread that has started them.
    pub(super) fn start(command: &mut Command, input: OwnedFd) -> io::Result<Self> {
        let mut child = command.stdin(input).process_group(0).spawn()?;
        let group = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
        let opened = group
            .ok_or_else(|| io::Error::other("a process without a number"))
            .and_then(|group| Ok((group, pidfd_open(group, PidfdFlags::empty())?)));
        match opened {
            Ok((group, descriptor)) => Ok(Self {
                child,
                group,
                descriptor,
            }),
            Err(error) => {
                let _gone = child.kill();
                let _reaped = child.wait();
                Err(error)
            }
        }
    }

    /// Sends it a signal; one that has ended does not mind.
    pub(super) fn signal(&self, signal: Signal) {
        let _has_ended = pidfd_send_signal(&self.descriptor, signal);
    }

    /// Whether it ends within `limit`.
    pub(super) fn ends_within(&self, limit: Duration) -> bool {
        let mut descriptors = [PollFd::new(&self.descriptor, PollFlags::IN)];
        let limit = Timespec::try_from(limit).ok();
        matches!(poll(&mut descriptors, limit.as_ref()), Ok(1..))
    }

    /// Takes down what it has left behind, and says how it ended; to be called once it has.
    pub(super) fn reap(&mut self) -> io::Result<End> {
        // Before it is reaped: until then the number of its group is nobody else's.
        let _nobody_left = kill_process_group(self.group, Signal::KILL);
        let status = self.child.wait()?;
        Ok(match (status.code(), status.signal()) {
            (Some(code), _) => End::Code(code),
            (None, signal) => End::Signal(signal.unwrap_or_default()),
        })
    }
}

impl AsFd for Process {
    /// Readable once the process has ended.
    fn as_fd(&self) -> BorrowedFd<'_> {
        self.descriptor.as_fd()
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if matches!(self.child.try_wait(), Ok(Some(_))) {
            return;
        }
        self.signal(Signal::KILL);
        if self.ends_within(KILL_LIMIT) {
            let _nobody_asks = self.reap();
        }
    }
}
