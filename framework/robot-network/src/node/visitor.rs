//! Somebody who only asks: robots do not see that he is there, and he is no robot of their team.

use std::time::Duration;

use zenoh::Wait;

use super::{NodeError, OpenOptions, configuration, questions};
use crate::message::Database;

/// A session that asks and is not asked.
pub struct Visitor {
    session: zenoh::Session,
}

impl Visitor {
    /// Enters the network under a robot's name, without being that robot: its life is still to come.
    ///
    /// # Errors
    /// As [`super::Node::open`].
    pub fn enter(options: &OpenOptions) -> Result<Self, NodeError> {
        let session = zenoh::open(configuration::of(options)?).wait();
        let session = session.map_err(|error| NodeError::Open {
            reason: error.to_string(),
        })?;
        Ok(Self { session })
    }

    /// As [`super::Node::databases`].
    ///
    /// # Errors
    /// When the network does not take the question.
    pub fn databases(&self, limit: Duration) -> Result<Vec<Database>, NodeError> {
        questions::databases(&self.session, limit)
    }

    /// As [`super::Node::package`].
    ///
    /// # Errors
    /// When there is none within `limit`, or it is larger than any package may be.
    pub fn package(
        &self,
        robot: &str,
        component: &str,
        limit: Duration,
    ) -> Result<Vec<u8>, NodeError> {
        questions::package(&self.session, (robot, component), limit)
    }
}
