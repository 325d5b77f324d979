//! A package from another robot.

use std::time::{Duration, Instant};

use robot_network::{Credentials, NodeError, OpenOptions, Visitor};
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

/// How long a package is waited for.
#[derive(Debug, Clone, Copy)]
pub(in crate::commands) struct Deadlines {
    /// When the robot must have been seen.
    pub(in crate::commands) seen: Instant,
    /// When the package must be here.
    pub(in crate::commands) sent: Instant,
}

/// Why there is no package.
#[derive(Debug)]
pub(in crate::commands) enum NotSent {
    /// The robot is not there.
    Absent,
    /// It has none to give.
    NotGiven,
    /// It has not come in time.
    Late,
    /// The network refuses.
    Network(NodeError),
}

/// Fetches the package of a component from the robot at an address.
pub(super) fn fetch(
    component: &str,
    robot: &str,
    address: &str,
    security: Option<NetworkSecurity>,
) -> Result<Vec<u8>, Failed> {
    let name = match &security {
        Some(security) => {
            let credentials = Credentials::read(security).map_err(NodeError::Credentials);
            let credentials = credentials.map_err(|error| failed(&error))?;
            credentials.name().to_owned()
        }
        None => format!("visitor_{}", std::process::id()),
    };
    let options = OpenOptions {
        robot: name,
        incarnation: 1,
        listen: Vec::new(),
        connect: vec![address.to_owned()],
        scouting: false,
        silence_limit: CONNECTION_LIMIT,
        security,
    };
    let visitor = Visitor::enter(&options).map_err(|error| failed(&error))?;
    let now = Instant::now();
    let deadlines = Deadlines {
        seen: now + CONNECTION_LIMIT,
        sent: now + CONNECTION_LIMIT + TRANSFER_LIMIT,
    };
    ask(&visitor, robot, component, deadlines).map_err(|error| match error {
        NotSent::Absent => Failed {
            code: exit_code::FILE,
            text: format!(
                "no robot '{robot}' answers at {address}\n  help: does it run, listen there, and, if its \
                 connections are secured, allow the name in the certificate?"
            ),
        },
        NotSent::NotGiven => Failed {
            code: exit_code::REFUSED,
            text: format!(
                "robot '{robot}' gives away no package of '{component}'\n  help: {}",
                give_away(component)
            ),
        },
        NotSent::Late => Failed {
            code: exit_code::FILE,
            text: format!(
                "the package of '{component}' has not come within {} s\n  help: is the connection to \
                 '{robot}' slow? take the package there by hand, and open it with `steadfast package \
                 open`",
                TRANSFER_LIMIT.as_secs()
            ),
        },
        NotSent::Network(error) => failed(&error),
    })
}

/// What is to be done on a robot that gives away no package of a component.
pub(in crate::commands) fn give_away(component: &str) -> String {
    format!("put {component}.sfp into the folder that its <network packages=\"…\"> names")
}

/// Asks a robot for the package of a component, as soon as it is there.
pub(in crate::commands) fn ask(
    visitor: &Visitor,
    robot: &str,
    component: &str,
    deadlines: Deadlines,
) -> Result<Vec<u8>, NotSent> {
    let left = |until: Instant| until.saturating_duration_since(Instant::now());
    let is_there = || {
        let limit = ANSWER_LIMIT.min(left(deadlines.seen));
        let databases = visitor.databases(limit).unwrap_or_default();
        databases.iter().any(|database| database.robot == robot)
    };
    while !is_there() {
        if left(deadlines.seen).is_zero() {
            return Err(NotSent::Absent);
        }
        std::thread::sleep(PAUSE.min(left(deadlines.seen)));
    }
    let package = visitor.package(robot, component, left(deadlines.sent));
    package.map_err(|error| match error {
        NodeError::NoAnswer { .. } if left(deadlines.sent).is_zero() => NotSent::Late,
        NodeError::NoAnswer { .. } => NotSent::NotGiven,
        other => NotSent::Network(other),
    })
}

fn failed(error: &NodeError) -> Failed {
    Failed {
        code: exit_code::SYSTEM,
        text: error.to_string(),
    }
}
