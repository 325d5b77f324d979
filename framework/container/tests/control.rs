//! The control socket with clients of all manners; a hostile one changes nothing for the others.
#![forbid(unsafe_code)]

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::Shutdown;
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use container::control::client::Client;
use container::control::protocol::MAX_REQUEST_BYTES;
use container::control::{Answer, Control, Limits, Request, Server};
use serde_json::json;

/// Longer than anything here takes.
const PATIENCE: Duration = Duration::from_secs(20);

/// Answers with a text of this length, and remembers what it was asked.
struct Fake {
    answer: String,
    asked: Mutex<Vec<Request>>,
}

impl Control for Fake {
    fn handle(&self, request: Request) -> Answer {
        let answer = match &request {
            Request::FaultShow { id } => Answer::Refused(format!("there is no fault {id}")),
            _ => Answer::done("status", self.answer.clone()),
        };
        self.asked.lock().unwrap().push(request);
        answer
    }
}

struct Fixture {
    folder: tempfile::TempDir,
    control: Arc<Fake>,
    server: Server,
}

impl Fixture {
    fn new(answer_bytes: usize, limits: Limits) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let control = Arc::new(Fake {
            answer: "a".repeat(answer_bytes),
            asked: Mutex::default(),
        });
        let inner = folder.path().join("steadfast");
        let shared = Arc::clone(&control);
        let server = Server::start_in(&inner, "patrol", shared, limits).unwrap();
        Self {
            folder,
            control,
            server,
        }
    }

    fn client(&self) -> Client {
        Client::connect(self.server.path()).unwrap()
    }

    fn stream(&self) -> UnixStream {
        let stream = UnixStream::connect(self.server.path()).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// Makes sure that a request is answered, at the latest when the server has seen that a place
    /// is free.
    #[track_caller]
    fn answers(&self) {
        let expected = Answer::done("status", self.control.answer.clone());
        let began = Instant::now();
        // A client that is sent away may learn that by a broken pipe.
        while !matches!(self.client().ask(&Request::Status), Ok(answer) if answer == expected) {
            assert!(began.elapsed() < PATIENCE, "nobody is served any more");
        }
    }

    fn asked(&self) -> usize {
        self.control.asked.lock().unwrap().len()
    }
}

fn line_of(stream: &UnixStream) -> serde_json::Value {
    let mut line = String::new();
    BufReader::new(stream).read_line(&mut line).unwrap();
    serde_json::from_str(&line).expect("an answer")
}

/// Whether the server hangs up, after whatever it still says.
fn is_hung_up(mut stream: UnixStream) -> bool {
    let mut rest = Vec::new();
    match stream.read_to_end(&mut rest) {
        Ok(_) => true,
        Err(error) => error.kind() == std::io::ErrorKind::ConnectionReset,
    }
}

#[test]
fn requests_are_answered_one_after_the_other() {
    let fixture = Fixture::new(3, Limits::default());
    let mut client = fixture.client();
    for _ in 0..3 {
        let answer = client.ask(&Request::FaultList).unwrap();
        assert_eq!(answer, Answer::done("status", "aaa"));
    }
    let refused = client.ask(&Request::FaultShow { id: 7 }).unwrap();
    assert_eq!(refused, Answer::Refused("there is no fault 7".into()));
    assert_eq!(fixture.asked(), 4);
}

#[test]
fn large_answers_arrive_whole() {
    let fixture = Fixture::new(3_000_000, Limits::default());
    fixture.answers();
}

#[test]
fn several_lines_at_once_are_answered_in_order() {
    let fixture = Fixture::new(1, Limits::default());
    let mut stream = fixture.stream();
    let lines = "{\"request\":\"status\"}\nnonsense\n{\"request\":\"fault_show\",\"id\":1}\n";
    stream.write_all(lines.as_bytes()).unwrap();
    // As `nc -N` does: nothing more will come, but the answers are wanted.
    stream.shutdown(Shutdown::Write).unwrap();
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    let answers: Vec<serde_json::Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(answers.len(), 3, "{text}");
    assert_eq!(answers[0], json!({"ok": true, "status": "a"}));
    assert_eq!(answers[1]["ok"], json!(false));
    assert_eq!(answers[2]["error"], json!("there is no fault 1"));
}

#[test]
fn garbage_is_refused_in_words_and_reaches_nobody() {
    let fixture = Fixture::new(1, Limits::default());
    for garbage in [
        &b"\n"[..],
        b"GET / HTTP/1.1\n",
        b"\xff\xfe\x00\n",
        b"{\"request\":\"reboot\"}\n",
    ] {
        let mut stream = fixture.stream();
        stream.write_all(garbage).unwrap();
        let answer = line_of(&stream);
        assert_eq!(answer["ok"], json!(false), "{garbage:?}");
        assert!(answer["error"].is_string());
    }
    assert_eq!(fixture.asked(), 0);
    fixture.answers();
}

#[test]
fn a_line_without_an_end_is_cut_off() {
    let fixture = Fixture::new(1, Limits::default());
    let mut stream = fixture.stream();
    // The server may hang up before all is written.
    let _may_break = stream.write_all(&vec![b'a'; MAX_REQUEST_BYTES + 1]);
    assert_eq!(line_of(&stream)["ok"], json!(false));
    assert!(is_hung_up(stream));
    assert_eq!(fixture.asked(), 0);
    fixture.answers();
}

#[test]
fn half_a_line_is_no_request() {
    let fixture = Fixture::new(1, Limits::default());
    let mut stream = fixture.stream();
    stream
        .write_all(b"{\"request\":\"fault_clear\",\"id\":null}")
        .unwrap();
    drop(stream);
    fixture.answers();
    assert_eq!(fixture.asked(), 1);
}

#[test]
fn clients_that_hang_up_or_never_read_are_let_go() {
    let limits = Limits {
        clients: 4,
        deadline: Duration::from_millis(300),
    };
    // More than the buffers of a socket hold.
    let fixture = Fixture::new(4_000_000, limits);
    for _ in 0..20 {
        let mut stream = fixture.stream();
        stream.write_all(b"{\"request\":\"status\"}\n").unwrap();
        drop(stream);
    }
    fixture.answers();
    let never_read: Vec<UnixStream> = (0..2)
        .map(|_| {
            let mut stream = fixture.stream();
            stream.write_all(b"{\"request\":\"status\"}\n").unwrap();
            stream
        })
        .collect();
    let silent = fixture.stream();
    // While they hold their places there is one for those who keep to the protocol.
    fixture.answers();
    assert!(is_hung_up(silent));
    for mut stream in never_read {
        let mut some = Vec::new();
        let _may_be_reset = stream.read_to_end(&mut some);
        assert!(some.len() < 4_000_000, "the answer was never finished");
    }
    fixture.answers();
}

#[test]
fn a_line_that_comes_a_byte_at_a_time_does_not_keep_its_place() {
    let limits = Limits {
        clients: 1,
        deadline: Duration::from_millis(200),
    };
    let fixture = Fixture::new(1, limits);
    let mut slow = fixture.stream();
    let began = Instant::now();
    while slow.write_all(b" ").is_ok() {
        assert!(began.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(10));
    }
    fixture.answers();
}

#[test]
fn one_client_too_many_is_told_so() {
    let limits = Limits {
        clients: 2,
        ..Limits::default()
    };
    let fixture = Fixture::new(1, limits);
    let mut taken: Vec<Client> = (0..2).map(|_| fixture.client()).collect();
    for client in &mut taken {
        client.ask(&Request::Status).unwrap();
    }
    let stream = fixture.stream();
    assert_eq!(line_of(&stream)["ok"], json!(false));
    assert!(is_hung_up(stream));
    taken.pop();
    fixture.answers();
}

#[test]
fn the_socket_is_its_owners_and_goes_with_its_server() {
    let fixture = Fixture::new(1, Limits::default());
    let path = fixture.server.path().to_owned();
    let mode = std::fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    let again = Server::start_in(
        &fixture.folder.path().join("steadfast"),
        "patrol",
        Arc::clone(&fixture.control) as Arc<dyn Control>,
        Limits::default(),
    );
    assert_eq!(
        again.map(|_| ()).unwrap_err().to_string(),
        "this process runs an application 'patrol' already"
    );
    fixture.answers();
    let idle = fixture.stream();
    drop(fixture.server);
    assert!(!path.exists());
    assert!(is_hung_up(idle));
    assert!(Client::connect(&path).is_err());
}

#[test]
fn a_socket_that_nobody_listens_at_any_more_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("steadfast");
    let fixture = Fixture::new(1, Limits::default());
    let name = fixture.server.path().file_name().unwrap().to_owned();
    std::fs::create_dir(&inner).unwrap();
    std::fs::set_permissions(&inner, std::fs::Permissions::from_mode(0o700)).unwrap();
    drop(std::os::unix::net::UnixListener::bind(inner.join(&name)).unwrap());
    assert!(inner.join(&name).exists());
    let control = Arc::clone(&fixture.control) as Arc<dyn Control>;
    let server = Server::start_in(&inner, "patrol", control, Limits::default()).unwrap();
    let answer = Client::connect(server.path())
        .unwrap()
        .ask(&Request::Status);
    assert_eq!(answer.unwrap(), Answer::done("status", "a"));
}
