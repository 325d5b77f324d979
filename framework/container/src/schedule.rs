//! When executors run: on threads of their own by the machine's clock, or one after the other in
//! simulated time.

mod real_time;
mod simulated;

pub use real_time::RealTime;
pub use simulated::{BusyTime, Simulated};
