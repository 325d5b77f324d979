//! What zenoh is to do and what not.

use std::time::Duration;

use serde_json::{Value, json};
use system_model::network::NetworkSecurity;
use zenoh::Config;

use super::{NodeError, access};
use crate::credentials::Credentials;

/// How a robot enters the network.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenOptions {
    /// Its name.
    pub robot: String,
    /// Which of its lives this is: later ones have higher numbers.
    pub incarnation: u64,
    /// Addresses to listen at, like `tcp/192.168.0.2:7447`.
    pub listen: Vec<String>,
    /// Addresses of others. Who is not there is tried again until he is.
    pub connect: Vec<String>,
    /// Whether others are looked for by multicast.
    pub scouting: bool,
    /// Who is silent for so long is dead.
    pub silence_limit: Duration,
    /// How connections are secured; in the clear, and open to all, if they are not.
    pub security: Option<NetworkSecurity>,
}

/// First and longest pause between two tries to reach a robot that is not there: one that was
/// started again is found within a second, and one that never comes costs a packet a second.
const RETRY_MS: (u64, u64) = (100, 1000);

/// Longest time for all that is said before a connection stands: it begins anew behind TCP's own
/// first repetition of a lost packet, after a second, and not after zenoh's ten seconds. So a
/// partition that swallows packets is over soon after it has healed.
const OPENING_MS: u64 = 2500;

/// Peers, no routers. zenoh's own limit of silence ends connections to machines that hang; ours,
/// which is not longer, tells that they do.
pub(super) fn of(options: &OpenOptions) -> Result<Config, NodeError> {
    let mut config = Config::default();
    let lease_ms = u64::try_from(options.silence_limit.as_millis()).unwrap_or(u64::MAX);
    for (key, value) in [
        ("mode", json!("peer")),
        ("listen/endpoints", json!(options.listen)),
        ("connect/endpoints", json!(options.connect)),
        // For ever, in the background.
        ("connect/timeout_ms", json!(-1)),
        ("connect/exit_on_failure", json!(false)),
        (
            "connect/retry",
            json!({
                "period_init_ms": RETRY_MS.0,
                "period_max_ms": RETRY_MS.1,
                "period_increase_factor": 2.0,
            }),
        ),
        ("scouting/multicast/enabled", json!(options.scouting)),
        // What peers tell of other peers is scouting, too.
        ("scouting/gossip/enabled", json!(options.scouting)),
        ("transport/link/tx/lease", json!(lease_ms)),
        ("transport/unicast/open_timeout", json!(OPENING_MS)),
        ("transport/unicast/accept_timeout", json!(OPENING_MS)),
    ] {
        insert(&mut config, key, &value)?;
    }
    match &options.security {
        None => insert(&mut config, "transport/link/protocols", &json!(["tcp"]))?,
        Some(security) => secure(&mut config, &options.robot, security)?,
    }
    Ok(config)
}

/// TLS alone, with certificates on both sides; and what may be said by whom. Who listens at an
/// address is known by the name in his certificate, and not by the address, so that robots may move.
fn secure(config: &mut Config, robot: &str, security: &NetworkSecurity) -> Result<(), NodeError> {
    let credentials = Credentials::read(security).map_err(NodeError::Credentials)?;
    credentials.are_of(robot).map_err(NodeError::Credentials)?;
    let [certificate, private_key, authority] = credentials
        .files()
        .map(|content| base64_simd::STANDARD.encode_to_string(content));
    let tls = json!({
        "enable_mtls": true,
        "verify_name_on_connect": false,
        "root_ca_certificate_base64": authority,
        "listen_certificate_base64": certificate,
        "listen_private_key_base64": private_key,
        "connect_certificate_base64": certificate,
        "connect_private_key_base64": private_key,
    });
    insert(config, "transport/link/protocols", &json!(["tls"]))?;
    insert(config, "transport/link/tls", &tls)?;
    let access = access::control(robot, &security.allowed);
    insert(config, "access_control", &access)
}

/// The value may be secret: the error does not say it.
fn insert(config: &mut Config, key: &str, value: &Value) -> Result<(), NodeError> {
    let inserted = config.insert_json5(key, &value.to_string());
    inserted.map_err(|error| NodeError::Open {
        reason: format!("{key}: {error}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zenoh_understands_it_and_refuses_what_is_no_address() {
        let mut options = OpenOptions {
            robot: "R1".to_owned(),
            incarnation: 1,
            listen: vec!["tcp/127.0.0.1:7447".to_owned()],
            connect: vec!["tcp/127.0.0.1:7448".to_owned()],
            scouting: false,
            silence_limit: Duration::from_millis(500),
            security: None,
        };
        let config = of(&options).expect("a configuration");
        let value = |key: &str| config.get_json(key).expect("a value");
        assert_eq!(value("scouting/multicast/enabled"), "false");
        assert_eq!(value("transport/link/tx/lease"), "500");
        options.connect = vec!["nonsense".to_owned()];
        let error = of(&options).map(drop).expect_err("no address").to_string();
        assert!(error.contains("nonsense"), "{error}");
    }
}
