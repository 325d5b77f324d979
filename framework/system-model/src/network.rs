//! A robot among robots: how it enters the network, what it offers there, what it takes from there.

use std::path::PathBuf;
use std::time::Duration;

use crate::specification::PortReference;

/// Who is silent for so long is dead, unless a file says otherwise: five cameras' pictures, and five
/// beats.
pub const SILENCE_LIMIT: Duration = Duration::from_millis(500);

/// How long a start waits for a component that another robot sends, unless a file says otherwise: a
/// robot that was switched on at the same time has come up, and a large library has come over a slow
/// radio link.
pub const FETCH_LIMIT: Duration = Duration::from_secs(10);

/// A robot's place in the network, from `<network>`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NetworkSpecification {
    /// Name of the robot; of all that are alive the one with the first name decides.
    pub robot: String,
    /// Addresses that it listens at, like `tcp/192.168.0.2:7447`.
    pub listen: Vec<String>,
    /// Addresses of other robots.
    pub connect: Vec<String>,
    /// Whether other robots are looked for by multicast.
    pub scouting: bool,
    /// Who is silent for so long is dead.
    pub silence_limit: Duration,
    /// Folder with sealed packages of components that other robots may fetch.
    pub packages: Option<PathBuf>,
    /// Outputs that other robots may listen to.
    pub offers: Vec<PortReference>,
    /// Inputs that other robots feed.
    pub remote_inputs: Vec<RemoteInput>,
}

/// An input that another robot feeds. Several may feed one; then one of them is obeyed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RemoteInput {
    /// The other robot.
    pub robot: String,
    /// Its component.
    pub component: String,
    /// The output of that.
    pub port: String,
    /// The input.
    pub target: PortReference,
}
