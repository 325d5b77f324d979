//! The profiles of the reference robot are without fault, and its world is there.

use std::path::{Path, PathBuf};

use system_profile::{LoadOptions, check_file, load_application, load_process_model, load_world};

fn profiles() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../profiles")
}

#[test]
fn target_following_has_no_problem_of_any_kind() {
    let path = profiles().join("applications/target_following.xml");
    let outcome = load_application(&path, &LoadOptions::default());
    assert!(outcome.problems.is_empty(), "{:#?}", outcome.problems);
    let application = outcome.specification.expect("a sound application");
    assert_eq!(application.components.len(), 11);
    let world = load_world(&application.world.expect("a world"));
    assert!(world.world.is_some() && world.problems.is_empty());
}

#[test]
fn the_model_of_the_drive_has_no_problem_and_the_right_size() {
    let outcome = load_process_model(&profiles().join("models/dc_motor.xml"));
    assert!(outcome.problems.is_empty(), "{:#?}", outcome.problems);
    let model = outcome.model.expect("a sound model");
    let (inputs, outputs) = (model.state_space.b.columns, model.state_space.c.rows);
    assert_eq!((inputs, outputs, model.inputs.len()), (2, 2, 2));
}

#[test]
fn the_secondary_has_the_ports_of_the_primary() {
    let ports = |name: &str| {
        let path = profiles().join(format!("components/{name}.xml"));
        let text = std::fs::read_to_string(path).expect("a profile");
        let start = text.find("<ports>").expect("ports");
        text[start..].to_owned()
    };
    assert_eq!(
        ports("obstacle_avoidance"),
        ports("obstacle_avoidance_simple")
    );
}

#[test]
fn a_world_is_no_application() {
    let path = profiles().join("worlds/target_arena.xml");
    let outcome = load_application(&path, &LoadOptions::default());
    assert!(outcome.specification.is_none());
    assert_eq!(
        outcome.problems[0].message,
        "<world_profile> is no application"
    );
}

/// All XML files of a folder and of those in it.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let files = paths.flat_map(|path| match path.is_dir() {
        // Behaviour trees are another format, and read with the application that has them.
        true if path.ends_with("trees") => Vec::new(),
        true => files_in(&path),
        false => vec![path],
    });
    files
        .filter(|path| path.extension().is_some_and(|ending| ending == "xml"))
        .collect()
}

#[test]
fn no_shipped_file_has_a_problem_of_any_kind() {
    let files = [
        files_in(&profiles()),
        files_in(&profiles().join("../rules")),
    ]
    .concat();
    assert!(files.len() > 30, "{files:#?}");
    for file in files {
        for report in check_file(&file, &LoadOptions::default()) {
            assert!(report.problems.is_empty(), "{:#?}", report.problems);
        }
    }
}

#[test]
fn every_scenario_has_rules_and_injections() {
    let scenarios = profiles().join("../rules/scenarios");
    let read_me = std::fs::read_to_string(scenarios.join("README.md")).expect("a README");
    for entry in std::fs::read_dir(scenarios).expect("a folder") {
        let folder = entry.expect("an entry").path();
        if folder.is_dir() {
            for file in ["rules.xml", "injections.xml"] {
                assert!(folder.join(file).is_file(), "{}", folder.display());
            }
            let name = folder.file_name().expect("a name").to_string_lossy();
            assert!(read_me.contains(&format!("`{name}`")), "{name}");
        }
    }
}
