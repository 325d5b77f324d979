//! Around the fault manager: what is observed reaches it, what it decides is done.

mod effects;
mod emergency;
mod manager_ports;
mod missions;
mod models;
mod monitors;
pub(crate) mod obedience;
mod observations;
mod operator;
mod orders;
mod recovery;
mod refill;
mod rehearsal;
mod scenes;
mod standby;
mod supervisor;
mod threads;
mod time;

pub use emergency::{Actuator, CONTROLLED_STOP, Emergency, SafetyGate};
pub use manager_ports::ManagerOutputs;
pub use models::{Channel, ModelMonitor, Reading, Reference, Sampler};
pub use monitors::{InputAge, LOOK_PERIOD, MemoryUse, Monitors, OverrunCount, Subject, WorkDone};
pub use observations::Observations;
pub use operator::Overview;
pub use orders::{Order, Orders, Task};
pub use rehearsal::rehearse;
pub use scenes::Scenes;
pub use standby::Standbys;
pub use supervisor::Supervisor;
pub use threads::ManagerThreads;
