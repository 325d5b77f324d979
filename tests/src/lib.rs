//! Whole applications, run and judged from outside: the harness of the behaviour tests.
//!
//! Nothing here waits without a deadline, and nothing judges by how fast the machine is.
#![forbid(unsafe_code)]

mod application;
mod assembled;
mod build;
mod hosts;
mod member;
mod operator;
mod outcome;
mod python;
mod supervised;
mod terminal;
mod turn;
mod watchdog;

pub use application::Application;
pub use assembled::{assembled, environment};
pub use build::{artifacts, c_component};
pub use hosts::{Host, processes_that_mention, zombies};
pub use member::Member;
pub use operator::Operator;
pub use outcome::Outcome;
pub use python::{assert_html, python};
pub use supervised::Supervised;
pub use terminal::Terminal;
pub use turn::take_turn;
pub use watchdog::{Finished, Watched, repository, until};
