//! Tasks that robots do together: messages from robot to robot, and data of links on their way.

use zenoh::Wait;
use zenoh::qos::{CongestionControl, Priority};

use super::{Inlet, Node, NodeError, Outlet, key, publisher, refused, subscribe};
use crate::message::{self, BadMessage};
use crate::task::TaskMessage;

impl Node {
    /// Tells one robot something about a task. It waits where the network is busy: a message that is
    /// lost would hold a decision up until its deadline.
    ///
    /// # Errors
    /// When the network does not take it, or it is too long.
    pub fn tell(&self, own: &str, robot: &str, message: &TaskMessage) -> Result<(), NodeError> {
        let key = key::task(own, robot);
        let bytes = message::encode(message).map_err(refused(&key))?;
        self.session
            .put(&key, bytes)
            .congestion_control(CongestionControl::Block)
            .priority(Priority::RealTime)
            .express(true)
            .wait()
            .map_err(refused(&key))
    }

    /// Passes on what others tell this robot about tasks, and by whom it comes, on threads of the
    /// network's; `take` must not wait.
    ///
    /// # Errors
    /// When the network does not take it.
    pub fn listen_to_tasks(
        &self,
        own: &str,
        take: impl Fn(&str, Result<TaskMessage, BadMessage>) + Send + Sync + 'static,
    ) -> Result<Inlet, NodeError> {
        let subscriber = subscribe(&self.session, &key::task("*", own), move |sample| {
            if let Some(robot) = key::robot(sample.key_expr().as_str()) {
                take(robot, message::decode(&sample.payload().to_bytes()));
            }
        });
        Ok(Inlet {
            _subscriber: subscriber?,
        })
    }

    /// The way for data of a link to another robot; `name` tells links apart.
    ///
    /// # Errors
    /// When the network does not take it.
    pub fn flow_to(&self, own: &str, robot: &str, name: &str) -> Result<Outlet, NodeError> {
        let publisher = publisher(&self.session, &key::flow(own, robot, name))?;
        Ok(Outlet { publisher })
    }

    /// Passes on the frames of all links that lead to this robot: by whom, of which link. They are
    /// listened for all the time, so that none is lost when a link comes into use.
    ///
    /// # Errors
    /// When the network does not take it.
    pub fn listen_to_flows(
        &self,
        own: &str,
        take: impl Fn(&str, &str, &[u8]) + Send + Sync + 'static,
    ) -> Result<Inlet, NodeError> {
        let subscriber = subscribe(&self.session, &key::flow("*", own, "**"), move |sample| {
            if let Some((robot, name)) = key::flow_of(sample.key_expr().as_str()) {
                take(robot, name, &sample.payload().to_bytes());
            }
        });
        Ok(Inlet {
            _subscriber: subscriber?,
        })
    }
}
