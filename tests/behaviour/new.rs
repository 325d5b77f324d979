//! `steadfast new`: what is written builds, runs and passes its own test, as it is.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use tempfile::TempDir;
use tests::{Finished, Watched, artifacts, repository};

/// The SDK and a few small crates, built on a busy machine.
const BUILD_LIMIT: Duration = Duration::from_secs(300);

/// A folder to write projects in.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().expect("a folder"),
        }
    }

    fn steadfast(&self, arguments: &[&str]) -> Finished {
        let mut command = Command::new(artifacts().join("steadfast"));
        let command = command.current_dir(self.folder.path()).args(arguments);
        Watched::spawn(command).wait(BUILD_LIMIT)
    }

    /// Writes a project with the SDK of this repository.
    fn project(&self, arguments: &[&str]) -> PathBuf {
        let sdk = repository().display().to_string();
        let all = [&["new"], arguments, &["--sdk", &sdk]].concat();
        let finished = self.steadfast(&all);
        assert_eq!(finished.code, Some(0), "{finished}");
        let folder = self.folder.path().join(arguments[1]);
        // What was resolved for the repository serves here too: nothing is fetched.
        if folder.join("Cargo.toml").is_file() {
            let lock = repository().join("Cargo.lock");
            std::fs::copy(lock, folder.join("Cargo.lock")).expect("a lock file");
        }
        folder
    }
}

/// Types in a command of a project, as its README says.
#[track_caller]
fn type_in(folder: &Path, program: &str, arguments: &[&str]) -> Finished {
    let mut command = Command::new(program);
    command
        .current_dir(folder)
        .args(arguments)
        .env("CARGO_NET_OFFLINE", "true")
        .env("CARGO_TARGET_DIR", folder.join("target"));
    let finished = Watched::spawn(&mut command).wait(BUILD_LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");
    finished
}

#[test]
fn a_component_in_rust_passes_its_own_test() {
    let desk = Desk::new();
    let folder = desk.project(&["component", "low_pass"]);
    let finished = type_in(&folder, env!("CARGO"), &["test"]);
    for test in ["each_step_goes_a_share_of_the_way", "it_runs_for_a_second"] {
        let passed = format!("{test} ... ok");
        assert!(finished.stdout.contains(&passed), "{finished}");
    }
    let finished = type_in(&folder, env!("CARGO"), &["build"]);
    assert!(!finished.stderr.contains("warning"), "{finished}");
    let run = [
        "run",
        "low_pass/alone.xml",
        "--library-path",
        "low_pass/target/debug",
    ];
    let finished = desk.steadfast(&[&run[..], &["--clock", "simulated", "--for", "2s"]].concat());
    assert_eq!(finished.code, Some(0), "{finished}");
}

#[test]
fn a_component_in_c_passes_its_own_test() {
    let desk = Desk::new();
    let folder = desk.project(&["component", "low_pass", "--language", "c"]);
    let finished = type_in(&folder, "make", &["test"]);
    assert!(finished.stdout.contains("low_pass: passed"), "{finished}");
}

#[test]
fn an_application_passes_its_own_test() {
    let desk = Desk::new();
    let folder = desk.project(&["application", "greenhouse"]);
    let finished = type_in(&folder, "./test.sh", &[]);
    assert!(finished.stdout.contains("greenhouse: passed"), "{finished}");
    assert!(!finished.stderr.contains("warning: unused"), "{finished}");
    let events = std::fs::read_to_string(folder.join("events.jsonl")).expect("events");
    assert!(events.contains("checkpoint"), "its memory was restored");
}

#[test]
fn what_cannot_be_written_is_refused_with_what_to_do() {
    let desk = Desk::new();
    let sdk = repository().display().to_string();
    let nowhere = desk.folder.path().display().to_string();
    for (name, sdk, code, words) in [
        ("Low-Pass", &sdk, 1, "how about `low_pass`?"),
        ("fn", &sdk, 1, "how about `my_fn`?"),
        ("low_pass", &nowhere, 2, "holds no SDK"),
    ] {
        let finished = desk.steadfast(&["new", "component", name, "--sdk", sdk]);
        assert_eq!(finished.code, Some(code), "{finished}");
        let told = &finished.stderr;
        assert!(
            told.contains(words) && told.contains("help: "),
            "{finished}"
        );
    }
    let finished = desk.steadfast(&["new", "component", "a", "--language", "cobol"]);
    assert_eq!(finished.code, Some(64), "{finished}");
    let left = std::fs::read_dir(desk.folder.path())
        .expect("a folder")
        .count();
    assert_eq!(left, 0, "nothing was written");

    let folder = desk.project(&["component", "low_pass"]);
    std::fs::write(folder.join("src/lib.rs"), "// mine").expect("a file");
    let finished = desk.steadfast(&["new", "application", "low_pass", "--sdk", &sdk]);
    assert_eq!(finished.code, Some(1), "{finished}");
    let kept = std::fs::read_to_string(folder.join("src/lib.rs")).expect("a file");
    assert_eq!(kept, "// mine");
}
