//! A host process, as the container has it: started, told what to run, killed, and always reaped.
//!
//! A thread of its own starts it and waits for its end: the kernel ties the life of a child to the
//! thread that started it, and so no host outlives the container, however that ends.

use std::io;
use std::os::fd::{AsFd as _, BorrowedFd, OwnedFd};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

use std::time::{Duration, Instant};

use crossbeam::channel::{Sender, bounded};
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};

use super::HOST_COMMAND;
use super::channel::Channel;
use super::setup::Setup;
use super::socket;
use crate::wake::Wake;

/// How often a wait for its end looks.
const LOOK: Duration = Duration::from_millis(1);

/// Hosts that may wait to be started: one for every executor that recovers a component just now.
const WAITING: usize = 64;

/// A host process; killed when nobody needs it any more.
#[derive(Debug)]
pub(super) struct HostProcess {
    control: OwnedFd,
    life: Arc<Life>,
}

/// The thread that starts the threads that start hosts. These inherit its policy and niceness and
/// hand them on to their hosts: they are those of the thread that made the starter, not of an
/// executor, nor of the one that prepares standbys and gives way to everybody.
#[derive(Debug)]
pub(super) struct Starter {
    wanted: Sender<Wanted>,
}

/// A host that is to be started: its end of the line, and whom to tell.
struct Wanted {
    far: OwnedFd,
    tell: Sender<io::Result<Arc<Life>>>,
}

impl Starter {
    /// Starts hosts by this executable, as the calling thread would.
    ///
    /// # Errors
    /// If the system refuses a thread.
    pub(super) fn new(executable: &Path) -> io::Result<Self> {
        let (wanted, wants) = bounded::<Wanted>(WAITING);
        let executable: Arc<Path> = executable.into();
        std::thread::Builder::new()
            .name("hosts".to_owned())
            .spawn(move || {
                for Wanted { far, tell } in wants {
                    let executable = Arc::clone(&executable);
                    let refused = tell.clone();
                    let thread = std::thread::Builder::new().name("host".to_owned());
                    let started = thread.spawn(move || attend(&executable, far, &tell));
                    if let Err(error) = started {
                        let _nobody_waits = refused.send(Err(error));
                    }
                }
            })?;
        Ok(Self { wanted })
    }
}

/// What is known of the process.
#[derive(Debug)]
struct Life {
    process: Pid,
    /// Whether its number may name another process by now.
    reaped: Mutex<bool>,
    /// Whether the container ended it.
    killed: AtomicBool,
    status: OnceLock<ExitStatus>,
    tenants: Mutex<Vec<Tenant>>,
}

/// Whom the end of the process concerns.
#[derive(Debug)]
struct Tenant {
    channel: Weak<Channel>,
    executor: Arc<OnceLock<Arc<Wake>>>,
}

impl Tenant {
    /// The process is dead. Whoever waits for it sees that by the channel; if nobody does, and it
    /// has ended by itself, the executor is to look.
    fn learn_of_death(&self, by_itself: bool) {
        let Some(channel) = self.channel.upgrade() else {
            return;
        };
        let is_idle = channel.is_idle();
        channel.mark_dead();
        if let Some(executor) = self.executor.get()
            && by_itself
            && is_idle
        {
            executor.wake();
        }
    }
}

impl HostProcess {
    /// Starts a host.
    ///
    /// # Errors
    /// If the system refuses the process or a thread.
    pub(super) fn start(starter: &Starter) -> io::Result<Self> {
        let (control, far) = socket::pair()?;
        let (tell, told) = bounded(1);
        let asked = starter.wanted.send(Wanted { far, tell });
        asked.map_err(|_gone| io::ErrorKind::BrokenPipe)?;
        let life = told.recv().map_err(|_gone| io::ErrorKind::BrokenPipe)??;
        Ok(Self { control, life })
    }

    /// Lets it run an instance; `executor` is woken if the process ends while nobody waits for it.
    ///
    /// # Errors
    /// If it cannot be told: it is dead.
    pub(super) fn run(
        &self,
        setup: &Setup,
        channel: &Arc<Channel>,
        devices: BorrowedFd<'_>,
        library: BorrowedFd<'_>,
        executor: &Arc<OnceLock<Arc<Wake>>>,
    ) -> io::Result<()> {
        self.life.tenants().push(Tenant {
            channel: Arc::downgrade(channel),
            executor: Arc::clone(executor),
        });
        let message = serde_json::to_vec(setup)?;
        socket::send(
            self.control.as_fd(),
            &message,
            &[channel.memory(), devices, library],
        )?;
        if self.life.status.get().is_some() {
            channel.mark_dead();
        }
        Ok(())
    }

    /// Whether it has ended.
    pub(super) fn is_dead(&self) -> bool {
        self.life.status.get().is_some()
    }

    /// How it ended, in words, once that is known.
    pub(super) fn ending(&self) -> Option<String> {
        self.life.status.get().map(ToString::to_string)
    }

    /// How it ended, in words; waits for that at most `limit`.
    pub(super) fn wait_for_end(&self, limit: Duration) -> Option<String> {
        let began = Instant::now();
        while !self.is_dead() && began.elapsed() < limit {
            std::thread::sleep(LOOK);
        }
        self.ending()
    }

    /// Whether a thread of this number is its.
    pub(super) fn has_thread(&self, thread: i32) -> bool {
        let process = self.life.process.as_raw_nonzero();
        Path::new(&format!("/proc/{process}/task/{thread}")).exists()
    }

    /// Ends it, and all that it has started, at once.
    pub(super) fn kill(&self) {
        self.life.killed.store(true, Ordering::Release);
        let reaped = self.life.reaped();
        if !*reaped {
            // Its own group if it came to make one; else itself. A refusal: it is gone already.
            let process = self.life.process;
            let _gone = kill_process_group(process, Signal::KILL);
            let _gone = rustix::process::kill_process(process, Signal::KILL);
        }
    }

    /// Whether [`Self::kill`] was called.
    pub(super) fn was_killed(&self) -> bool {
        self.life.killed.load(Ordering::Acquire)
    }
}

impl Drop for HostProcess {
    fn drop(&mut self) {
        self.kill();
    }
}

impl Life {
    fn reaped(&self) -> MutexGuard<'_, bool> {
        self.reaped.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tenants(&self) -> MutexGuard<'_, Vec<Tenant>> {
        self.tenants.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Starts the process, tells of it, and stays until it has ended.
fn attend(executable: &Path, far: OwnedFd, tell: &Sender<io::Result<Arc<Life>>>) {
    let started = Command::new(executable)
        .arg(HOST_COMMAND)
        .stdin(Stdio::from(far))
        .spawn();
    let mut child = match started {
        Ok(child) => child,
        Err(error) => {
            let _nobody_waits = tell.send(Err(error));
            return;
        }
    };
    let life = Arc::new(Life {
        process: Pid::from_child(&child),
        reaped: Mutex::new(false),
        killed: AtomicBool::new(false),
        status: OnceLock::new(),
        tenants: Mutex::default(),
    });
    let _nobody_waits = tell.send(Ok(Arc::clone(&life)));
    drop(reap(&mut child, &life));
    let by_itself = !life.killed.load(Ordering::Acquire);
    for tenant in life.tenants().iter() {
        tenant.learn_of_death(by_itself);
    }
}

/// Waits for the end of the process and takes what it has started with it.
fn reap(child: &mut Child, life: &Life) -> io::Result<()> {
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOWAIT;
    while let Err(rustix::io::Errno::INTR) = waitid(WaitId::Pid(life.process), options) {}
    // Dead, but not reaped: its number is still its own.
    let _nobody_left = kill_process_group(life.process, Signal::KILL);
    let mut reaped = life.reaped();
    let status = child.wait();
    *reaped = true;
    let _first = life.status.set(status?);
    Ok(())
}
