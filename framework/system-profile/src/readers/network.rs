//! `network`: how a robot enters the network, and which ports lead into it.

mod fetches;

use system_model::network::SILENCE_LIMIT;
use system_model::profile::{Located, NetworkProfile, RemoteConnection, TlsProfile};

use super::application::end;
use super::rules::measure::positive_duration;
use crate::node::Node;
use crate::suggest::quoted;
use crate::value::Value;

/// Longer names are no names; they travel with every beat.
const NAME_MAXIMUM: usize = 64;
/// A robot has some few addresses, and knows some few of others.
const ADDRESSES_MAXIMUM: usize = 64;
/// More robots than a team has.
const ALLOWED_MAXIMUM: usize = 256;

/// Reads the child `network`, if there is one.
pub(super) fn read(root: &Node<'_>) -> Option<NetworkProfile> {
    let node = root.child("network")?;
    let robot = node.required_attribute("name");
    let robot = robot.and_then(|value| name(&value, "robot"));
    let tls = node.child("tls");
    let transport = if tls.is_some() { "tls" } else { "tcp" };
    let listen = node.attribute("listen");
    let connect = node.attribute("connect");
    let leads_somewhere = listen.is_some() || connect.is_some();
    let [listen, connect] = [listen, connect].map(|value| {
        let value = value.as_ref();
        value.map_or_else(Vec::new, |value| addresses(value, transport))
    });
    let scouting = node.attribute("scouting");
    let scouting = scouting.is_some_and(|value| value.boolean().unwrap_or_default());
    let silence_limit = node.attribute("silence_limit");
    let silence_limit =
        silence_limit.map_or(Some(SILENCE_LIMIT), |value| positive_duration(&value));
    let packages = node.attribute("packages");
    let offers = node.children("offer").iter().map(end).collect();
    let connections = node.children("remote_connection");
    let connections: Vec<RemoteConnection> = connections.iter().filter_map(connection).collect();
    let fetches = fetches::read(&node, robot.as_ref());
    let tls = tls.map(|tls| (files(&tls), tls));
    let feeding = connections.iter().map(|it| (&it.robot, "feeds an input"));
    let sending = fetches.iter().map(|it| (&it.robot, "sends a component"));
    let speaking = feeding.chain(sending);
    let allowed = allowed(&node, tls.as_ref().map(|(_, node)| node), speaking);
    if !leads_somewhere && !scouting {
        node.error(
            "<network> leads nowhere",
            Some(format!(
                "write where others find this robot (listen=\"{transport}/0.0.0.0:7447\"), where \
                 it finds them (connect=\"{transport}/192.168.0.2:7447\"), or scouting=\"true\""
            )),
        );
    }
    node.finish();
    Some(NetworkProfile {
        robot: robot?,
        listen,
        connect,
        scouting,
        silence_limit: silence_limit?,
        tls: match tls {
            Some((files, _)) => Some(files?),
            None => None,
        },
        allowed,
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

/// `tls`: the files, which are looked for when ports are.
fn files(node: &Node<'_>) -> Option<TlsProfile> {
    let file = |name| {
        let value = node.required_attribute(name)?;
        Some(value.located())
    };
    let (certificate, private_key, authority) =
        (file("certificate"), file("private_key"), file("authority"));
    node.finish();
    Some(TlsProfile {
        certificate: certificate?,
        private_key: private_key?,
        authority: authority?,
    })
}

/// Who may speak. Names are worth nothing without certificates, and certificates nothing without
/// names.
fn allowed<'read>(
    node: &Node<'_>,
    tls: Option<&Node<'_>>,
    speaking: impl Iterator<Item = (&'read Located<String>, &'static str)>,
) -> Vec<Located<String>> {
    let elements = node.children("allow");
    if let (None, Some(element)) = (tls, elements.first()) {
        element.error(
            "<allow> keeps nobody out where connections are not secured",
            Some(
                "say how robots prove their names: <tls certificate=\"R1.crt\" \
                 private_key=\"R1.key\" authority=\"team.crt\"/>"
                    .into(),
            ),
        );
    }
    let robot = |element: &Node<'_>| {
        let robot = element.required_attribute("robot");
        element.finish();
        name(&robot?, "robot")
    };
    let allowed: Vec<Located<String>> = elements.iter().filter_map(robot).collect();
    let Some(tls) = tls else {
        return allowed;
    };
    if elements.is_empty() {
        tls.error(
            "no robot may speak to this one",
            Some("write <allow robot=\"R2\"/> for each that may".into()),
        );
        return allowed;
    }
    if elements.len() > ALLOWED_MAXIMUM {
        tls.error(
            format!("{} robots are too many", elements.len()),
            Some(format!("write at most {ALLOWED_MAXIMUM}")),
        );
    }
    let is_allowed = |robot: &str| allowed.iter().any(|it| it.value == robot);
    for (robot, what) in speaking {
        let robot = &robot.value;
        if !is_allowed(robot) {
            tls.error(
                format!("{} {what} and may not speak", quoted(robot)),
                Some(format!("write <allow robot=\"{robot}\"/>")),
            );
        }
    }
    allowed
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

/// Addresses with blanks between them, all of one transport.
fn addresses(value: &Value<'_>, transport: &str) -> Vec<String> {
    let addresses: Vec<&str> = value.as_str().split_whitespace().collect();
    let wrong = addresses
        .iter()
        .find(|address| !is_address(address, transport));
    if let Some(wrong) = wrong {
        let other = if transport == "tls" { "tcp" } else { "tls" };
        let (message, help) = match is_address(wrong, other) {
            true if transport == "tls" => (
                "is not encrypted, as all connections of a network with <tls> are",
                "",
            ),
            true => (
                "needs certificates",
                "write <tls certificate=\"R1.crt\" private_key=\"R1.key\" \
                 authority=\"team.crt\"/> into <network>, or ",
            ),
            false => ("is no address", ""),
        };
        value.error(
            format!("{} {message}", quoted(wrong)),
            Some(format!(
                "{help}write addresses like {transport}/192.168.0.2:7447, with blanks between them"
            )),
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

fn is_address(text: &str, transport: &str) -> bool {
    let rest = text.strip_prefix(transport);
    let rest = rest.and_then(|rest| rest.strip_prefix('/'));
    let Some((host, port)) = rest.and_then(|rest| rest.rsplit_once(':')) else {
        return false;
    };
    let is_host = |byte: u8| byte.is_ascii_alphanumeric() || b".-_[]:%".contains(&byte);
    !host.is_empty() && host.bytes().all(is_host) && port.parse::<u16>().is_ok()
}
