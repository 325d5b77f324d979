//! The socket's thread: takes clients, carries their requests, and lets go of those that do not
//! keep to the protocol.

mod connection;

use std::io::{self, ErrorKind};
use std::os::fd::AsFd as _;
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::net::sockopt::socket_peercred;
use rustix::process::geteuid;

use super::folder::{ControlError, prepare, user_folder};
use super::protocol::Answer;
use super::{Control, client};
use connection::Connection;

/// What one server takes upon itself.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Clients at a time.
    pub clients: usize,
    /// A client is let go when this has passed since it came or was last answered in full.
    pub deadline: Duration,
}

impl Default for Limits {
    /// Eight clients: a few operators and a display. Ten seconds: a program answers at once, and a
    /// person at a terminal types a request in that time.
    fn default() -> Self {
        Self {
            clients: 8,
            deadline: Duration::from_secs(10),
        }
    }
}

/// Between two looks at those that wait, so many new clients are taken or sent away.
const MAX_ACCEPTED_AT_ONCE: usize = 16;

/// A process without descriptors to spare has worse to do than to look for them all the time.
const PAUSE_WITHOUT_DESCRIPTORS: Duration = Duration::from_millis(100);

/// The server of one running system. Its socket and its thread end when it is dropped.
#[derive(Debug)]
pub struct Server {
    path: PathBuf,
    /// Closed to end the thread.
    stop: Option<UnixStream>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Serves an application in `$XDG_RUNTIME_DIR/steadfast`, or else `/tmp/steadfast-UID`.
    ///
    /// # Errors
    /// If the folder is not the user's alone, or the system refuses socket or thread.
    pub fn start(application: &str, control: Arc<dyn Control>) -> Result<Self, ControlError> {
        Self::start_in(&user_folder(), application, control, Limits::default())
    }

    /// The same in another folder, which is made if need be.
    ///
    /// # Errors
    /// As [`Server::start`].
    pub fn start_in(
        folder: &Path,
        application: &str,
        control: Arc<dyn Control>,
        limits: Limits,
    ) -> Result<Self, ControlError> {
        let path = prepare(folder, application)?;
        // With the number of this process: of an earlier one that had the same, if nobody answers.
        if client::Client::connect(&path).is_ok() {
            return Err(ControlError::Taken(application.to_owned()));
        }
        let _was_stale = std::fs::remove_file(&path);
        let started = || -> io::Result<Self> {
            let listener = UnixListener::bind(&path)?;
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600))?;
            listener.set_nonblocking(true)?;
            let (stop, stopped) = UnixStream::pair()?;
            let mut service = Service {
                listener,
                stopped,
                control,
                limits,
                connections: Vec::new(),
            };
            let thread = std::thread::Builder::new()
                .name("control".into())
                .spawn(move || service.run())?;
            Ok(Self {
                path: path.clone(),
                stop: Some(stop),
                thread: Some(thread),
            })
        };
        started().map_err(|error| {
            let _may_not_be_there = std::fs::remove_file(&path);
            ControlError::Socket {
                path: path.clone(),
                error,
            }
        })
    }

    /// The socket.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Nobody can come any more; the thread sees its end closed and returns.
        let _gone_already = std::fs::remove_file(&self.path);
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _panicked_and_so_ended = thread.join();
        }
    }
}

struct Service {
    listener: UnixListener,
    stopped: UnixStream,
    control: Arc<dyn Control>,
    limits: Limits,
    connections: Vec<Connection>,
}

impl Service {
    fn run(&mut self) {
        while let Some(ready) = self.wait() {
            let now = Instant::now();
            let connections = std::mem::take(&mut self.connections);
            let served = connections.into_iter().zip(ready.connections);
            let kept = served.filter_map(|(mut connection, ready)| {
                let in_time = now < connection.deadline();
                let goes_on = in_time && (!ready || connection.serve(&*self.control, now));
                goes_on.then_some(connection)
            });
            self.connections = kept.collect();
            if ready.listener {
                self.accept(now);
            }
        }
    }

    /// Waits until there is something to do; none when it is time to end.
    fn wait(&self) -> Option<Ready> {
        let mut descriptors = vec![
            PollFd::new(&self.stopped, PollFlags::IN),
            PollFd::new(&self.listener, PollFlags::IN),
        ];
        for connection in &self.connections {
            let wish = match connection.is_writing() {
                true => PollFlags::OUT,
                false => PollFlags::IN,
            };
            descriptors.push(PollFd::from_borrowed_fd(connection.stream().as_fd(), wish));
        }
        let first = self.connections.iter().map(Connection::deadline).min();
        let until = |deadline: Instant| deadline.saturating_duration_since(Instant::now());
        let timeout = match self.connections.iter().any(Connection::has_request) {
            true => Some(Duration::ZERO),
            false => first.map(until),
        };
        let timeout = timeout.and_then(|timeout| Timespec::try_from(timeout).ok());
        match poll(&mut descriptors, timeout.as_ref()) {
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            // Without poll there is nothing to serve with.
            Err(_) => return None,
        }
        let is_ready = |descriptor: &PollFd<'_>| !descriptor.revents().is_empty();
        if is_ready(&descriptors[0]) {
            return None;
        }
        let connections = self.connections.iter().zip(&descriptors[2..]);
        let connections = connections
            .map(|(connection, descriptor)| connection.has_request() || is_ready(descriptor));
        Some(Ready {
            listener: is_ready(&descriptors[1]),
            connections: connections.collect(),
        })
    }

    fn accept(&mut self, now: Instant) {
        for _ in 0..MAX_ACCEPTED_AT_ONCE {
            let stream = match self.listener.accept() {
                Ok((stream, _)) => stream,
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(_) => {
                    // The client stays in the queue, where it would be found again at once.
                    std::thread::sleep(PAUSE_WITHOUT_DESCRIPTORS);
                    return;
                }
            };
            if !is_allowed(&stream) {
                continue;
            }
            let deadline = self.limits.deadline;
            let Ok(mut connection) = Connection::new(stream, now, deadline) else {
                continue;
            };
            if self.connections.len() < self.limits.clients {
                self.connections.push(connection);
            } else {
                let refusal = "too many clients at once; try again";
                connection.dismiss(&Answer::Refused(refusal.into()));
            }
        }
    }
}

struct Ready {
    listener: bool,
    connections: Vec<bool>,
}

/// Only the user whose system it is, and the one who may do everything anyway.
fn is_allowed(stream: &UnixStream) -> bool {
    socket_peercred(stream).is_ok_and(|peer| peer.uid == geteuid() || peer.uid.is_root())
}
