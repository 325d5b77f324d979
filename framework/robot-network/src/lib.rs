//! Robots among robots.
//!
//! Pure, and told the time: [`Membership`] knows who is alive, [`Leadership`] who decides,
//! [`Fence`] whose data an actuator obeys, [`message`], [`task`] and [`frame`] what is said, [`package`] what
//! a robot takes from another one and runs. Around that [`Node`] is a thin shell over zenoh, which
//! finds the others and carries everything; nothing else here knows of it.

#![forbid(unsafe_code)]

mod credentials;
mod fence;
pub mod frame;
mod leadership;
mod membership;
pub mod message;
mod node;
pub mod package;
pub mod task;

pub use credentials::{BadCredentials, Credentials};
pub use fence::{Claim, Fence, Refused};
pub use leadership::{Leadership, Role};
pub use membership::{Change, Death, Membership};
pub use node::{Answers, Heard, Inlet, Node, NodeError, OpenOptions, Outlet, Visitor};
