//! Which connection an end is of, for whoever changes connections while they are in use.

use std::sync::Arc;

use super::{Newest, Receiver, Sender, Shared};

/// Tells connections apart.
#[derive(Debug, Clone)]
pub struct ConnectionId(Arc<Shared>);

impl PartialEq for ConnectionId {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Sender {
    /// Where the time of the newest datum is left, if somebody wants to know its age.
    pub fn watched(&self) -> Option<Arc<Newest>> {
        self.newest.clone()
    }

    /// The time of the newest datum is left there from now on: who wants to know the age of an
    /// input's data does not notice that they come by another connection.
    pub fn watch_by(&mut self, newest: Arc<Newest>) {
        self.newest = Some(newest);
    }

    /// Which connection it is the end of.
    pub fn id(&self) -> ConnectionId {
        ConnectionId(Arc::clone(&self.shared))
    }
}

impl Receiver {
    /// Which connection it is the end of.
    pub fn id(&self) -> ConnectionId {
        ConnectionId(Arc::clone(&self.shared))
    }
}
