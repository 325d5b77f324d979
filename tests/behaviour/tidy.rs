//! The house is in order: dependencies point one way, and unsafe code lives where the list says.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::time::Duration;

use serde_json::Value;
use tests::{Watched, repository};

/// Which crates of the workspace each crate of the framework may build on; development
/// dependencies do not count. A new crate gets its place here.
const FRAMEWORK: [(&str, &[&str]); 14] = [
    ("component-abi", &[]),
    ("component-sdk-derive", &[]),
    ("component-sdk", &["component-abi", "component-sdk-derive"]),
    ("system-model", &[]),
    ("behavior-tree", &["system-model"]),
    ("system-profile", &["behavior-tree", "system-model"]),
    ("fault-manager", &["system-model"]),
    ("task-adaptation", &["system-model"]),
    ("recording", &["system-model"]),
    ("robot-interface", &["component-sdk"]),
    ("robot-simulation", &["robot-interface", "system-model"]),
    ("robot-vision", &[]),
    ("robot-network", &["system-model"]),
    (
        "container",
        &[
            "behavior-tree",
            "component-abi",
            "fault-manager",
            "recording",
            "robot-network",
            "robot-simulation",
            "system-model",
            "system-profile",
            "task-adaptation",
        ],
    ),
];

/// What components may build on: the contract, and what they share with each other.
const COMPONENTS: [&str; 5] = [
    "component-abi",
    "component-sdk",
    "robot-interface",
    "robot-vision",
    "test-parts",
];

/// One crate of the workspace.
struct Package {
    name: String,
    folder: PathBuf,
    /// Crates of the workspace that it builds on.
    dependencies: Vec<String>,
    /// Root files of its libraries and programs.
    roots: Vec<PathBuf>,
}

static PACKAGES: LazyLock<Vec<Package>> = LazyLock::new(|| {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(repository()).args([
        "metadata",
        "--no-deps",
        "--offline",
        "--format-version",
        "1",
    ]);
    let finished = Watched::spawn(&mut cargo).wait(Duration::from_secs(120));
    assert_eq!(finished.code, Some(0), "{finished}");
    let metadata: Value = serde_json::from_str(&finished.stdout).expect("cargo prints JSON");
    let packages: Vec<Package> = list(&metadata["packages"]).map(package).collect();
    assert!(packages.len() > 20, "the workspace has its crates");
    packages
});

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().expect("a list").iter()
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a text")
}

fn package(value: &Value) -> Package {
    let manifest = Path::new(text(&value["manifest_path"]));
    let own = |dependency: &&Value| dependency["path"].is_string() && dependency["kind"] != "dev";
    let root = |target: &&Value| {
        let mut kinds = list(&target["kind"]).map(text);
        kinds.any(|kind| matches!(kind, "lib" | "cdylib" | "proc-macro" | "bin"))
    };
    Package {
        name: text(&value["name"]).to_owned(),
        folder: manifest
            .parent()
            .expect("a manifest lies in a folder")
            .to_owned(),
        dependencies: list(&value["dependencies"])
            .filter(own)
            .map(|dependency| text(&dependency["name"]).to_owned())
            .collect(),
        roots: list(&value["targets"])
            .filter(root)
            .map(|target| PathBuf::from(text(&target["src_path"])))
            .collect(),
    }
}

#[test]
fn dependencies_point_one_way() {
    let framework = BTreeMap::from(FRAMEWORK);
    for package in PACKAGES.iter() {
        let place = package
            .folder
            .strip_prefix(repository())
            .expect("inside the repository");
        let allowed: &[&str] = if place == Path::new("tests") {
            continue;
        } else if place.starts_with("framework") {
            framework
                .get(package.name.as_str())
                .unwrap_or_else(|| panic!("'{}' has no place in the house yet", package.name))
        } else {
            &COMPONENTS
        };
        for dependency in &package.dependencies {
            assert!(
                allowed.contains(&dependency.as_str()),
                "'{}' must not depend on '{dependency}'",
                package.name
            );
        }
    }
}

#[test]
fn folders_are_called_like_their_crates() {
    for package in PACKAGES.iter() {
        let folder = package.folder.file_name().expect("a folder has a name");
        let name = package.name.as_str();
        // Beside the other parts of the tests the folder need not say whose parts they are.
        let name = name.strip_prefix("test-").unwrap_or(name);
        assert_eq!(folder, name);
    }
}

/// Addresses in `framework/ARCHITECTURE.md`; a folder ends with a slash.
fn listed() -> BTreeSet<String> {
    let path = repository().join("framework/ARCHITECTURE.md");
    let page = std::fs::read_to_string(path).expect("the architecture is written down");
    let mut lines = page.lines();
    let heading = lines.any(|line| line.starts_with('#') && line.contains("Where unsafe lives"));
    assert!(
        heading,
        "ARCHITECTURE.md has the heading 'Where unsafe lives'"
    );
    let addresses: BTreeSet<String> = lines
        .take_while(|line| !line.starts_with('#'))
        .filter(|line| line.starts_with(['*', '-']))
        .filter_map(|line| line.split('`').nth(1))
        .map(str::to_owned)
        .collect();
    assert!(!addresses.is_empty(), "the list has entries");
    addresses
}

fn is_listed(listed: &BTreeSet<String>, file: &str) -> bool {
    let within = |entry: &&String| entry.ends_with('/') && file.starts_with(entry.as_str());
    listed.contains(file) || listed.iter().any(|entry| within(&entry))
}

fn forbids_unsafe(root: &Path) -> bool {
    let content = std::fs::read_to_string(root).expect("a crate has its root");
    content
        .lines()
        .any(|line| line.starts_with("#![forbid(unsafe_code)]"))
}

/// Files with unsafe code, of a crate that does not forbid it.
fn files_with_unsafe(package: &Package) -> Vec<String> {
    let mut found = Vec::new();
    for file in sources(&package.folder) {
        let content = std::fs::read_to_string(&file).expect("a source is readable");
        if content.lines().any(has_unsafe_code) {
            let place = file
                .strip_prefix(repository())
                .expect("inside the repository");
            found.push(place.to_string_lossy().into_owned());
        }
    }
    found
}

/// Comments, texts and names of lints do not count, nor do types of foreign functions: only to call
/// one is unsafe.
fn has_unsafe_code(line: &str) -> bool {
    let code = line.split("//").next().unwrap_or_default();
    let is_type = code.contains("extern \"C\" fn(");
    let outside_texts: String = code.split('"').step_by(2).collect();
    let mut tokens = outside_texts.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    // A file that allows it to the files below it counts as well.
    let allows = outside_texts.contains("allow(") && outside_texts.contains("unsafe_code");
    allows || !is_type && tokens.any(|token| token == "unsafe")
}

/// Rust files of a crate, without those of crates in folders below it.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a crate has a folder") {
        let path = entry.expect("a folder can be listed").path();
        if path.is_dir() {
            if !path.join("Cargo.toml").exists() && !path.ends_with("target") {
                found.extend(sources(&path));
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

#[test]
fn unsafe_code_lives_where_the_list_says() {
    let listed = listed();
    let mut could_forbid = Vec::new();
    let mut unlisted = Vec::new();
    let mut used = BTreeSet::new();
    for package in PACKAGES.iter() {
        if package.roots.iter().all(|root| forbids_unsafe(root)) {
            continue;
        }
        let files = files_with_unsafe(package);
        for file in &files {
            if is_listed(&listed, file) {
                let entry = listed.iter().find(|entry| file.starts_with(entry.as_str()));
                used.extend(entry.cloned());
            } else {
                unlisted.push(file.clone());
            }
        }
        if files.is_empty() {
            could_forbid.push(package.name.as_str());
        }
    }
    assert_eq!(
        unlisted, [""; 0],
        "files with unsafe code that are not on the list"
    );
    assert_eq!(
        could_forbid, [""; 0],
        "crates without unsafe code say #![forbid(unsafe_code)] in each root"
    );
    let stale: Vec<&String> = listed.difference(&used).collect();
    assert_eq!(stale, [""; 0], "the list names files without unsafe code");
}
