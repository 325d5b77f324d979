//! Around the fault manager: what is observed reaches it, what it decides is done.

mod emergency;
mod models;
mod monitors;
pub(crate) mod obedience;
mod observations;
mod operator;
mod orders;
mod recovery;
mod scenes;
mod standby;
mod supervisor;
mod threads;

pub use emergency::{Actuator, CONTROLLED_STOP, Emergency, SafetyGate};
pub use models::{Channel, ModelMonitor, Reading, Sampler};
pub use monitors::{InputAge, LOOK_PERIOD, MemoryUse, Monitors, OverrunCount, Subject, WorkDone};
pub use observations::Observations;
pub use orders::{Order, Orders, Task};
pub use scenes::Scenes;
pub use standby::Standbys;
pub use supervisor::Supervisor;
pub(crate) use supervisor::nanoseconds;
pub use threads::ManagerThreads;
