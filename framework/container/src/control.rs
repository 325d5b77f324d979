//! Talking to a running system: a Unix socket of its owner's, over which it is looked at, components
//! are reset, replaced and stopped, and faults are listed, shown, cleared and injected.
//!
//! Requests and answers are one JSON object a line ([`protocol`]). The server does no more than
//! carry them; what they mean is up to the [`Control`] that it is given. Whatever a client sends,
//! or fails to send or to read, changes nothing but its own connection.

pub mod client;
mod folder;
mod observing;
mod ordering;
pub mod protocol;
mod running;
mod server;
pub mod view;

pub use folder::{ControlError, RunningApplication, remove_sockets_of_the_dead, running};
pub use protocol::{Answer, Request};
pub use running::RunningSystem;
pub use server::{Limits, Server};

/// A running system as an operator sees it.
pub trait Control: Send + Sync + 'static {
    /// Answers a request, at once: while it does, no other client is served.
    fn handle(&self, request: Request) -> Answer;
}
