//! Names in the network. Names of robots, components and ports are checked where they are read: they
//! hold nothing that has a meaning in a key.

/// Of the token of one of a robot's lives.
pub(super) fn alive(robot: &str, incarnation: u64) -> String {
    format!("steadfast/alive/{robot}/{incarnation}")
}

/// Of a robot's beats.
pub(super) fn beat(robot: &str) -> String {
    format!("steadfast/beat/{robot}")
}

/// Of a robot's faults.
pub(super) fn fault(robot: &str) -> String {
    format!("steadfast/fault/{robot}")
}

/// Of an output.
pub(super) fn port(robot: &str, component: &str, port: &str) -> String {
    format!("steadfast/port/{robot}/{component}/{port}")
}

/// Of something that a robot is asked for; `*` for all robots.
pub(super) fn question(kind: &str, robot: &str) -> String {
    format!("steadfast/{kind}/{robot}")
}

/// Of what one robot tells another about tasks.
pub(super) fn task(from: &str, to: &str) -> String {
    format!("steadfast/task/{from}/{to}")
}

/// Of data that go from one robot to another on a link of a task.
pub(super) fn flow(from: &str, to: &str, name: &str) -> String {
    format!("steadfast/flow/{from}/{to}/{name}")
}

/// By whom data come, and on which link.
pub(super) fn flow_of(key: &str) -> Option<(&str, &str)> {
    let mut parts = key.splitn(5, '/').skip(2);
    let (from, _to, name) = (parts.next()?, parts.next()?, parts.next()?);
    Some((from, name))
}

/// Whose key this is.
pub(super) fn robot(key: &str) -> Option<&str> {
    key.split('/').nth(2)
}

/// Whose token this is, and of which life.
pub(super) fn life(key: &str) -> Option<(&str, u64)> {
    let mut parts = key.split('/').skip(2);
    Some((parts.next()?, parts.next()?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_into_a_key_is_read_from_it() {
        assert_eq!(life(&alive("R1", 7)), Some(("R1", 7)));
        assert_eq!(flow_of(&flow("R1", "R2", "a/0/1")), Some(("R1", "a/0/1")));
        assert_eq!(flow_of("steadfast/flow/R1/R2"), None);
        let task = task("R1", "R2");
        for key in [beat("R1"), fault("R1"), port("R1", "camera", "image"), task] {
            assert_eq!(robot(&key), Some("R1"), "{key}");
        }
        for key in [
            "",
            "steadfast",
            "steadfast/alive/R1",
            "steadfast/alive/R1/x",
        ] {
            assert_eq!(life(key), None, "{key}");
        }
    }
}
