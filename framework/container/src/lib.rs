//! The Steadfast container: loads shared-library components, connects their ports and runs them,
//! each behind a guard, so that one component's crash is that component's alone.
//!
//! `framework/ARCHITECTURE.md` has the map. Data goes one way: a specification is assembled into
//! a running system; what happens in it becomes events.

pub mod adaptation;
pub mod assembly;
pub mod backtrace;
pub mod bare_wake;
pub mod clock;
pub mod component;
pub mod control;
pub mod descriptor_line;
pub mod device;
pub mod event_log;
pub mod executor;
pub mod guard;
pub mod host;
pub mod injection;
pub mod lane;
pub mod library;
pub mod metrics;
pub mod mission;
pub mod network;
pub mod outer_supervision;
pub mod persistence;
pub mod port;
pub mod recording;
pub mod replay;
pub mod schedule;
mod scheduling;
pub mod status;
pub mod summary;
pub mod supervision;
pub mod system;
pub mod wake;
mod watchdog;
pub mod world;
