//! Secured connections: who proves his name is heard under that name, and nobody else is at all.

mod certificates;

use std::net::TcpListener;
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use certificates::Authority;
use robot_network::message::{Beat, Database};
use robot_network::{Answers, Heard, Inlet, Node, NodeError, OpenOptions};
use serde_json::json;
use system_model::network::NetworkSecurity;
use zenoh::Wait as _;

/// Loopback needs milliseconds; a busy machine gets a thousand times that.
const LIMIT: Duration = Duration::from_secs(20);

/// What an intruder says reaches nobody for so long; what a robot says does within milliseconds.
const PATIENCE: Duration = Duration::from_secs(1);

struct Silent;

impl Answers for Silent {
    fn database(&self) -> Database {
        Database {
            robot: "R1".to_owned(),
            architecture: String::new(),
            abi: 0,
            components: Vec::new(),
        }
    }
}

fn free_port() -> u16 {
    let free = TcpListener::bind(("127.0.0.1", 0)).expect("a free port");
    free.local_addr().expect("its address").port()
}

fn options(robot: &str, security: NetworkSecurity) -> OpenOptions {
    OpenOptions {
        robot: robot.to_owned(),
        incarnation: 7,
        listen: Vec::new(),
        connect: Vec::new(),
        scouting: false,
        silence_limit: Duration::from_secs(2),
        security: Some(security),
    }
}

/// A robot that listens, and one that connects to it.
fn listening(security: NetworkSecurity) -> (Node, u16) {
    let port = free_port();
    let mut options = options("R1", security);
    options.listen = vec![format!("tls/127.0.0.1:{port}")];
    (Node::open(&options, Silent).expect("R1"), port)
}

fn connecting(robot: &str, security: NetworkSecurity, port: u16) -> Node {
    let mut options = options(robot, security);
    options.connect = vec![format!("tls/127.0.0.1:{port}")];
    Node::open(&options, Silent).expect(robot)
}

/// Names of other robots that were heard, one for each thing heard.
fn heard(node: &Node, own: &str, limit: Duration) -> Vec<String> {
    let deadline = Instant::now() + limit;
    let mut robots = Vec::new();
    while Instant::now() < deadline {
        match node.heard(Duration::from_millis(50)) {
            Some(
                Heard::Alive { robot, .. }
                | Heard::Gone { robot, .. }
                | Heard::Beat { robot, .. }
                | Heard::Fault { robot, .. },
            ) if robot != own => robots.push(robot),
            Some(Heard::Unintelligible { key, .. }) => robots.push(key),
            _ => {}
        }
    }
    robots
}

/// Waits until a robot is heard; no third one may be.
fn hear(node: &Node, own: &str, robot: &str) {
    let deadline = Instant::now() + LIMIT;
    while Instant::now() < deadline {
        let robots = heard(node, own, Duration::from_millis(50));
        let others: Vec<&String> = robots.iter().filter(|it| *it != robot).collect();
        assert!(others.is_empty(), "{others:?} were heard");
        if !robots.is_empty() {
            return;
        }
    }
    panic!("{robot} was not heard");
}

fn listen_to(node: &Node, robot: &str) -> (Inlet, Receiver<Vec<u8>>) {
    let (sender, arrived) = channel();
    let inlet = node.listen((robot, "camera", "image"), move |frame| {
        let _test_is_over = sender.send(frame.to_vec());
    });
    (inlet.expect("listened to"), arrived)
}

#[test]
fn robots_that_prove_their_names_hear_ask_and_answer_each_other() {
    let authority = Authority::new("team");
    let (first, port) = listening(authority.security("R1", &["R2"]));
    let second = connecting("R2", authority.security("R2", &["R1"]), port);
    hear(&first, "R1", "R2");
    hear(&second, "R2", "R1");
    let (_inlet, arrived) = listen_to(&second, "R1");
    let outlet = first.offer("R1", "camera", "image").expect("offered");
    let deadline = Instant::now() + LIMIT;
    let picture = vec![9; 57_636];
    let seen = loop {
        outlet.send(&picture).expect("sent");
        if let Ok(seen) = arrived.recv_timeout(Duration::from_millis(20)) {
            break seen;
        }
        assert!(Instant::now() < deadline, "nothing has arrived");
    };
    assert_eq!(seen, picture);
    let beat = Beat {
        incarnation: 7,
        term: 3,
        decider: None,
    };
    second.beat(&beat).expect("sent");
    hear(&first, "R1", "R2");
    let databases = second.databases(LIMIT).expect("asked");
    assert!(databases.iter().any(|database| database.robot == "R1"));
    drop(second);
    hear(&first, "R1", "R2");
}

/// A session of zenoh's that obeys no rule of ours, with these credentials if any.
fn intruder(security: Option<&NetworkSecurity>, address: &str) -> zenoh::Session {
    let mut config = zenoh::Config::default();
    let mut set = |key: &str, value: serde_json::Value| {
        let set = config.insert_json5(key, &value.to_string());
        set.unwrap_or_else(|error| panic!("{key}: {error}"));
    };
    set("connect/endpoints", json!([address]));
    set("connect/exit_on_failure", json!(false));
    set("connect/timeout_ms", json!(-1));
    set("listen/endpoints", json!([]));
    set("scouting/multicast/enabled", json!(false));
    if let Some(security) = security {
        let file = |path: &Path| json!(path.to_str().expect("a name"));
        set(
            "transport/link/tls",
            json!({
                "enable_mtls": true,
                "verify_name_on_connect": false,
                "root_ca_certificate": file(&security.authority),
                "connect_certificate": file(&security.certificate),
                "connect_private_key": file(&security.private_key),
            }),
        );
    }
    zenoh::open(config).wait().expect("a session")
}

/// What a session says in the name of `R2` until time is over.
fn claim_to_be_r2(session: &zenoh::Session) {
    let deadline = Instant::now() + PATIENCE;
    let token = session.liveliness().declare_token("steadfast/alive/R2/9");
    let _token = token.wait().expect("declared");
    let beat = r#"{"incarnation":9,"term":9,"decider":"R2"}"#;
    while Instant::now() < deadline {
        for (key, content) in [
            ("steadfast/beat/R2", beat),
            ("steadfast/beat/*", beat),
            ("steadfast/port/R2/camera/image", "forged"),
            ("steadfast/port/*/camera/image", "forged"),
            ("**", "forged"),
        ] {
            session.put(key, content).wait().expect("sent");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Data of `R1` that an intruder hears.
fn overhears(session: &zenoh::Session, first: &Node) -> bool {
    let (sender, arrived) = channel();
    let subscriber = session
        .declare_subscriber("steadfast/**")
        .callback(move |_sample| {
            let _test_is_over = sender.send(());
        })
        .wait();
    let _subscriber = subscriber.expect("declared");
    let outlet = first.offer("R1", "camera", "image").expect("offered");
    let deadline = Instant::now() + PATIENCE;
    while Instant::now() < deadline {
        outlet.send(&[1, 2, 3]).expect("sent");
        std::thread::sleep(Duration::from_millis(20));
    }
    arrived.try_recv().is_ok()
}

#[test]
fn who_proves_no_name_or_another_one_gets_nothing_through() {
    let (authority, foreign) = (Authority::new("team"), Authority::new("other team"));
    let (first, port) = listening(authority.security("R1", &["R2", "R3"]));
    let (_inlet, forged) = listen_to(&first, "R2");
    let (secured, clear) = (
        format!("tls/127.0.0.1:{port}"),
        format!("tcp/127.0.0.1:{port}"),
    );
    let third = authority.security("R3", &[]);
    let unknown = authority.security("R9", &[]);
    let stranger = foreign.security("R2", &[]);
    for (who, security, address, may_listen) in [
        ("in the clear", None, &clear, false),
        ("without certificate", None, &secured, false),
        ("of a foreign authority", Some(&stranger), &secured, false),
        ("who is not allowed", Some(&unknown), &secured, false),
        ("of another name", Some(&third), &secured, true),
    ] {
        let session = intruder(security, address);
        claim_to_be_r2(&session);
        assert_eq!(
            overhears(&session, &first),
            may_listen,
            "one {who} overhears"
        );
        let robots = heard(&first, "R1", Duration::from_millis(100));
        assert_eq!(robots, [""; 0], "heard of one {who}");
        assert!(forged.try_recv().is_err(), "forged data of one {who} pass");
    }
    // All the while the true one is welcome.
    let _second = connecting("R2", authority.security("R2", &["R1"]), port);
    hear(&first, "R1", "R2");
}

#[test]
fn who_listens_is_not_believed_either_without_the_right_name() {
    let (authority, foreign) = (Authority::new("team"), Authority::new("other team"));
    for of_listener in [
        foreign.security("R1", &["R2"]),
        authority.security("R1", &["R9"]),
    ] {
        let (first, port) = listening(of_listener);
        let second = connecting("R2", authority.security("R2", &["R1"]), port);
        assert_eq!(heard(&first, "R1", PATIENCE), [""; 0]);
        assert_eq!(heard(&second, "R2", PATIENCE), [""; 0]);
    }
}

#[test]
fn credentials_that_nobody_would_believe_are_refused_at_once() {
    let (authority, foreign) = (Authority::new("team"), Authority::new("other team"));
    let good = authority.security("R1", &["R2"]);
    let other = authority.security("R3", &["R2"]);
    let absent = good.certificate.with_file_name("nothing.crt");
    let change = |change: &dyn Fn(&mut NetworkSecurity)| {
        let mut changed = good.clone();
        change(&mut changed);
        changed
    };
    for (security, words) in [
        (other.clone(), "is the certificate of 'R3', not of 'R1'"),
        (
            change(&|it| it.certificate = absent.clone()),
            "cannot be read: No such file",
        ),
        (
            change(&|it| it.private_key = other.private_key.clone()),
            "is not the private key of",
        ),
        (
            change(&|it| it.private_key = it.certificate.clone()),
            "holds no private key",
        ),
        (
            change(&|it| it.certificate = it.private_key.clone()),
            "holds no certificate",
        ),
        (
            change(&|it| it.authority = foreign.file()),
            "no robot that trusts",
        ),
        (authority.expired("R1"), "no robot that trusts"),
    ] {
        let opened = Node::open(&options("R1", security), Silent).map(drop);
        let error = opened.expect_err(words);
        assert!(matches!(error, NodeError::Credentials(_)), "{error}");
        let error = error.to_string();
        assert!(error.contains(words), "{error} has no '{words}'");
    }
}
