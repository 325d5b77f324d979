//! The other end of the socket.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rustix::net::{AddressFamily, SocketAddrUnix, SocketFlags, SocketType, connect, socket_with};

use super::folder::{ControlError, RunningApplication, running};
use super::protocol::{Answer, MAX_ANSWER_BYTES, Request};

/// A system answers at once; after this it is taken for hung. A loaded board may take a second.
const ANSWER_DEADLINE: Duration = Duration::from_secs(5);

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// Where sockets lie cannot be trusted or read.
    #[error(transparent)]
    Folder(#[from] ControlError),
    /// Nothing runs.
    #[error("no application is running\n  help: start one with 'steadfast run APPLICATION.xml'")]
    NoneRunning,
    /// Nothing of that name runs.
    #[error(
        "no application '{wanted}' is running; there are: {others}\n  help: choose one of these with --application"
    )]
    NotRunning {
        /// The name.
        wanted: String,
        /// What runs.
        others: String,
    },
    /// It is not clear which one is meant.
    #[error(
        "several applications are running: {0}\n  help: choose one with --application or --socket"
    )]
    Several(String),
    /// Nobody answers at the socket.
    #[error(
        "nothing answers at {path}: {error}\n  help: has it just ended? 'steadfast run' says where it can be found"
    )]
    Connection {
        /// The socket.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// What came is no answer.
    #[error(
        "what came from {0} is no answer\n  help: is it another version? Ask with the steadfast that runs it"
    )]
    NoAnswer(PathBuf),
}

/// The socket of the application of a name, or without one of the only one that runs.
///
/// # Errors
/// If there is none, or more than one.
pub fn find(application: Option<&str>) -> Result<PathBuf, ClientError> {
    choose(running()?, application)
}

fn choose(
    running: Vec<RunningApplication>,
    application: Option<&str>,
) -> Result<PathBuf, ClientError> {
    let list = |applications: &[RunningApplication]| {
        let names = applications.iter().map(|found| {
            let socket = found.socket.display();
            format!(
                "{} (process {}, {socket})",
                found.application, found.process
            )
        });
        names.collect::<Vec<_>>().join(", ")
    };
    if running.is_empty() {
        return Err(ClientError::NoneRunning);
    }
    let is_meant = |found: &&RunningApplication| {
        application.is_none_or(|application| found.is_called(application))
    };
    let meant: Vec<RunningApplication> = running.iter().filter(is_meant).cloned().collect();
    match (&meant[..], application) {
        ([one], _) => Ok(one.socket.clone()),
        ([], wanted) => Err(ClientError::NotRunning {
            wanted: wanted.unwrap_or_default().to_owned(),
            others: list(&running),
        }),
        (several, _) => Err(ClientError::Several(list(several))),
    }
}

/// A connection to a running system.
#[derive(Debug)]
pub struct Client {
    stream: UnixStream,
    path: PathBuf,
}

impl Client {
    /// Connects to a socket, without waiting for one whose queue is full.
    ///
    /// # Errors
    /// If nobody listens there, or the user may not.
    pub fn connect(path: &Path) -> Result<Self, ClientError> {
        let connected = || -> io::Result<UnixStream> {
            let flags = SocketFlags::CLOEXEC | SocketFlags::NONBLOCK;
            let socket = socket_with(AddressFamily::UNIX, SocketType::STREAM, flags, None)?;
            connect(&socket, &SocketAddrUnix::new(path)?)?;
            let stream = UnixStream::from(socket);
            stream.set_nonblocking(false)?;
            Ok(stream)
        };
        Ok(Self {
            stream: connected().map_err(|error| unanswered(path, error))?,
            path: path.to_owned(),
        })
    }

    /// Sends a request and waits for its answer, at most five seconds.
    ///
    /// # Errors
    /// If the system hangs up, takes too long, or says something else.
    pub fn ask(&mut self, request: &Request) -> Result<Answer, ClientError> {
        let line = self
            .exchange(request)
            .map_err(|error| unanswered(&self.path, error))?;
        Answer::from_line(&line).ok_or_else(|| ClientError::NoAnswer(self.path.clone()))
    }

    fn exchange(&mut self, request: &Request) -> io::Result<Vec<u8>> {
        let deadline = Instant::now() + ANSWER_DEADLINE;
        self.stream.set_write_timeout(Some(ANSWER_DEADLINE))?;
        self.stream.write_all(&request.to_line()?)?;
        let mut answer = Vec::new();
        let mut chunk = [0; 64 * 1024];
        while answer.last() != Some(&b'\n') {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(ErrorKind::TimedOut.into());
            }
            self.stream.set_read_timeout(Some(left))?;
            let count = match self.stream.read(&mut chunk) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    return Err(ErrorKind::TimedOut.into());
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(error),
            };
            answer.extend_from_slice(&chunk[..count]);
            if answer.len() > MAX_ANSWER_BYTES {
                return Err(ErrorKind::InvalidData.into());
            }
        }
        Ok(answer)
    }
}

fn unanswered(path: &Path, error: io::Error) -> ClientError {
    ClientError::Connection {
        path: path.to_owned(),
        error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_application_that_is_meant() {
        let application = |name: &str, process| RunningApplication {
            application: name.to_owned(),
            process,
            socket: format!("/run/{name}-{process}.sock").into(),
        };
        let (patrol, mapping) = (application("patrol", 1), application("my_map", 2));
        let twice = application("patrol", 3);
        let all = || vec![patrol.clone(), mapping.clone(), twice.clone()];
        let chosen = |running, name| choose(running, name).map_err(|error| error.to_string());
        assert!(
            chosen(vec![], None)
                .unwrap_err()
                .starts_with("no application is running")
        );
        assert_eq!(
            chosen(vec![patrol.clone()], None),
            Ok("/run/patrol-1.sock".into())
        );
        assert_eq!(
            chosen(all(), Some("my map")),
            Ok("/run/my_map-2.sock".into())
        );
        let unknown = chosen(all(), Some("cleaning")).unwrap_err();
        assert!(unknown.contains("no application 'cleaning'") && unknown.contains("process 3"));
        let several = chosen(all(), Some("patrol")).unwrap_err();
        assert!(several.contains("process 1") && !several.contains("my_map"));
        assert!(chosen(all(), None).unwrap_err().contains("my_map"));
    }
}
