//! A package from another robot.

use std::time::{Duration, Instant};

use robot_network::message::Database;
use robot_network::{Answers, Credentials, Node, NodeError, OpenOptions};
use system_model::network::NetworkSecurity;

use crate::commands::exit_code;
use crate::commands::run::Failed;

/// A connection stands within milliseconds; a machine that has just been switched on gets more.
const CONNECTION_LIMIT: Duration = Duration::from_secs(10);
/// A robot that is asked for the first time reads all its libraries.
const ANSWER_LIMIT: Duration = Duration::from_secs(2);
/// The largest package over a radio link of 30 Mbit/s.
const TRANSFER_LIMIT: Duration = Duration::from_secs(60);
/// Between two questions of a robot that is not there yet.
const PAUSE: Duration = Duration::from_millis(50);

/// Who only asks.
struct Visitor;

impl Answers for Visitor {
    fn database(&self) -> Database {
        Database {
            robot: String::new(),
            architecture: String::new(),
            abi: 0,
            components: Vec::new(),
        }
    }
}

/// Asks a robot for the package of a component.
pub(super) fn fetch(
    component: &str,
    robot: &str,
    address: &str,
    security: Option<NetworkSecurity>,
) -> Result<Vec<u8>, Failed> {
    let visitor = match &security {
        Some(security) => {
            let credentials = Credentials::read(security).map_err(NodeError::Credentials);
            credentials
                .map_err(|error| failed(&error))?
                .name()
                .to_owned()
        }
        None => format!("visitor_{}", std::process::id()),
    };
    let node = Node::open(
        &OpenOptions {
            robot: visitor,
            incarnation: 1,
            listen: Vec::new(),
            connect: vec![address.to_owned()],
            scouting: false,
            silence_limit: CONNECTION_LIMIT,
            security,
        },
        Visitor,
    );
    let node = node.map_err(|error| failed(&error))?;
    let deadline = Instant::now() + CONNECTION_LIMIT;
    let is_there = || {
        let databases = node.databases(ANSWER_LIMIT).unwrap_or_default();
        databases.iter().any(|database| database.robot == robot)
    };
    while !is_there() {
        if Instant::now() > deadline {
            return Err(Failed {
                code: exit_code::FILE,
                text: format!(
                    "no robot '{robot}' answers at {address}\n  help: does it run, listen there, \
                     and, if its connections are secured, allow the name in the certificate?"
                ),
            });
        }
        std::thread::sleep(PAUSE);
    }
    node.package(robot, component, TRANSFER_LIMIT)
        .map_err(|error| match error {
            NodeError::NoAnswer { .. } => Failed {
                code: exit_code::REFUSED,
                text: format!(
                    "robot '{robot}' gives away no package of '{component}'\n  help: put \
                     {component}.sfp into the folder that its <network packages=\"…\"> names"
                ),
            },
            other => failed(&other),
        })
}

fn failed(error: &NodeError) -> Failed {
    Failed {
        code: exit_code::SYSTEM,
        text: error.to_string(),
    }
}
