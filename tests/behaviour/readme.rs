//! The README's first component, typed in as it stands there.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use tests::{Application, Watched, artifacts, repository};

/// The component SDK and one small crate, built on a busy machine.
const BUILD_LIMIT: Duration = Duration::from_secs(300);

/// The fenced block that follows the mention of a file.
fn block<'text>(section: &'text str, file: &str) -> &'text str {
    let from = section
        .find(&format!("`{file}`"))
        .unwrap_or_else(|| panic!("the README does not say `{file}`"));
    let fenced = &section[from..];
    let start = fenced.find("```").expect("a block follows") + 3;
    let start = start + fenced[start..].find('\n').expect("the fence ends its line") + 1;
    let end = start + fenced[start..].find("```").expect("the block ends");
    &fenced[start..end]
}

fn type_in(folder: &Path, section: &str) {
    std::fs::create_dir_all(folder.join("src")).expect("a folder");
    for file in ["Cargo.toml", "src/lib.rs", "thermostat.xml", "house.xml"] {
        let sdk = repository().join("framework/component-sdk");
        let content = block(section, file).replace(
            "../steadfast/framework/component-sdk",
            &sdk.to_string_lossy(),
        );
        std::fs::write(folder.join(file), content).expect("a file");
    }
    // What was resolved for the repository serves here too: nothing is fetched.
    let lock = repository().join("Cargo.lock");
    std::fs::copy(lock, folder.join("Cargo.lock")).expect("a lock file");
}

#[test]
fn the_component_in_five_minutes_works_as_written() {
    let readme = std::fs::read_to_string(repository().join("README.md")).expect("the README");
    let section = readme
        .split("\n## ")
        .find(|section| section.starts_with("A component in five minutes"))
        .expect("the README has a first component");
    let application = Application::new();
    let folder = application.folder().join("thermostat");
    type_in(&folder, section);
    let built = folder.join("target");
    let mut build = Command::new(env!("CARGO"));
    build
        .current_dir(&folder)
        .args(["build", "--quiet", "--offline", "--target-dir"])
        .arg(&built);
    let finished = Watched::spawn(&mut build).wait(BUILD_LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");

    let mut check = Command::new(artifacts().join("steadfast"));
    check
        .arg("check")
        .arg("--strict")
        .arg(folder.join("house.xml"));
    let finished = Watched::spawn(&mut check).wait(BUILD_LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");

    let libraries = built.join("debug").display().to_string();
    let outcome = application
        .run_file(
            &folder.join("house.xml"),
            &[
                "--library-path",
                &libraries,
                "--clock",
                "simulated",
                "--for",
                "2s",
            ],
        )
        .ended_well();
    assert_eq!(outcome.cycles("living_room"), 20);
    let said = outcome.logs("living_room").join("\n");
    assert!(said.contains("heating to 295 K"), "{said}");
}
