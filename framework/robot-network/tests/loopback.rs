//! Two robots of one process over loopback: they find each other, answer each other, and part.

use std::net::TcpListener;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use robot_network::message::{Beat, ComponentEntry, Database, FaultNotice};
use robot_network::task::{TaskContent, TaskMessage};
use robot_network::{Answers, Heard, Node, NodeError, OpenOptions};

/// Loopback needs milliseconds; a busy machine gets a thousand times that.
const LIMIT: Duration = Duration::from_secs(20);

/// A robot with one component, of which it has a package.
struct Dehazing;

impl Answers for Dehazing {
    fn database(&self) -> Database {
        Database {
            robot: "R2".to_owned(),
            architecture: "x86_64-linux".to_owned(),
            abi: 1,
            components: vec![ComponentEntry {
                name: "dehazer".to_owned(),
                library: "software_dehazer".to_owned(),
                library_sha256: "00".repeat(32),
                runs: false,
                offers: Vec::new(),
            }],
        }
    }

    fn package(&self, component: &str) -> Option<Vec<u8>> {
        // More than one datagram and than one batch of the transport.
        (component == "dehazer").then(|| vec![7; 3 << 20])
    }
}

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

fn options(robot: &str, listen: Option<u16>, connect: Option<u16>) -> OpenOptions {
    let address = |port: u16| format!("tcp/127.0.0.1:{port}");
    OpenOptions {
        robot: robot.to_owned(),
        incarnation: 7,
        listen: listen.map(address).into_iter().collect(),
        connect: connect.map(address).into_iter().collect(),
        scouting: false,
        silence_limit: Duration::from_secs(2),
        security: None,
    }
}

/// `R1`, and `R2` to which it has connected.
fn two(answers: Dehazing) -> (Node, Node) {
    let free = TcpListener::bind(("127.0.0.1", 0)).expect("a free port");
    let port = free.local_addr().expect("its address").port();
    drop(free);
    let second = Node::open(&options("R2", Some(port), None), answers).expect("R2");
    let first = Node::open(&options("R1", None, Some(port)), Silent).expect("R1");
    let alive = |it: &Heard| matches!(it, Heard::Alive { robot, .. } if robot == "R2");
    hear(&first, alive);
    let alive = |it: &Heard| matches!(it, Heard::Alive { robot, .. } if robot == "R1");
    hear(&second, alive);
    (first, second)
}

/// Waits for something.
fn hear(node: &Node, is_it: impl Fn(&Heard) -> bool) -> Heard {
    let deadline = Instant::now() + LIMIT;
    while Instant::now() < deadline {
        if let Some(heard) = node.heard(Duration::from_millis(100)).filter(&is_it) {
            return heard;
        }
    }
    panic!("it was not heard");
}

/// Repeats what may be lost while a subscription is on its way.
fn repeated_until<Item>(arrived: &Receiver<Item>, mut send: impl FnMut()) -> Item {
    let deadline = Instant::now() + LIMIT;
    while Instant::now() < deadline {
        send();
        if let Ok(item) = arrived.recv_timeout(Duration::from_millis(20)) {
            return item;
        }
    }
    panic!("nothing has arrived");
}

#[test]
fn robots_hear_beats_faults_and_data_and_see_each_other_go() {
    let (first, second) = two(Dehazing);
    let beat = Beat {
        incarnation: 7,
        term: 3,
        decider: Some("R2".to_owned()),
    };
    second.beat(&beat).expect("sent");
    let heard = hear(
        &first,
        |it| matches!(it, Heard::Beat { robot, .. } if robot == "R2"),
    );
    let robot = "R2".to_owned();
    assert_eq!(heard, Heard::Beat { robot, beat });
    let notice = FaultNotice {
        component: "camera".to_owned(),
        kind: "panic".to_owned(),
        t_ns: 5,
    };
    second.say_fault(&notice).expect("sent");
    let heard = hear(&first, |it| matches!(it, Heard::Fault { .. }));
    let robot = "R2".to_owned();
    assert_eq!(heard, Heard::Fault { robot, notice });

    let outlet = second
        .offer("R2", "dehazer", "clear_image")
        .expect("offered");
    let (sender, arrived) = channel();
    let inlet = first.listen(("R2", "dehazer", "clear_image"), move |frame| {
        let _test_is_over = sender.send(frame.to_vec());
    });
    let _inlet = inlet.expect("listened to");
    let picture = vec![9; 57_636];
    let seen = repeated_until(&arrived, || outlet.send(&picture).expect("sent"));
    assert_eq!(seen, picture);

    drop(outlet);
    drop(second);
    let gone = |it: &Heard| matches!(it, Heard::Gone { robot, incarnation: 7 } if robot == "R2");
    hear(&first, gone);
}

#[test]
fn robots_answer_what_they_are_asked() {
    let (first, _second) = two(Dehazing);
    let databases = first.databases(LIMIT).expect("asked");
    let names: Vec<&str> = databases.iter().map(|it| it.robot.as_str()).collect();
    assert_eq!(names, ["R1", "R2"]);
    assert_eq!(databases[1].components[0].library, "software_dehazer");
    let package = first.package("R2", "dehazer", LIMIT).expect("a package");
    assert_eq!(package.len(), 3 << 20);
    for nobody in [
        first.package("R2", "nothing", LIMIT).map(drop),
        first.package("R9", "dehazer", LIMIT).map(drop),
    ] {
        assert!(
            matches!(nobody, Err(NodeError::NoAnswer { .. })),
            "{nobody:?}"
        );
    }
}

#[test]
fn what_is_told_about_a_task_reaches_one_robot_and_says_by_whom_it_comes() {
    let (first, second) = two(Dehazing);
    let (sender, told) = channel();
    let flows = sender.clone();
    let _tasks = second
        .listen_to_tasks("R2", move |robot, message| {
            let message = message.expect("a message");
            let _over = sender.send(format!("{robot} tells in term {}", message.term));
        })
        .expect("listening");
    let _flows = second
        .listen_to_flows("R2", move |robot, name, frame| {
            let _over = flows.send(format!("{robot} sends {} bytes by {name}", frame.len()));
        })
        .expect("listening");
    let flow = first.flow_to("R1", "R2", "servoing/0/2").expect("a flow");
    let message = TaskMessage {
        task: "servoing".to_owned(),
        term: 3,
        incarnation: 1,
        content: TaskContent::Running {
            placements: vec![(0, 0)],
            decided: None,
        },
    };
    // Until the connection is there what is said reaches nobody.
    let began = Instant::now();
    let mut heard = Vec::new();
    while heard.len() < 2 && began.elapsed() < LIMIT {
        first.tell("R1", "R3", &message).expect("told");
        first.tell("R1", "R2", &message).expect("told");
        flow.send(&[0; 5]).expect("sent");
        let new = told.recv_timeout(Duration::from_millis(50));
        heard.extend(
            new.into_iter()
                .filter(|it| !heard.contains(it))
                .collect::<Vec<_>>(),
        );
    }
    heard.sort();
    let expected = ["R1 sends 5 bytes by servoing/0/2", "R1 tells in term 3"];
    assert_eq!(heard, expected);
}
