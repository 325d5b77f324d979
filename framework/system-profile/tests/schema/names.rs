//! What may stand where: into every element of the samples every name is put that their schema has
//! anywhere, as a child and as an attribute. Schema and reader must agree whether it belongs there.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use system_profile::tree::Element;
use system_profile::{Document, LoadOptions, SCHEMAS, Severity, check_file};

use crate::samples::{declared, files_in, own};
use crate::xmllint;

/// Insertions into one document: fewer than problems of one file are listed.
const INSERTIONS: usize = 30;

/// Elements of which the readers read nothing, not even what is in them.
const UNREAD: [&str; 19] = [
    "/description",
    "/license_policy",
    "/app_domain",
    "/app_robot",
    "company/name",
    "/phone",
    "/fax",
    "/address",
    "/homepage",
    "copyright/version",
    "process_model/version",
    "process_model/copyright",
    "world_profile/version",
    "world_profile/copyright",
    "task_profile/version",
    "task_profile/copyright",
    "subcomponent/id",
    "subcomponent/type",
    "subcomponent/version",
];

/// Drawing tools' own, which the readers pass over anywhere. The schemas have them where those
/// tools write them; elsewhere an editor would offer them for nothing.
const DRAWING: [&str; 7] = [
    "layout",
    "collapsed",
    "port_layouts",
    "port_layout",
    "bend_points",
    "topics",
    "read_only",
];

fn is_unread(path: &str) -> bool {
    UNREAD.iter().any(|end| path.ends_with(end))
}

/// Reader only: whether a name belongs there depends on the value of another one.
fn depends(path: &str, name: &str) -> bool {
    path.ends_with("/fault_injections/inject")
        || (path.ends_with("/process_model") && name == "drift")
}

/// A document in which each insertion stands in a line of its own.
struct Probe {
    path: PathBuf,
    /// What was put in.
    name: String,
    /// By line.
    lines: BTreeMap<u32, Insertion>,
}

/// The element into which something was put.
struct Insertion {
    /// Where it begins.
    start_line: u32,
    /// Its name behind those of the elements that it is in.
    path: String,
}

/// Writes an element with insertions into those whose number is among `chosen`.
struct Writer<'a> {
    text: String,
    name: &'a str,
    as_attribute: bool,
    chosen: &'a BTreeSet<usize>,
    number: usize,
    lines: BTreeMap<u32, Insertion>,
}

impl Writer<'_> {
    fn write(&mut self, element: &Element, above: &str) {
        let path = format!("{above}/{}", element.name);
        let chosen = self.chosen.contains(&self.number);
        self.number += 1;
        let start_line = self.line() + 1;
        let _infallible = write!(self.text, "\n<{}", element.name);
        for attribute in &element.attributes {
            let value = escaped(&attribute.value);
            let _infallible = write!(self.text, " {}=\"{value}\"", attribute.name);
        }
        let has_it = element.attributes.iter().any(|it| it.name == self.name);
        if chosen && self.as_attribute && !has_it {
            let _infallible = write!(self.text, " {}=\"1\"", self.name);
            self.note(start_line, &path);
        }
        let _infallible = write!(self.text, ">{}", escaped(&element.text));
        for child in &element.children {
            self.write(child, &path);
        }
        if chosen && !self.as_attribute {
            let _infallible = write!(self.text, "\n<{}/>", self.name);
            self.note(start_line, &path);
        }
        let _infallible = write!(self.text, "</{}>", element.name);
    }

    fn note(&mut self, start_line: u32, path: &str) {
        let insertion = Insertion {
            start_line,
            path: path.to_owned(),
        };
        self.lines.insert(self.line(), insertion);
    }

    fn line(&self) -> u32 {
        1 + u32::try_from(self.text.matches('\n').count()).expect("a small file")
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

/// Elements by number in document order, one of each way of nesting that is not already in `known`.
fn places(root: &Element, known: &mut BTreeSet<String>) -> Vec<usize> {
    fn visit(
        element: &Element,
        above: &str,
        number: &mut usize,
        known: &mut BTreeSet<String>,
        found: &mut Vec<usize>,
    ) {
        let path = format!("{above}/{}", element.name);
        let passed_over = element.name.contains(':')
            || above.contains(':')
            || DRAWING.contains(&element.name.as_str())
            || is_unread(&path);
        if !passed_over && known.insert(path.clone()) {
            found.push(*number);
        }
        *number += 1;
        for child in &element.children {
            visit(child, &path, number, known, found);
        }
    }
    let mut found = Vec::new();
    visit(root, "", &mut 0, known, &mut found);
    found
}

/// All names that the schema of a file has anywhere, and one that none has.
fn names_for(root: &str, as_attribute: bool) -> BTreeSet<String> {
    let mut schemas = SCHEMAS[1..].iter();
    let schema = schemas.find(|schema| schema.roots.contains(&root));
    let (elements, attributes) = declared(schema.expect("a schema"));
    let mut names = if as_attribute { attributes } else { elements };
    names.retain(|name| !DRAWING.contains(&name.as_str()));
    names.insert("nonsense".into());
    names
}

fn probes(folder: &Path, as_attribute: bool) -> Vec<Probe> {
    let mut known = BTreeSet::new();
    let mut probes = Vec::new();
    for file in files_in(&own(), "xml") {
        let document = Document::open(&file);
        let root = document.tree().expect("well-formed");
        let places = places(root, &mut known);
        let names = names_for(&root.name, as_attribute);
        for chosen in places.chunks(INSERTIONS) {
            let chosen = chosen.iter().copied().collect();
            for name in &names {
                let mut writer = Writer {
                    text: "<?xml version=\"1.0\"?>".into(),
                    name,
                    as_attribute,
                    chosen: &chosen,
                    number: 0,
                    lines: BTreeMap::new(),
                };
                writer.write(root, "");
                let path = folder.join(format!("{}.xml", probes.len()));
                std::fs::write(&path, &writer.text).expect("a file");
                probes.push(Probe {
                    path,
                    name: name.clone(),
                    lines: writer.lines,
                });
            }
        }
    }
    probes
}

fn disagreements(as_attribute: bool) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let schema = xmllint::printed(folder.path(), "steadfast");
    let probes = probes(folder.path(), as_attribute);
    let files: Vec<PathBuf> = probes.iter().map(|probe| probe.path.clone()).collect();
    let complaints = xmllint::validate(&schema, &files);
    let mut found = BTreeSet::new();
    let none = Vec::new();
    for probe in &probes {
        let by_reader = Refusals::of_reader(&probe.path);
        let by_schema = complaints.get(&probe.path).unwrap_or(&none);
        for (line, Insertion { start_line, path }) in &probe.lines {
            let at_place = || {
                by_schema
                    .iter()
                    .filter(|(at, _)| at == line || at == start_line)
            };
            let misplaced = at_place().any(|(_, words)| {
                words.contains("not expected") || words.contains("is not allowed")
            });
            let who = if by_reader.misplaced.contains(line) {
                // An empty child may be refused for that as well.
                let refused = at_place().next().is_some();
                (!refused && !depends(path, &probe.name)).then_some("reader")
            } else {
                let told = by_reader.wrong.contains(line) || by_reader.may_have_more(path);
                let unread = is_unread(&format!("{path}/{}", probe.name));
                (misplaced && !told && !unread).then_some("schema")
            };
            let Some(who) = who else {
                continue;
            };
            found.insert(format!(
                "{} in {path}: refused by the {who} only",
                probe.name
            ));
        }
    }
    found.into_iter().collect()
}

/// What the reader finds wrong in a file.
struct Refusals {
    /// Lines with a name that does not belong there.
    misplaced: BTreeSet<u32>,
    /// Lines with any problem.
    wrong: BTreeSet<u32>,
    has_errors: bool,
}

impl Refusals {
    fn of_reader(path: &Path) -> Self {
        let options = LoadOptions {
            search_paths: vec![own()],
            ..LoadOptions::default()
        };
        let reports = check_file(path, &options);
        let problems = &reports[0].problems;
        let unknown = problems
            .iter()
            .filter(|it| it.message.starts_with("unknown "));
        Self {
            misplaced: unknown.map(|problem| problem.place.line).collect(),
            wrong: problems.iter().map(|problem| problem.place.line).collect(),
            has_errors: problems.iter().any(|it| it.severity == Severity::Error),
        }
    }

    /// The rules inside an application are read when nothing else in it is wrong, the place of a
    /// target if there is only one.
    fn may_have_more(&self, path: &str) -> bool {
        let later = ["/package_profile/", "/world_profile/target/"];
        self.has_errors && later.iter().any(|start| path.starts_with(start))
    }
}

#[test]
fn schemas_and_readers_know_the_same_elements() {
    if xmllint::is_there() {
        let found = disagreements(false);
        assert!(found.is_empty(), "{found:#?}");
    }
}

#[test]
fn schemas_and_readers_know_the_same_attributes() {
    if xmllint::is_there() {
        let found = disagreements(true);
        assert!(found.is_empty(), "{found:#?}");
    }
}
