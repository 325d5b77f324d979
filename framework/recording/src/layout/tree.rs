//! The tree that the paths of flat fields stand for: `pose.x`, `echoes[2].distance`.

use system_model::data_type::DataType;

/// A value of the JSON.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    /// A field, by its index.
    Field(usize),
    /// A structure.
    Object(Vec<(String, Node)>),
    /// Structures one after the other.
    List(Vec<Node>),
}

/// One step on the way to a field.
#[derive(Debug, Clone, PartialEq)]
enum Key {
    Name(String),
    Index(usize),
}

/// The tree of a type, and the JSON pointer of each field.
pub(super) fn of(data_type: &DataType) -> (Node, Vec<String>) {
    let mut root = Node::Object(Vec::new());
    let mut pointers = Vec::new();
    for (index, field) in data_type.fields.iter().enumerate() {
        let mut keys = keys(&field.path);
        if !insert(&mut root, &keys, index) {
            // Something else has its place already; no derived descriptor is so.
            keys = vec![Key::Name(field.path.clone())];
            if !insert(&mut root, &keys, index) {
                keys = vec![Key::Name(format!("{} ({index})", field.path))];
                insert(&mut root, &keys, index);
            }
        }
        pointers.push(pointer(&keys));
    }
    (root, pointers)
}

/// The steps of a path.
fn keys(path: &str) -> Vec<Key> {
    let mut keys = Vec::new();
    for part in path.split('.') {
        let element = part.strip_suffix(']').and_then(|it| it.rsplit_once('['));
        match element.and_then(|(name, index)| Some((name, index.parse().ok()?))) {
            Some((name, index)) => {
                keys.push(Key::Name(name.to_owned()));
                keys.push(Key::Index(index));
            }
            None => keys.push(Key::Name(part.to_owned())),
        }
    }
    keys
}

/// Puts a field at the end of the way; whether there is room for it. Nothing is changed if not.
fn insert(node: &mut Node, keys: &[Key], field: usize) -> bool {
    let Some((first, rest)) = keys.split_first() else {
        return false;
    };
    let known = match (&mut *node, first) {
        (Node::Object(members), Key::Name(name)) => {
            let mut members = members.iter_mut();
            members.find_map(|(other, member)| (other == name).then_some(member))
        }
        (Node::List(elements), Key::Index(index)) if *index <= elements.len() => {
            elements.get_mut(*index)
        }
        _ => return false,
    };
    if let Some(known) = known {
        return insert(known, rest, field);
    }
    let mut fresh = match rest.first() {
        None => Node::Field(field),
        Some(Key::Name(_)) => Node::Object(Vec::new()),
        Some(Key::Index(_)) => Node::List(Vec::new()),
    };
    if !rest.is_empty() && !insert(&mut fresh, rest, field) {
        return false;
    }
    match (node, first) {
        (Node::Object(members), Key::Name(name)) => members.push((name.clone(), fresh)),
        (Node::List(elements), Key::Index(_)) => elements.push(fresh),
        _ => return false,
    }
    true
}

/// A JSON pointer (RFC 6901).
fn pointer(keys: &[Key]) -> String {
    let part = |key: &Key| match key {
        Key::Name(name) => format!("/{}", name.replace('~', "~0").replace('/', "~1")),
        Key::Index(index) => format!("/{index}"),
    };
    keys.iter().map(part).collect()
}
