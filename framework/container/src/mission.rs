//! Behaviour trees of applications: ticked over the components that run.
//!
//! To the fault manager a tree is a component behind all others: it fails, is begun anew and stopped
//! like one. A tick never waits for a component. What a leaf wants done is an order, as an operator
//! would give it, or a message; how it goes is looked at in the ticks that follow.

mod binding;
mod calls;
mod leaves;
mod reach;
mod record;
mod runner;
mod status;
mod thread;

pub use binding::{Ground, Outlets, bind};
pub use calls::{Caller, Calls};
pub use reach::Reach;
pub use runner::{Runner, Setting};
pub use status::{Phase, TreeStatus};
pub use thread::MissionThreads;
