//! The way to robots whose applications run in other containers.

use std::sync::Arc;

use robot_network::task::{TaskContent, TaskMessage};
use system_model::data_type::DataType;
use system_model::task::RobotIndex;

use super::wiring::Hop;
use crate::network::Entrance;
use crate::port::{ConnectionId, Newest, Receiver, Sender};
use crate::wake::Wake;

/// The robots of a task as this one sees them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Teammates {
    /// Who decides; none until all have had time to be heard.
    pub decider: Option<RobotIndex>,
    /// The latest term.
    pub term: u64,
    /// Who is alive, this robot among them.
    pub alive: Vec<RobotIndex>,
}

/// Carries messages and connections of a task from robot to robot.
pub trait Passage: Send {
    /// What is written to the sender goes to the robot at the end of a connection; the wake tells that
    /// something was written.
    ///
    /// # Errors
    /// Why nothing can be sent there, in words.
    fn send_out(&mut self, hop: &Hop, data_type: &DataType) -> Result<(Sender, Arc<Wake>), String>;

    /// What comes by a connection from another robot.
    fn let_in(&mut self, hop: &Hop, entrance: Entrance) -> Receiver;

    /// When the newest datum came by a connection, in nanoseconds of the container's clock; none before
    /// the first.
    fn newest_ns(&self, hop: &Hop) -> Option<u64>;

    /// Where the time is left of the newest datum of what comes by this connection; none if it is
    /// none of these.
    fn watched(&self, connection: &ConnectionId) -> Option<Arc<Newest>>;

    /// Carries nothing by a connection any more; what was to be written to, if it led out.
    fn close(&mut self, hop: &Hop) -> Option<ConnectionId>;

    /// Tells a robot something.
    fn tell(&mut self, robot: RobotIndex, content: TaskContent);

    /// What another robot has told, and which; none if nothing waits.
    fn heard(&mut self) -> Option<(RobotIndex, TaskMessage)>;

    /// Who is there and who decides.
    fn team(&self) -> Teammates;

    /// What becomes awake when there is something new.
    fn wake(&self) -> Arc<Wake>;
}
