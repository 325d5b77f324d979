//! Replaying a recording: its port data go through the same ports, by the same rules, in simulated
//! time, so that a rule can be tuned on yesterday's fault.
//!
//! Every component that is not replayed itself is played: an instance without a library behind it,
//! whose outputs are what the recording has, at the recorded times, and which reads its inputs then.
//! All that stands between the ports (checks, freshness, process models, voters, safe values) and
//! the fault manager with its plans are those of any run. What a recording does not hold cannot be
//! judged: exceptions, hangs, heartbeats, overruns and memory of components that are played.

mod player;
mod routes;
mod score;
mod state;

pub use player::Player;
pub use score::Score;
pub use state::RecordedVerdict;
