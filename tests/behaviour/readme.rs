//! The README's first component and its first rule, typed in as they stand there.

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
    let run = |more: &[&str]| {
        let mut arguments = vec![
            "--library-path",
            &libraries,
            "--clock",
            "simulated",
            "--for",
            "2s",
        ];
        arguments.extend(more);
        let house = folder.join("house.xml");
        application.run_file(&house, &arguments).ended_well()
    };
    let outcome = run(&[]);
    assert_eq!(outcome.cycles("living_room"), 20);
    let said = outcome.logs("living_room").join("\n");
    assert!(said.contains("heating to 295 K"), "{said}");

    let (rules, faults) = type_in_rules(&folder, &readme);
    let mut check = Command::new(artifacts().join("steadfast"));
    check.args(["check", "--strict", &rules, &faults]);
    let finished = Watched::spawn(&mut check).wait(BUILD_LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");
    let outcome = run(&["--rules", &rules, "--inject", &faults]);
    let verdicts = outcome.events("verdict", "living_room");
    for kind in ["segfault", "out_of_range"] {
        let handled = verdicts
            .iter()
            .any(|verdict| verdict["kind"] == kind && verdict["actions"][0]["outcome"] == "done");
        assert!(handled, "{kind}: {verdicts:?}");
    }
    assert_eq!(outcome.component("living_room")["state"], "ACTIVE");
    report(&folder, &readme);
}

/// The README's first report, by the commands that stand there.
fn report(folder: &Path, readme: &str) {
    let section = readme
        .split("<!-- command: report -->")
        .nth(1)
        .expect("the README has a first report");
    let steadfast = artifacts().join("steadfast").display().to_string();
    let commands = block(&format!("`commands`{section}"), "commands")
        .replace("../steadfast/target/release/steadfast", &steadfast);
    let mut shell = Command::new("sh");
    shell.current_dir(folder).args(["-e", "-c", &commands]);
    let finished = Watched::spawn(&mut shell).wait(BUILD_LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");
    let page = std::fs::read_to_string(folder.join("report.html")).expect("a report");
    for part in [
        "Segfault of living_room",
        "living_room/heating: value, as recorded",
    ] {
        assert!(page.contains(part), "{part}: {page}");
    }
}

/// Rules and faults of the README's first rule.
fn type_in_rules(folder: &Path, readme: &str) -> (String, String) {
    let section = readme
        .split("\n## ")
        .find(|section| section.starts_with("A rule in two minutes"))
        .expect("the README has a first rule");
    let file = |name: &str| {
        let path = folder.join(name);
        std::fs::write(&path, block(section, name)).expect("a file");
        path.display().to_string()
    };
    (file("house_rules.xml"), file("house_faults.xml"))
}
