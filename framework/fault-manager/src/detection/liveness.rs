//! Whether work goes on: heartbeats, fresh data, cycles in time.

mod freshness;
mod heartbeat;
mod overruns;

pub use freshness::{Age, Freshness};
pub use heartbeat::{Heartbeat, MissedHeartbeats};
pub use overruns::{OverrunCount, Overruns};
