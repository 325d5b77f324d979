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
    /// How its connections are secured; in the clear, and open to all, if they are not.
    pub security: Option<NetworkSecurity>,
    /// Folder with sealed packages of components that other robots may fetch.
    pub packages: Option<PathBuf>,
    /// Outputs that other robots may listen to.
    pub offers: Vec<PortReference>,
    /// Inputs that other robots feed.
    pub remote_inputs: Vec<RemoteInput>,
}

/// How the connections of a robot are secured: by TLS, both sides showing certificates that one
/// authority has signed. The common name of a robot's certificate is the robot's name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NetworkSecurity {
    /// File with the robot's certificate, and those between it and the authority's, as PEM.
    pub certificate: PathBuf,
    /// File with the certificate's private key, as PEM.
    pub private_key: PathBuf,
    /// File with the authority's certificate, as PEM.
    pub authority: PathBuf,
    /// The robots that are listened to and told anything, each under its own name only.
    pub allowed: Vec<String>,
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
