//! Names of a task's parts, each said once and then referred to.

use system_model::specification::Place;

use crate::node::Node;
use crate::suggest::{self, quoted};
use crate::value::Value;

/// Names of one kind, in the order of the file.
pub(super) struct Names {
    kind: &'static str,
    names: Vec<String>,
}

impl Names {
    /// `kind` is what they are called in messages.
    pub(super) fn of<'a>(kind: &'static str, names: impl IntoIterator<Item = &'a String>) -> Self {
        Self {
            kind,
            names: names.into_iter().cloned().collect(),
        }
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.names.len()
    }

    /// What a mandatory attribute refers to.
    pub(super) fn required(&self, node: &Node<'_>, attribute: &'static str) -> Option<usize> {
        self.find(&node.required_attribute(attribute)?)
    }

    /// What a text refers to; an error if that is nothing.
    pub(super) fn find(&self, value: &Value<'_>) -> Option<usize> {
        let found = self.names.iter().position(|name| name == value.as_str());
        if found.is_none() {
            let names = self.names.iter().map(String::as_str);
            value.error(
                format!(
                    "the task has no {} called `{}`",
                    self.kind,
                    quoted(value.as_str())
                ),
                suggest::help(value.as_str(), "it has", names)
                    .or_else(|| Some(format!("declare it as <{}>", self.kind))),
            );
        }
        found
    }
}

/// The mandatory attribute `name` of something that is declared once. Blanks would part it from itself
/// where reports write several names in a line, a colon parts robot and component.
pub(super) fn declared(node: &Node<'_>, known: &mut Vec<(String, Place)>) -> Option<String> {
    let value = node.required_attribute("name")?;
    let name = value.as_str();
    if name.contains(|letter: char| letter.is_whitespace() || letter == ':') {
        value.error(
            format!("`{}` is no name in a task", quoted(name)),
            Some("write it without blanks and colons".into()),
        );
        return None;
    }
    if let Some((_, first)) = known.iter().find(|(other, _)| other == name) {
        value.error(
            format!("`{}` stands here again", quoted(name)),
            Some(format!(
                "the first one is at {first}; remove or rename one of them"
            )),
        );
        return None;
    }
    known.push((name.to_owned(), value.place()));
    Some(name.to_owned())
}

/// Reports a list that is longer than can be dealt with; none of what is too much is read.
pub(super) fn bounded<'a>(mut nodes: Vec<Node<'a>>, limit: usize) -> Vec<Node<'a>> {
    if nodes.len() > limit {
        let first = nodes.swap_remove(limit);
        first.error(
            format!("more than {limit} <{}>", first.name()),
            Some(format!("remove all but {limit}")),
        );
        nodes.truncate(limit);
    }
    nodes
}
