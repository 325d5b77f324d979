//! `tree`: behaviour trees that belong to an application.

use std::time::Duration;

use system_model::mission::{
    DEFAULT_TICK, DEFAULT_TICK_DEADLINE, DEFAULT_TREE_RETRIES, DeclaredTree, SHORTEST_TICK,
    TreeStart,
};
use system_model::profile::TreeReference;
use system_model::rules::{ComponentSeverity, MAX_RETRY_MAX};

use super::rules::COMPONENT_SEVERITIES;
use crate::node::Node;
use crate::value::Value;

/// All trees of an application, in document order.
pub(super) fn trees(root: &Node<'_>) -> Vec<TreeReference> {
    let trees = root.children("tree");
    trees.iter().filter_map(tree).collect()
}

fn tree(node: &Node<'_>) -> Option<TreeReference> {
    let name = node.required_attribute("name");
    let file = node.required_attribute("file");
    let main = node.attribute("main");
    let starts = node
        .attribute("starts")
        .map(|it| it.choice(&TreeStart::ALL));
    let tick = node.attribute("tick_ms").map(|it| milliseconds(&it));
    let deadline = node.attribute("tick_deadline_ms");
    let deadline = deadline.map(|it| milliseconds(&it));
    let severity = node.attribute("severity");
    let severity = severity.map(|it| it.choice(&COMPONENT_SEVERITIES));
    let retry_max = node.attribute("retry_max").map(|it| retries(&it));
    node.finish();
    let tick = tick.unwrap_or(Some(DEFAULT_TICK))?;
    let declared = DeclaredTree {
        name: name?.as_str().to_owned(),
        starts: starts.unwrap_or(Some(TreeStart::default()))?,
        tick,
        tick_deadline: deadline.unwrap_or(Some(DEFAULT_TICK_DEADLINE.min(tick)))?,
        severity: severity.unwrap_or(Some(ComponentSeverity::Emergency))?,
        retry_max: retry_max.unwrap_or(Some(DEFAULT_TREE_RETRIES))?,
        place: node.place(),
    };
    if declared.tick_deadline > tick {
        node.error(
            "a tick that may take longer than the time between two ticks",
            Some("write a tick_deadline_ms of at most tick_ms".into()),
        );
        return None;
    }
    Some(TreeReference {
        file: file?.located(),
        main: main.map(|it| it.located()),
        declared,
    })
}

/// A time in milliseconds that a tree can be ticked with.
fn milliseconds(value: &Value<'_>) -> Option<Duration> {
    const LONGEST: Duration = Duration::from_secs(60);
    let number: f64 = value.number()?;
    let time = Duration::try_from_secs_f64(number / 1e3).ok();
    let time = time.filter(|time| (SHORTEST_TICK..=LONGEST).contains(time));
    if time.is_none() {
        let message = format!("{} is not from 1 to 60000", value.owner());
        value.error(message, Some("write a number of milliseconds: 100".into()));
    }
    time
}

fn retries(value: &Value<'_>) -> Option<u32> {
    let number: u32 = value.number()?;
    if number > MAX_RETRY_MAX {
        let message = format!("a budget of {number} new beginnings");
        value.error(message, Some(format!("write at most {MAX_RETRY_MAX}")));
        return None;
    }
    Some(number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;

    fn read(attributes: &str) -> (Vec<TreeReference>, Vec<String>) {
        let text = format!("<package_profile><tree {attributes}/></package_profile>");
        let document = Document::from_bytes("a.xml", text.as_bytes());
        let root = document.root(&["package_profile"]).expect("a root");
        let found = trees(&root);
        let problems = document.problems().into_iter();
        (found, problems.map(|problem| problem.message).collect())
    }

    #[test]
    fn what_is_not_said_is_as_documented() {
        let (found, problems) = read("name='m' file='m.xml'");
        let declared = &found[0].declared;
        assert_eq!(problems, Vec::<String>::new());
        assert_eq!(declared.starts, TreeStart::WithApplication);
        assert_eq!(declared.tick, Duration::from_millis(100));
        assert_eq!(declared.tick_deadline, Duration::from_millis(20));
        assert_eq!(declared.severity, ComponentSeverity::Emergency);
        let (found, _) = read("name='m' file='m.xml' tick_ms='10' severity='reset' retry_max='2'");
        let declared = &found[0].declared;
        assert_eq!(declared.tick_deadline, Duration::from_millis(10));
        assert_eq!(declared.retry_max, 2);
    }

    #[test]
    fn mistakes_are_told_at_their_place() {
        for (attributes, message) in [
            ("file='m.xml'", "<tree> has no name"),
            ("name='m'", "<tree> has no file"),
            (
                "name='m' file='m.xml' starts='by_fualt'",
                "`by_fualt` in attribute starts of <tree> is not understood",
            ),
            (
                "name='m' file='m.xml' tick_ms='0'",
                "attribute tick_ms of <tree> is not from 1 to 60000",
            ),
            (
                "name='m' file='m.xml' tick_ms='5' tick_deadline_ms='6'",
                "a tick that may take longer than the time between two ticks",
            ),
            (
                "name='m' file='m.xml' severity='global'",
                "`global` in attribute severity of <tree> is not understood",
            ),
            (
                "name='m' file='m.xml' retry_max='101'",
                "a budget of 101 new beginnings",
            ),
        ] {
            let (found, problems) = read(attributes);
            assert_eq!(problems, [message], "{attributes}");
            assert!(found.is_empty(), "{attributes}");
        }
    }
}
