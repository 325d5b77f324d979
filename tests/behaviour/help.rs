//! What the command says of itself: schemas, completions, manual pages, help, exit codes.

use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use tests::{Finished, Watched, artifacts};

/// These only print.
const LIMIT: Duration = Duration::from_secs(30);

fn steadfast(arguments: &[&str]) -> Finished {
    let mut command = Command::new(artifacts().join("steadfast"));
    Watched::spawn(command.args(arguments)).wait(LIMIT)
}

#[track_caller]
fn printed(arguments: &[&str]) -> String {
    let finished = steadfast(arguments);
    assert_eq!(finished.code, Some(0), "{finished}");
    assert_eq!(finished.stderr, "");
    finished.stdout
}

#[test]
fn schemas_are_listed_and_printed() {
    let list: Value =
        serde_json::from_str(&printed(&["schema", "--format", "json"])).expect("JSON");
    let schemas = list["schemas"].as_array().expect("a list");
    let text = printed(&["schema"]);
    assert_eq!(text.lines().count(), schemas.len());
    for schema in schemas {
        let name = schema["name"].as_str().expect("a name");
        assert!(text.contains(name), "{text}");
        let schema = printed(&["schema", name]);
        assert!(schema.contains("<xs:documentation>") && !schema.contains("<xs:include"));
    }
    let one: Value =
        serde_json::from_str(&printed(&["schema", "world", "--format", "json"])).expect("JSON");
    assert_eq!(one["text"], printed(&["schema", "world"]));
    let finished = steadfast(&["schema", "wrold"]);
    assert_eq!(finished.code, Some(64), "{finished}");
    assert!(finished.stderr.contains("world"), "{finished}");
}

#[test]
fn every_shell_gets_completions() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = printed(&["completions", shell]);
        assert!(
            script.contains("completions") && script.contains("supervised"),
            "{shell}"
        );
    }
}

#[test]
fn every_command_has_a_manual_page() {
    assert!(printed(&["man"]).contains(".TH steadfast 1"));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("man1").display().to_string();
    assert_eq!(printed(&["man", "--output", &path]), "");
    let page = |name: &str| {
        let path = folder.path().join("man1").join(format!("{name}.1"));
        std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    for command in [
        "check",
        "run",
        "fault",
        "fault-show",
        "new-component",
        "schema",
    ] {
        assert!(
            page(&format!("steadfast-{command}")).contains(".SH SYNOPSIS"),
            "{command}"
        );
    }
    assert!(page("steadfast-run").contains("Exit codes"));
    let finished = steadfast(&["man", "--output", "/proc/nowhere"]);
    assert_eq!(finished.code, Some(2), "{finished}");
    assert!(finished.stderr.contains("help: "), "{finished}");
}

#[test]
fn help_is_a_page_with_examples_and_exit_codes() {
    for arguments in [
        &["--help"][..],
        &["help"],
        &["help", "run"],
        &["fault", "--help"],
    ] {
        let page = printed(arguments);
        assert!(page.contains("Exit codes"), "{arguments:?}");
        assert!(page.contains("\n  steadfast "), "{arguments:?}");
    }
    for arguments in [
        &["walk"][..],
        &["run"],
        &["check", "--frob"],
        &["schema", "a", "b"],
    ] {
        let finished = steadfast(arguments);
        assert_eq!(finished.code, Some(64), "{finished}");
        assert!(finished.stderr.contains("--help"), "{finished}");
    }
}
