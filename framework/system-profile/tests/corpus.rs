//! Every public OPRoS file, against the facts that an independent reader found in it. The corpus
//! lies beside the project, not in it; without it the test says so and passes.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde_json::Value;
use system_model::profile::Profile;
use system_profile::{Document, LoadOptions, Problem, Severity, check_file, read_profile, reading};

const CORPUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/corpus/opros");

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_none_or(|ending| ending == "xml") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn corpus() -> Option<(Vec<PathBuf>, serde_json::Map<String, Value>)> {
    let Ok(readings) = std::fs::read_to_string(format!("{CORPUS}/readings.json")) else {
        eprintln!("skipped: there is no corpus at {CORPUS}");
        return None;
    };
    let readings = serde_json::from_str(&readings).unwrap();
    Some((files(Path::new(CORPUS)), readings))
}

#[test]
fn every_file_reads_as_the_independent_reader_read_it() {
    let Some((files, readings)) = corpus() else {
        return;
    };
    let mut seen = BTreeSet::new();
    for path in &files {
        let document = Document::open(path);
        let digest = document.sha256().unwrap().to_owned();
        let mut expected = readings[&digest].clone();
        expected["path"] = path.to_string_lossy().into();
        assert_eq!(reading(&document), expected, "{}", path.display());
        seen.insert(digest);
    }
    assert_eq!(seen.len(), readings.len(), "every reading has its file");
}

#[test]
fn the_malformed_file_is_refused_at_its_offending_character() {
    let Some((files, _)) = corpus() else {
        return;
    };
    let malformed: Vec<Document> = files
        .iter()
        .map(Document::open)
        .filter(|document| document.tree().is_none())
        .collect();
    let [document] = &malformed[..] else {
        panic!("one file is malformed, not {}", malformed.len());
    };
    let problem = document.malformed().unwrap();
    assert_eq!((problem.place.line, problem.place.column), (5, 51));
    assert_eq!(problem.length, 1);
}

#[test]
fn every_well_formed_file_becomes_a_typed_profile() {
    let Some((files, readings)) = corpus() else {
        return;
    };
    for path in &files {
        let document = Document::open(path);
        if document.tree().is_none() {
            continue;
        }
        let profile = read_profile(&document).unwrap();
        let problems = document.problems();
        let expected = |problem: &Problem| problem.message.ends_with("is set again");
        assert!(problems.iter().all(expected), "{path:?}: {problems:?}");
        let facts = &readings[document.sha256().unwrap()];
        let count = |key: &str| facts[key].as_array().unwrap().len();
        match profile {
            Profile::Component(profile) => {
                assert_eq!(profile.ports.len(), count("ports"));
                assert_eq!(profile.properties.len(), count("properties"));
                assert_eq!(profile.header.name.value, facts["name"]);
            }
            Profile::Application(profile) => {
                assert_eq!(profile.subcomponents.len(), count("subcomponents"));
                assert_eq!(profile.connections.len(), count("connections"));
            }
            Profile::Composite(profile) => assert_eq!(profile.exports.len(), count("exports")),
            Profile::ServiceTypes(profile) => assert_eq!(profile.types.len(), count("types")),
            Profile::DataTypes(profile) => assert_eq!(profile.structures.len(), count("structs")),
            Profile::System(_) | Profile::Project(_) => {}
        }
    }
}

#[test]
fn only_dangling_references_and_repeated_properties_are_remarked_upon() {
    let Some((files, _)) = corpus() else {
        return;
    };
    let options = LoadOptions {
        dangling: Severity::Warning,
        ..LoadOptions::default()
    };
    for report in files.iter().flat_map(|path| check_file(path, &options)) {
        for problem in report.problems {
            let place = &problem.place;
            assert!(
                problem.message.starts_with("there is no file")
                    || problem.message.ends_with("is set again")
                    || problem.message.starts_with("not well-formed"),
                "{place}: {problem}"
            );
        }
    }
}

#[test]
fn the_public_arm_application_resolves_once_its_folders_are_named() {
    let Some((files, _)) = corpus() else {
        return;
    };
    let find = |name: &str| files.iter().find(|path| path.ends_with(name)).cloned();
    let application = find("JointSpaceControlWithCompositeComponentApp.xml").unwrap();
    let workspace = application.ancestors().nth(2).unwrap();
    let mut search_paths: Vec<PathBuf> = std::fs::read_dir(workspace)
        .unwrap()
        .flat_map(|entry| {
            let folder = entry.unwrap().path();
            [folder.join("profile"), folder]
        })
        .collect();
    search_paths.sort();
    let options = LoadOptions {
        search_paths,
        dangling: Severity::Error,
    };
    let outcome = system_profile::load_application(&application, &options);
    assert!(outcome.problems.is_empty(), "{:?}", outcome.problems);
    let specification = outcome.specification.unwrap();
    let names: Vec<&str> = specification
        .components
        .iter()
        .map(|component| component.name.as_str())
        .collect();
    let inside = "JointSpaceControlCompositeComponent/JointSpaceControlCoodinatorComp";
    assert!(names.contains(&inside), "{names:?}");
    assert_eq!(specification.components.len(), 5);
    assert_eq!(specification.connections.len(), 4);
}
