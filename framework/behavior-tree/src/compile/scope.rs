//! Which key of which tree is which slot.

use std::collections::BTreeMap;

use crate::plan::Entry;
use crate::value::Value;

/// One tree's blackboard, by number; the outermost is 0.
pub(super) type ScopeId = usize;

#[derive(Debug, Default)]
pub(super) struct Scopes {
    scopes: Vec<Scope>,
    pub(super) entries: Vec<Entry>,
}

#[derive(Debug, Default)]
struct Scope {
    parent: Option<ScopeId>,
    /// Keys that are keys of the parent.
    remapped: BTreeMap<String, String>,
    slots: BTreeMap<String, usize>,
    remaps_all: bool,
}

impl Scopes {
    /// The blackboard of a tree; `remaps_all` makes each key that is not remapped that of the parent,
    /// save those that begin with `_`.
    pub(super) fn open(&mut self, parent: Option<ScopeId>, remaps_all: bool) -> ScopeId {
        self.scopes.push(Scope {
            parent,
            remaps_all,
            ..Scope::default()
        });
        self.scopes.len() - 1
    }

    /// Makes a key of a scope a key of its parent.
    pub(super) fn remap(&mut self, scope: ScopeId, key: &str, parents_key: &str) {
        let remapped = &mut self.scopes[scope].remapped;
        remapped.insert(key.to_owned(), parents_key.to_owned());
        if let Some(parent) = self.scopes[scope].parent {
            self.mention(parent, parents_key);
        }
    }

    /// Gives a key of a scope its first value.
    pub(super) fn preset(&mut self, scope: ScopeId, key: &str, value: Value) {
        let slot = self.new_slot(scope, key);
        self.entries[slot].initial = Some(value);
        self.entries[slot].is_declared = true;
    }

    /// The slot of a key that a file mentions outside scripts.
    pub(super) fn mention(&mut self, scope: ScopeId, key: &str) -> usize {
        let slot = self.slot(scope, key);
        self.entries[slot].is_declared = true;
        slot
    }

    /// The slot of a key; `@key` is that of the outermost blackboard.
    pub(super) fn slot(&mut self, scope: ScopeId, key: &str) -> usize {
        // By turns: the chain of parents is as long as the nesting of trees.
        let (mut scope, mut key) = match key.strip_prefix('@') {
            Some(key) => (0, key.to_owned()),
            None => (scope, key.to_owned()),
        };
        loop {
            let here = &self.scopes[scope];
            if let Some(slot) = here.slots.get(&key) {
                return *slot;
            }
            match (here.parent, here.remapped.get(&key)) {
                (Some(parent), Some(parents_key)) => {
                    let parents_key = parents_key.clone();
                    (scope, key) = match parents_key.strip_prefix('@') {
                        Some(key) => (0, key.to_owned()),
                        None => (parent, parents_key),
                    };
                }
                (Some(parent), None) if here.remaps_all && !key.starts_with('_') => scope = parent,
                _ => return self.new_slot(scope, &key),
            }
        }
    }

    /// The keys of the outermost blackboard.
    pub(super) fn root_slots(&self) -> BTreeMap<String, usize> {
        let root = self.scopes.first();
        root.map(|scope| scope.slots.clone()).unwrap_or_default()
    }

    fn new_slot(&mut self, scope: ScopeId, key: &str) -> usize {
        let slot = self.entries.len();
        self.entries.push(Entry {
            name: key.to_owned(),
            initial: None,
            is_declared: false,
        });
        self.scopes[scope].slots.insert(key.to_owned(), slot);
        slot
    }
}

/// The key that a value of a file refers to: `{key}`, `{=}` for the port's own name, and, in old
/// files, `${key}`.
pub(super) fn key_of<'a>(port: &'a str, value: &'a str) -> Option<&'a str> {
    let value = value.trim();
    let value = value.strip_prefix('$').unwrap_or(value);
    let key = value.strip_prefix('{')?.strip_suffix('}')?.trim();
    // A structure in JSON begins with a brace, too.
    let is_key = !key.is_empty() && !key.contains(|sign: char| "\"{}:,".contains(sign));
    is_key.then_some(if key == "=" { port } else { key })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_told_from_literals() {
        for (value, key) in [
            ("{goal}", Some("goal")),
            (" { goal } ", Some("goal")),
            ("{=}", Some("port")),
            ("{@goal}", Some("@goal")),
            ("${goal}", Some("goal")),
            ("goal", None),
            ("{}", None),
            ("{\"x\": 1}", None),
            ("json:{\"x\": 1}", None),
        ] {
            assert_eq!(key_of("port", value), key, "{value}");
        }
    }

    #[test]
    fn a_key_is_followed_to_the_tree_that_owns_it() {
        let mut scopes = Scopes::default();
        let root = scopes.open(None, false);
        let middle = scopes.open(Some(root), false);
        scopes.remap(middle, "inner", "outer");
        let leaf = scopes.open(Some(middle), true);
        assert_eq!(scopes.slot(leaf, "inner"), scopes.slot(root, "outer"));
        assert_eq!(scopes.slot(leaf, "own"), scopes.slot(middle, "own"));
        assert_ne!(scopes.slot(leaf, "own"), scopes.slot(root, "own"));
        assert_ne!(scopes.slot(leaf, "_secret"), scopes.slot(middle, "_secret"));
        assert_eq!(scopes.slot(leaf, "@top"), scopes.slot(root, "top"));
        scopes.remap(middle, "far", "@top");
        assert_eq!(scopes.slot(middle, "far"), scopes.slot(root, "top"));
    }

    #[test]
    fn what_only_a_script_names_is_not_declared() {
        let mut scopes = Scopes::default();
        let root = scopes.open(None, false);
        let (named, mentioned) = (scopes.slot(root, "a"), scopes.mention(root, "b"));
        assert!(!scopes.entries[named].is_declared);
        assert!(scopes.entries[mentioned].is_declared);
        let inner = scopes.open(Some(root), false);
        scopes.preset(inner, "c", Value::Boolean(true));
        let preset = scopes.slot(inner, "c");
        assert_eq!(scopes.entries[preset].initial, Some(Value::Boolean(true)));
    }
}
