//! Trees in one line, with leaves that answer what their names say.
//!
//! `(Sequence (Inverter S) RF _)`: a leaf of the letters S, F, R, K answers SUCCESS, FAILURE, RUNNING,
//! SKIPPED in its first, second, ... tick, and goes on with the last. Attributes stand behind the
//! kind: `(Repeat num_cycles=3 S)`, and in angle brackets behind a leaf: `(Sequence S<_skipIf="a">)`.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use behavior_tree::definition::{Format, NodeAttribute, NodeDefinition, TreeDefinition, TreeFile};
use behavior_tree::{
    CompileOptions, Leaf, LeafContext, Library, NodeId, Plan, Status, TickError, Tree,
};
use system_model::profile::Located;
use system_model::specification::Place;

/// A tree with a record of what its leaves were asked.
pub struct Trial {
    pub tree: Tree,
    records: Vec<Arc<Record>>,
    now: Duration,
}

/// How often a leaf was ticked and halted.
#[derive(Default)]
struct Record {
    ticks: AtomicU32,
    halts: AtomicU32,
}

struct Scripted {
    answers: Vec<Status>,
    record: Arc<Record>,
}

impl Leaf for Scripted {
    fn tick(&mut self, _context: &mut LeafContext<'_>) -> Result<Status, String> {
        let tick = self.record.ticks.fetch_add(1, Ordering::Relaxed) as usize;
        let last = self.answers.len() - 1;
        match self.answers[tick.min(last)] {
            Status::Idle => Err("the leaf is broken".to_owned()),
            status => Ok(status),
        }
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {
        self.record.halts.fetch_add(1, Ordering::Relaxed);
    }
}

impl Trial {
    pub fn new(text: &str) -> Self {
        let file = file(&[("Main", text)], Format::V4);
        let (plan, findings) = compile(&[file], "Main");
        let plan = plan.unwrap_or_else(|| panic!("{text}: {findings:?}"));
        Self::of_plan(plan)
    }

    pub fn of_plan(plan: Plan) -> Self {
        let mut records = Vec::new();
        let mut make = |plan: &Plan, node: NodeId| {
            let record = Arc::new(Record::default());
            records.push(Arc::clone(&record));
            let answers = plan.describe(node).id.chars().map(status).collect();
            Ok(Box::new(Scripted { answers, record }) as Box<dyn Leaf>)
        };
        let tree = Tree::new(Arc::new(plan), &mut make).expect("leaves can be made");
        Self {
            tree,
            records,
            now: Duration::ZERO,
        }
    }

    /// One tick, `after_ms` after the last one. Whenever the root completes all others are idle.
    pub fn tick_after(&mut self, after_ms: u64) -> Result<Status, TickError> {
        self.now += Duration::from_millis(after_ms);
        let status = self.tree.tick(self.now, &mut ignored)?;
        if status != Status::Running {
            for node in self.tree.plan().node_ids().skip(1) {
                let path = &self.tree.plan().describe(node).path;
                assert_eq!(self.tree.status(node), Status::Idle, "{path}");
            }
        }
        Ok(status)
    }

    pub fn tick(&mut self) -> Status {
        self.tick_after(10)
            .unwrap_or_else(|error| panic!("{error}"))
    }

    /// The answers of so many ticks, as letters.
    pub fn answers(&mut self, ticks: usize) -> String {
        (0..ticks).map(|_| letter(self.tick())).collect()
    }

    pub fn halt(&mut self) -> Result<(), TickError> {
        self.tree.halt(self.now, &mut ignored)
    }

    /// How often each leaf was ticked, in the order of the text.
    pub fn ticks(&self) -> Vec<u32> {
        let ticks = self
            .records
            .iter()
            .map(|it| it.ticks.load(Ordering::Relaxed));
        ticks.collect()
    }

    /// How often each leaf was halted.
    pub fn halts(&self) -> Vec<u32> {
        let halts = self
            .records
            .iter()
            .map(|it| it.halts.load(Ordering::Relaxed));
        halts.collect()
    }
}

fn ignored(_node: NodeId, _before: Status, _now: Status) {}

pub fn letter(status: Status) -> char {
    match status {
        Status::Idle => 'I',
        Status::Running => 'R',
        Status::Success => 'S',
        Status::Failure => 'F',
        Status::Skipped => 'K',
    }
}

fn status(letter: char) -> Status {
    match letter {
        'S' => Status::Success,
        'F' => Status::Failure,
        'R' => Status::Running,
        'K' => Status::Skipped,
        _ => Status::Idle,
    }
}

/// Compiles a tree of files, unknown nodes as stubs.
pub fn compile(files: &[TreeFile], id: &str) -> (Option<Plan>, Vec<behavior_tree::Finding>) {
    let (library, mut findings) = Library::new(files);
    let options = CompileOptions {
        stubs: true,
        ..CompileOptions::default()
    };
    let (plan, more) = library.compile(id, &options);
    findings.extend(more);
    (plan, findings)
}

/// A file of trees.
pub fn file(trees: &[(&str, &str)], format: Format) -> TreeFile {
    let tree = |(id, text): &(&str, &str)| TreeDefinition {
        id: located(id),
        root: Some(node(&mut text.trim())),
    };
    TreeFile {
        format,
        main_tree: None,
        includes: Vec::new(),
        trees: trees.iter().map(tree).collect(),
        models: Vec::new(),
    }
}

pub fn located(text: &str) -> Located<String> {
    Located {
        value: text.to_owned(),
        place: Place::default(),
    }
}

/// The node at the beginning of a text, which is taken away.
fn node(text: &mut &str) -> NodeDefinition {
    let is_leaf = !text.starts_with('(');
    *text = text.strip_prefix('(').unwrap_or(text);
    let id = word(text);
    let mut node = NodeDefinition {
        class: None,
        id: located(id),
        name: None,
        attributes: Vec::new(),
        children: Vec::new(),
    };
    if is_leaf {
        if let Some(rest) = text.strip_prefix('<') {
            *text = rest;
            while !text.starts_with('>') {
                node.attributes.extend(attribute(text));
            }
            *text = text[1..].trim_start();
        }
        return node;
    }
    while !text.starts_with(')') {
        match attribute(text) {
            Some(attribute) if attribute.name.value == "name" => node.name = Some(attribute.value),
            Some(attribute) => node.attributes.push(attribute),
            None => node.children.push(self::node(text)),
        }
    }
    *text = text[1..].trim_start();
    node
}

fn attribute(text: &mut &str) -> Option<NodeAttribute> {
    let end = text.find(['=', '(', ')', '<', ' '])?;
    let name = &text[..end];
    let rest = text[end..].strip_prefix('=')?;
    let (value, rest) = match rest.strip_prefix('"') {
        Some(quoted) => quoted.split_once('"').expect("a closing quote"),
        None => rest.split_at(rest.find([' ', ')', '>']).unwrap_or(rest.len())),
    };
    *text = rest.trim_start();
    Some(NodeAttribute {
        name: located(name),
        value: located(value),
    })
}

fn word<'a>(text: &mut &'a str) -> &'a str {
    let end = text.find([' ', '(', ')', '<']).unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    assert!(!word.is_empty(), "a word at '{text}'");
    *text = rest.trim_start();
    word
}
