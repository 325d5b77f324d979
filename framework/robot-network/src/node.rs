//! One robot's place in the network: the shell over zenoh.
//!
//! Everything lies below `steadfast/`: `alive/R/life` are tokens, `beat/R` signs of life, `port/R/
//! component/port` data, `fault/R` faults, `task/R/S` and `flow/R/S/link` what R tells S about a task
//! and gives it, and `database/R`, `package/R` are asked.
//! zenoh's own threads bring what comes; what waits for this robot has a bound.

mod access;
mod configuration;
mod hearing;
mod key;
mod questions;
mod tasks;
mod visitor;

use std::time::Duration;

use crossbeam::channel::{Receiver, bounded};
use thiserror::Error;
use zenoh::Wait;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::Queryable;
use zenoh::sample::Sample;

use crate::credentials::BadCredentials;
use crate::message::{self, Beat, FaultNotice};
pub use configuration::OpenOptions;
pub use hearing::Heard;
use hearing::{hear_beats, hear_faults, hear_tokens};
pub use questions::Answers;
pub use visitor::Visitor;

/// Signs of life and faults that may wait for this robot: four seconds of a team of sixty that beats
/// ten times a second with faults besides. The next beat says what a lost one has said.
const WAITING: usize = 4096;

/// The network refuses.
#[derive(Debug, Error)]
pub enum NodeError {
    /// There is no place in the network to be had.
    #[error(
        "the network cannot be entered: {reason}; is another program listening there, and is \
             every address written like `tcp/192.168.0.2:7447`?"
    )]
    Open {
        /// What zenoh says.
        reason: String,
    },
    /// The robot cannot prove its name.
    #[error("the network cannot be entered: {0}")]
    Credentials(#[source] BadCredentials),
    /// Something cannot be declared or sent.
    #[error("the network does not take '{what}': {reason}")]
    Refused {
        /// What.
        what: String,
        /// What zenoh says.
        reason: String,
    },
    /// A question that nobody has answered in time.
    #[error("'{what}' was not answered within {} ms", limit.as_millis())]
    NoAnswer {
        /// What was asked.
        what: String,
        /// How long was waited.
        limit: Duration,
    },
    /// An answer that is not understood.
    #[error("the answer to '{what}' cannot be understood: {reason}")]
    Answer {
        /// What was asked.
        what: String,
        /// What is wrong with it.
        reason: String,
    },
}

/// This robot in the network. What it has declared ends with it.
pub struct Node {
    session: zenoh::Session,
    beats: Publisher<'static>,
    faults: Publisher<'static>,
    heard: Receiver<Heard>,
    _token: LivelinessToken,
    _listening: Vec<Subscriber<()>>,
    _answering: Vec<Queryable<()>>,
}

/// An output that other robots may listen to.
pub struct Outlet {
    publisher: Publisher<'static>,
}

/// An output of another robot that is listened to, as long as this lives.
pub struct Inlet {
    _subscriber: Subscriber<()>,
}

impl Node {
    /// Enters the network. Other robots ask `answers` from now on.
    ///
    /// # Errors
    /// When an address to listen at cannot be had, or the files that connections are secured with do
    /// not prove the robot's name.
    pub fn open(options: &OpenOptions, answers: impl Answers) -> Result<Self, NodeError> {
        let config = configuration::of(options)?;
        let session = zenoh::open(config)
            .wait()
            .map_err(|error| NodeError::Open {
                reason: error.to_string(),
            })?;
        let (sender, heard) = bounded(WAITING);
        let robot = &options.robot;
        let listening = vec![
            subscribe(
                &session,
                "steadfast/beat/*",
                hear_beats(robot.clone(), sender.clone()),
            )?,
            subscribe(
                &session,
                "steadfast/fault/*",
                hear_faults(robot.clone(), sender.clone()),
            )?,
        ];
        let tokens = session
            .liveliness()
            .declare_subscriber("steadfast/alive/*/*")
            .history(true)
            .callback(hear_tokens(robot.clone(), sender))
            .wait()
            .map_err(refused("steadfast/alive/*/*"))?;
        let answering = questions::answer(&session, robot, answers)?;
        let token = key::alive(robot, options.incarnation);
        let token = session
            .liveliness()
            .declare_token(&token)
            .wait()
            .map_err(refused(&token))?;
        Ok(Self {
            beats: publisher(&session, &key::beat(robot))?,
            faults: publisher(&session, &key::fault(robot))?,
            session,
            heard,
            _token: token,
            _listening: listening.into_iter().chain([tokens]).collect(),
            _answering: answering,
        })
    }

    /// Shows that this robot is alive.
    ///
    /// # Errors
    /// When the network does not take it.
    pub fn beat(&self, beat: &Beat) -> Result<(), NodeError> {
        say(&self.beats, beat)
    }

    /// Tells all others of a fault.
    ///
    /// # Errors
    /// When the network does not take it.
    pub fn say_fault(&self, notice: &FaultNotice) -> Result<(), NodeError> {
        say(&self.faults, notice)
    }

    /// What comes next from others; none if nothing comes within `limit`.
    pub fn heard(&self, limit: Duration) -> Option<Heard> {
        self.heard.recv_timeout(limit).ok()
    }

    /// Offers an output to the others.
    ///
    /// # Errors
    /// When the network does not take it.
    pub fn offer(&self, robot: &str, component: &str, port: &str) -> Result<Outlet, NodeError> {
        let publisher = publisher(&self.session, &key::port(robot, component, port))?;
        Ok(Outlet { publisher })
    }

    /// Listens to an output of another robot: `take` gets each frame that comes, on a thread of the
    /// network's, and must not wait.
    ///
    /// # Errors
    /// When the network does not take it.
    pub fn listen(
        &self,
        (robot, component, port): (&str, &str, &str),
        take: impl Fn(&[u8]) + Send + Sync + 'static,
    ) -> Result<Inlet, NodeError> {
        let key = key::port(robot, component, port);
        let subscriber = self
            .session
            .declare_subscriber(&key)
            .callback(move |sample| take(&sample.payload().to_bytes()))
            .wait()
            .map_err(refused(&key))?;
        Ok(Inlet {
            _subscriber: subscriber,
        })
    }
}

impl Outlet {
    /// Sends a frame. One that the network cannot take at once is dropped: the next one is newer.
    ///
    /// # Errors
    /// When the network does not take it at all.
    pub fn send(&self, frame: &[u8]) -> Result<(), NodeError> {
        self.publisher
            .put(frame)
            .wait()
            .map_err(refused(self.publisher.key_expr().as_str()))
    }
}

fn refused<Error: ToString>(what: &str) -> impl FnOnce(Error) -> NodeError {
    move |error| NodeError::Refused {
        what: what.to_owned(),
        reason: error.to_string(),
    }
}

/// Nothing is gathered before it is sent, and nothing is waited for: a robot that hangs must not
/// hold up the others.
fn publisher(session: &zenoh::Session, key: &str) -> Result<Publisher<'static>, NodeError> {
    session
        .declare_publisher(key.to_owned())
        .congestion_control(CongestionControl::Drop)
        .priority(Priority::RealTime)
        .express(true)
        .wait()
        .map_err(refused(key))
}

fn say(publisher: &Publisher<'_>, said: &impl serde::Serialize) -> Result<(), NodeError> {
    let key = publisher.key_expr().as_str();
    let bytes = message::encode(said).map_err(refused(key))?;
    publisher.put(bytes).wait().map_err(refused(key))
}

fn subscribe(
    session: &zenoh::Session,
    key: &str,
    take: impl Fn(Sample) + Send + Sync + 'static,
) -> Result<Subscriber<()>, NodeError> {
    session
        .declare_subscriber(key)
        .callback(take)
        .wait()
        .map_err(refused(key))
}
