//! Components in a process of their own: the isolation tier `process`.
//!
//! The container starts hosts: processes of the same executable that run component instances behind
//! the same guard. Executors, ports, taps, checkpoints and the life cycle stay in the container; a
//! callback is a message to the host and back, over memory that only the two of them share. Data
//! that the component is expected to read goes along with the call, data that it writes comes back
//! with its end, so that a component which dies in the middle has written nothing; everything else
//! that a component asks for is asked of the container while it waits.
//!
//! Survives whatever a component does to its own process: corrupted memory, `SIGKILL`, `SIGSTOP`,
//! running out of memory. The container trusts nothing that stands in the shared memory.

mod answer;
mod bare_death;
mod channel;
mod critical;
mod deadline;
mod ending;
mod filter;
mod group;
mod input;
mod instance;
mod layout;
mod limits;
mod message;
mod patience;
mod process;
mod remains;
mod remote;
mod robust;
mod scheduling;
mod serve;
mod setup;
mod socket;

pub use bare_death::BareDeath;
pub use group::Hosts;
pub use instance::{Hosted, HostedComponent};
pub use remains::RemoteScene;
pub use serve::host_main;

/// The hidden command of the executable that a host runs.
const HOST_COMMAND: &str = "host";
