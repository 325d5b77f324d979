//! As much of HTTP as it takes to be scraped: one client at a time, a small request, an answer, the end.
//! Whoever is slow is let go; the kernel keeps a few others waiting meanwhile.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::os::unix::net::UnixStream;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, poll};

use super::Metrics;

/// In which a client has sent its request, and again in which it has read the answer: a scraper on the
/// same machine takes a millisecond.
const CLIENT_LIMIT: Duration = Duration::from_secs(1);

/// A longer head of a request is none of a scraper.
const MAX_REQUEST_BYTES: usize = 8 * 1024;

/// A process without descriptors to spare has worse to do than to look for them all the time.
const PAUSE_WITHOUT_DESCRIPTORS: Duration = Duration::from_millis(100);

const CONTENT_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// The server. Its thread and its socket end when it is dropped.
#[derive(Debug)]
pub struct MetricsServer {
    address: SocketAddr,
    /// Closed to end the thread.
    stop: Option<UnixStream>,
    thread: Option<JoinHandle<()>>,
}

impl MetricsServer {
    /// Serves these figures at `/metrics`.
    ///
    /// # Errors
    /// If the system refuses socket or thread.
    pub fn start(listener: TcpListener, metrics: Metrics) -> io::Result<Self> {
        let address = listener.local_addr()?;
        listener.set_nonblocking(true)?;
        let (stop, stopped) = UnixStream::pair()?;
        let thread = std::thread::Builder::new()
            .name("metrics".to_owned())
            .spawn(move || serve(&listener, &stopped, &metrics))?;
        Ok(Self {
            address,
            stop: Some(stop),
            thread: Some(thread),
        })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for MetricsServer {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _panicked_and_so_ended = thread.join();
        }
    }
}

fn serve(listener: &TcpListener, stopped: &UnixStream, metrics: &Metrics) {
    loop {
        let mut descriptors = [
            PollFd::new(stopped, PollFlags::IN),
            PollFd::new(listener, PollFlags::IN),
        ];
        match poll(&mut descriptors, None) {
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            // Without poll there is nothing to serve with.
            Err(_) => return,
        }
        if !descriptors[0].revents().is_empty() {
            return;
        }
        match listener.accept() {
            // One that hangs up, or is too slow, is let go.
            Ok((stream, _)) => drop(answer(stream, metrics)),
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
            Err(_) => std::thread::sleep(PAUSE_WITHOUT_DESCRIPTORS),
        }
    }
}

fn answer(mut stream: TcpStream, metrics: &Metrics) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    let request = request(&mut stream)?;
    let (status, kind, body) = match Wanted::of(&request) {
        Wanted::Figures => ("200 OK", CONTENT_TYPE, metrics.text()),
        Wanted::Other(status, words) => (status, "text/plain; charset=utf-8", words.to_owned()),
    };
    let answer = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n\
         Connection: close\r\n\r\n{body}",
        body.len()
    );
    write(&mut stream, answer.as_bytes())
}

/// The head of a request, up to its empty line.
fn request(stream: &mut TcpStream) -> io::Result<Vec<u8>> {
    let deadline = Instant::now() + CLIENT_LIMIT;
    let mut request = Vec::new();
    let mut chunk = [0; 1024];
    while !request.windows(4).any(|end| end == b"\r\n\r\n") && request.len() < MAX_REQUEST_BYTES {
        stream.set_read_timeout(Some(left(deadline)?))?;
        match stream.read(&mut chunk)? {
            0 => break,
            count => request.extend_from_slice(&chunk[..count]),
        }
    }
    Ok(request)
}

fn write(stream: &mut TcpStream, mut answer: &[u8]) -> io::Result<()> {
    let deadline = Instant::now() + CLIENT_LIMIT;
    while !answer.is_empty() {
        stream.set_write_timeout(Some(left(deadline)?))?;
        let count = stream.write(answer)?;
        answer = &answer[count..];
    }
    Ok(())
}

fn left(deadline: Instant) -> io::Result<Duration> {
    let left = deadline.saturating_duration_since(Instant::now());
    match left.is_zero() {
        true => Err(ErrorKind::TimedOut.into()),
        false => Ok(left),
    }
}

/// What a request is for.
#[derive(Debug, PartialEq, Eq)]
enum Wanted {
    Figures,
    /// Status line and words.
    Other(&'static str, &'static str),
}

impl Wanted {
    fn of(request: &[u8]) -> Self {
        let line = request.split(|byte| *byte == b'\r').next();
        let words: Vec<&[u8]> = line
            .unwrap_or_default()
            .split(|byte| *byte == b' ')
            .collect();
        match words[..] {
            [b"GET", target, version] if version.starts_with(b"HTTP/1.") => {
                match target.split(|byte| *byte == b'?').next() {
                    Some(b"/metrics") => Self::Figures,
                    Some(b"/") => Self::Other("200 OK", "the figures are at /metrics\n"),
                    _ => Self::Other("404 Not Found", "there is nothing but /metrics\n"),
                }
            }
            [_, _, version] if version.starts_with(b"HTTP/1.") => {
                Self::Other("405 Method Not Allowed", "figures can only be read: GET\n")
            }
            _ => Self::Other("400 Bad Request", "this is no request of HTTP 1\n"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests() {
        for (request, expected) in [
            (&b"GET /metrics HTTP/1.1\r\nHost: a\r\n\r\n"[..], "figures"),
            (b"GET /metrics?a=b HTTP/1.0\r\n\r\n", "figures"),
            (b"GET / HTTP/1.1\r\n\r\n", "200"),
            (b"GET /metric HTTP/1.1\r\n\r\n", "404"),
            (b"POST /metrics HTTP/1.1\r\n\r\n", "405"),
            (b"GET /metrics\r\n\r\n", "400"),
            (b"GET  /metrics HTTP/1.1\r\n\r\n", "400"),
            (b"\x16\x03\x01\x02\x00", "400"),
            (b"", "400"),
        ] {
            let found = match Wanted::of(request) {
                Wanted::Figures => "figures",
                Wanted::Other(status, _) => &status[..3],
            };
            assert_eq!(found, expected, "{request:?}");
        }
    }
}
