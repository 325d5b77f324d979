//! Every sample of the repository is valid under the schemas and without problem for the readers;
//! together they hold every element and attribute that the schemas know.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use system_profile::tree::Element;
use system_profile::{Document, LoadOptions, SCHEMAS, Schema, check_file, read_profile};

use crate::xmllint;

const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The folder of the samples that were written for these tests.
pub fn own() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/schema")
}

/// All files of an ending in a folder and in those below it, without what was built.
pub fn files_in(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let files = paths.flat_map(|path| match path.is_dir() {
        // What was built; and behaviour trees, which are BehaviorTree.CPP's own format.
        true if path.ends_with("target") || path.ends_with("trees") => Vec::new(),
        true => files_in(&path, ending),
        false => vec![path],
    });
    let mut files: Vec<PathBuf> = files
        .filter(|path| path.extension().is_some_and(|found| found == ending))
        .collect();
    files.sort();
    files
}

/// Profiles, rules and test data; not the file whose purpose is to be wrong.
fn samples() -> Vec<PathBuf> {
    let folders = ["profiles", "rules", "tests", "framework"];
    let folders = folders.map(|name| Path::new(REPOSITORY).join(name));
    let files = folders.iter().flat_map(|folder| files_in(folder, "xml"));
    files
        .filter(|path| !path.ends_with("all_mistakes.xml"))
        .collect()
}

/// The XML of the README: whole files as they are, rules in what they stand in.
fn of_the_readme() -> Vec<String> {
    let readme = std::fs::read_to_string(Path::new(REPOSITORY).join("README.md")).expect("README");
    let blocks = readme.split("```xml\n").skip(1);
    let texts = blocks.filter_map(|rest| rest.split("```").next());
    let texts = texts.map(|text| match text.starts_with("<?xml") {
        true => text.to_owned(),
        false => format!(
            "<fault_rules application='any'><component name='any'>{text}</component></fault_rules>"
        ),
    });
    texts.collect()
}

#[test]
fn every_sample_is_valid() {
    if !xmllint::is_there() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut files = samples();
    assert!(files.len() > 50, "{files:?}");
    let fragments = of_the_readme();
    assert!(fragments.len() > 3, "{fragments:?}");
    for (number, text) in fragments.iter().enumerate() {
        let path = folder.path().join(format!("readme_{number}.xml"));
        std::fs::write(&path, text).expect("a file");
        files.push(path);
    }
    let as_it_lies = Path::new(REPOSITORY).join("profiles/schema/steadfast.xsd");
    for schema in [as_it_lies, xmllint::printed(folder.path(), "steadfast")] {
        let complaints = xmllint::validate(&schema, &files);
        assert!(complaints.is_empty(), "{complaints:#?}");
    }
    for file in &files {
        let document = Document::open(file);
        read_profile(&document);
        assert!(document.problems().is_empty(), "{:#?}", document.problems());
    }
}

#[test]
fn the_samples_of_these_tests_have_no_problem_of_any_kind() {
    for file in files_in(&own(), "xml") {
        for report in check_file(&file, &LoadOptions::default()) {
            assert!(report.problems.is_empty(), "{:#?}", report.problems);
        }
    }
}

#[test]
fn each_schema_is_for_its_own_files() {
    if !xmllint::is_there() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let files = samples();
    let (mut taken, mut refused) = (0, 0);
    for schema in &SCHEMAS[1..] {
        let path = xmllint::printed(folder.path(), schema.name);
        let complaints = xmllint::validate(&path, &files);
        for file in &files {
            let document = Document::open(file);
            let is_own = document
                .root_name()
                .is_some_and(|root| schema.roots.contains(&root));
            assert_eq!(
                !complaints.contains_key(file),
                is_own,
                "{}: {file:?}",
                schema.name
            );
            taken += usize::from(is_own);
            refused += usize::from(!is_own);
        }
    }
    assert_eq!(taken, files.len());
    assert_eq!(refused, files.len() * (SCHEMAS.len() - 2));
}

/// The corpus lies beside the project, not in it; without it the test says so and passes.
#[test]
fn every_public_file_is_valid() {
    let corpus = Path::new(REPOSITORY).join("../shared/corpus/opros");
    if !corpus.is_dir() {
        eprintln!("skipped: there is no corpus at {}", corpus.display());
        return;
    }
    if !xmllint::is_there() {
        return;
    }
    let files = files_in(&corpus, "xml").into_iter();
    let files: Vec<_> = files
        .filter(|file| Document::open(file).tree().is_some())
        .collect();
    let folder = tempfile::tempdir().expect("a folder");
    let complaints = xmllint::validate(&xmllint::printed(folder.path(), "steadfast"), &files);
    assert!(
        files.len() > 100 && complaints.is_empty(),
        "{complaints:#?}"
    );
}

/// Names of elements and attributes that a schema declares. Documentation may stand with the
/// declaration or with its type.
pub fn declared(schema: &Schema) -> (BTreeSet<String>, BTreeSet<String>) {
    let document = Document::from_bytes("declared.xsd", schema.text().as_bytes());
    let root = document.tree().expect("well-formed");
    let (mut elements, mut attributes) = (BTreeSet::new(), BTreeSet::new());
    collect(root, root, &mut elements, &mut attributes);
    (elements, attributes)
}

fn collect(
    node: &Element,
    root: &Element,
    elements: &mut BTreeSet<String>,
    attributes: &mut BTreeSet<String>,
) {
    let documented = |node: &Element| {
        let annotation = node.child("xs:annotation");
        annotation.is_some_and(|node| {
            node.child_text("xs:documentation")
                .is_some_and(|it| it.len() > 3)
        })
    };
    if let (Some(name), "xs:element" | "xs:attribute") =
        (node.attribute("name"), node.name.as_str())
    {
        let of_type = || {
            let mut types = root.children.iter();
            types.find(|other| {
                other.attribute("name") == node.attribute("type") && documented(other)
            })
        };
        assert!(
            documented(node) || of_type().is_some(),
            "{name} says nothing on hover"
        );
        let names = match node.name.as_str() {
            "xs:element" => &mut *elements,
            _ => &mut *attributes,
        };
        names.insert(name.to_owned());
    }
    for child in &node.children {
        collect(child, root, elements, attributes);
    }
}

#[test]
fn everything_that_is_declared_is_documented_and_stands_in_a_sample() {
    fn strike(node: &Element, elements: &mut BTreeSet<String>, attributes: &mut BTreeSet<String>) {
        elements.remove(&node.name);
        for attribute in &node.attributes {
            attributes.remove(&attribute.name);
        }
        for child in &node.children {
            strike(child, elements, attributes);
        }
    }
    let (mut elements, mut attributes) = declared(&SCHEMAS[0]);
    assert!(elements.len() > 200 && attributes.len() > 100);
    for file in files_in(&own(), "xml") {
        let document = Document::open(file);
        strike(
            document.tree().expect("well-formed"),
            &mut elements,
            &mut attributes,
        );
    }
    assert_eq!((elements, attributes), Default::default());
}
