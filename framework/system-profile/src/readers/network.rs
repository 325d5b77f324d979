//! `network`: how a robot enters the network, and which ports lead into it.

mod fetches;

use system_model::network::SILENCE_LIMIT;
use system_model::profile::{Located, NetworkProfile, RemoteConnection};

use super::application::end;
use super::rules::measure::positive_duration;
use crate::node::Node;
use crate::suggest::quoted;
use crate::value::Value;

/// Longer names are no names; they travel with every beat.
const NAME_MAXIMUM: usize = 64;
/// A robot has some few addresses, and knows some few of others.
const ADDRESSES_MAXIMUM: usize = 64;

/// Reads the child `network`, if there is one.
pub(super) fn read(root: &Node<'_>) -> Option<NetworkProfile> {
    let node = root.child("network")?;
    let robot = node.required_attribute("name");
    let robot = robot.and_then(|value| name(&value, "robot"));
    let listen = addresses(&node, "listen");
    let connect = addresses(&node, "connect");
    let scouting = node.attribute("scouting");
    let scouting = scouting.is_some_and(|value| value.boolean().unwrap_or_default());
    let silence_limit = node.attribute("silence_limit");
    let silence_limit =
        silence_limit.map_or(Some(SILENCE_LIMIT), |value| positive_duration(&value));
    let packages = node.attribute("packages");
    let offers = node.children("offer").iter().map(end).collect();
    let connections = node.children("remote_connection");
    let connections = connections.iter().filter_map(connection).collect();
    let fetches = fetches::read(&node, robot.as_ref());
    if listen.is_empty() && connect.is_empty() && !scouting {
        node.error(
            "<network> leads nowhere",
            Some(
                "write where others find this robot (listen=\"tcp/0.0.0.0:7447\"), where it finds \
                 them (connect=\"tcp/192.168.0.2:7447\"), or scouting=\"true\""
                    .into(),
            ),
        );
    }
    node.finish();
    Some(NetworkProfile {
        robot: robot?,
        listen,
        connect,
        scouting,
        silence_limit: silence_limit?,
        packages: packages.map(|value| value.as_str().to_owned()),
        offers,
        connections,
        fetches,
    })
}

fn connection(node: &Node<'_>) -> Option<RemoteConnection> {
    let (source, target) = (node.required_child("source"), node.required_child("target"));
    node.finish();
    let (source, target) = (source?, target?);
    let robot = source
        .required_attribute("robot")
        .and_then(|value| name(&value, "robot"));
    let (source, target) = (end(&source), end(&target));
    for part in [&source.component, &source.port] {
        let has_a_meaning = |sign: char| "*$?#".contains(sign);
        if part.value.contains(has_a_meaning) {
            node.error(
                format!(
                    "{} holds a sign that has a meaning in the network",
                    quoted(&part.value)
                ),
                Some("names in the network go without `*`, `$`, `?` and `#`".into()),
            );
        }
    }
    Some(RemoteConnection {
        robot: robot?,
        source,
        target,
    })
}

/// Names of robots and of packages go into keys of the network.
fn name(value: &Value<'_>, whose: &str) -> Option<Located<String>> {
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-');
    let text = value.as_str();
    if !text.is_empty() && text.len() <= NAME_MAXIMUM && text.bytes().all(is_letter) {
        return Some(value.located());
    }
    value.error(
        format!("{} is no name of a {whose}", quoted(text)),
        Some("write up to 64 letters, digits, `_` and `-`".into()),
    );
    None
}

/// Addresses with blanks between them; of the transport that is built in.
fn addresses(node: &Node<'_>, attribute: &'static str) -> Vec<String> {
    let Some(value) = node.attribute(attribute) else {
        return Vec::new();
    };
    let addresses: Vec<&str> = value.as_str().split_whitespace().collect();
    let wrong = addresses.iter().find(|address| !is_address(address));
    if let Some(wrong) = wrong {
        value.error(
            format!("{} is no address", quoted(wrong)),
            Some("write addresses like tcp/192.168.0.2:7447, with blanks between them".into()),
        );
        return Vec::new();
    }
    if addresses.len() > ADDRESSES_MAXIMUM {
        value.error(
            format!("{} addresses are too many", addresses.len()),
            Some(format!("write at most {ADDRESSES_MAXIMUM}")),
        );
    }
    addresses.into_iter().map(str::to_owned).collect()
}

fn is_address(text: &str) -> bool {
    let Some((host, port)) = text
        .strip_prefix("tcp/")
        .and_then(|rest| rest.rsplit_once(':'))
    else {
        return false;
    };
    let is_host = |byte: u8| byte.is_ascii_alphanumeric() || b".-_[]:%".contains(&byte);
    !host.is_empty() && host.bytes().all(is_host) && port.parse::<u16>().is_ok()
}
