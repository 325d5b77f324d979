//! What the tests run: the `steadfast` command, component libraries, components in C. Built once a
//! test process, with the profile and into the folder of the running test.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::Duration;

use crate::watchdog::{Watched, repository};

/// A build from nothing, on a small machine that other work keeps busy.
const BUILD_LIMIT: Duration = Duration::from_secs(30 * 60);

/// A file of C compiles in well under a second.
const COMPILE_LIMIT: Duration = Duration::from_secs(120);

/// The folder with `steadfast` and all component libraries of the tests.
pub fn artifacts() -> &'static Path {
    static ARTIFACTS: LazyLock<PathBuf> = LazyLock::new(build);
    &ARTIFACTS
}

fn build() -> PathBuf {
    let executable = std::env::current_exe().expect("a running test knows its file");
    // <target>/<profile>/deps/<test>
    let artifacts = executable
        .ancestors()
        .nth(2)
        .expect("tests lie in 'deps'")
        .to_owned();
    let target = artifacts.parent().expect("a profile has a folder");
    let profile = match artifacts.file_name().and_then(|name| name.to_str()) {
        Some("debug") | None => "dev",
        Some(other) => other,
    };
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .current_dir(repository())
        .args(["build", "--offline", "--quiet", "--profile", profile])
        .arg("--target-dir")
        .arg(target)
        .args(["--package", "container"]);
    for folder in ["components", "tests/components", "tests/faulty-components"] {
        for name in folders(&repository().join(folder)) {
            cargo.args(["--package", &name]);
        }
    }
    let finished = Watched::spawn(&mut cargo).wait(BUILD_LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");
    artifacts
}

fn folders(parent: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(parent).expect("the tests' components are there");
    let mut names: Vec<String> = entries
        .map(|entry| entry.expect("a folder can be listed"))
        .filter(|entry| entry.path().join("Cargo.toml").is_file())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Compiles a C file of `tests/data` into the library `name` in `folder`, with `defines`.
pub fn c_component(folder: &Path, source: &str, name: &str, defines: &[&str]) {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _one = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let compiler = std::env::var("CC").unwrap_or_else(|_unset| "cc".to_owned());
    let mut command = Command::new(compiler);
    command
        .args(["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"])
        .args(["-shared", "-fPIC", "-I"])
        .arg(repository().join("framework/component-abi/include"))
        .args(defines.iter().map(|define| format!("-D{define}")))
        .arg("-o")
        .arg(folder.join(format!("{name}.so")))
        .arg(repository().join("tests/data").join(source));
    let finished = Watched::spawn(&mut command).wait(COMPILE_LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");
}
