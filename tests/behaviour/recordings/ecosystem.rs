//! The `mcap` package of PyPI reads what we write.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use serde_json::{Value, json};
use tests::{Watched, python, repository};

use super::counting;

/// Reads ten thousand messages in a second; a busy machine gets more.
const READ_LIMIT: Duration = Duration::from_secs(120);

fn decoded(python: &str, file: &Path, extent: &str) -> Value {
    let mut command = Command::new(python);
    command
        .arg(repository().join("tests/data/read_recording.py"))
        .arg(file)
        .arg(extent);
    let finished = Watched::spawn(&mut command).wait(READ_LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");
    serde_json::from_str(&finished.stdout).expect("the script prints JSON")
}

fn count(topics: &Value) -> usize {
    let topics = topics.as_object().expect("an object").values();
    topics
        .map(|it| it["messages"].as_array().expect("a list").len())
        .sum()
}

#[test]
fn decodes_schemas_events_diagnostics_and_data() {
    let Some(python) = python("mcap") else {
        return;
    };
    let application = counting();
    let file = application.folder().join("run.mcap");
    let path = file.to_str().expect("a path of this test");
    let outcome = application
        .run(&["--clock", "simulated", "--for", "1s", "--record", path])
        .ended_well();
    let found = decoded(&python, &file, "whole");
    let topics = &found["topics"];
    let written = &outcome.summary()["recording"]["messages"];
    assert_eq!(
        (&found["statistics"], json!(count(topics))),
        (written, written.clone())
    );
    assert_eq!(found["metadata"]["steadfast"]["application"], "application");

    let output = &topics["/counter/output"];
    assert_eq!(output["schema"], "Sample");
    assert_eq!(output["encodings"], json!(["jsonschema", "json"]));
    assert_eq!(output["properties"], json!(["number", "value"]));
    assert_eq!(
        output["messages"][41],
        json!([410_000_000, {"number": 42, "value": 42.0}])
    );

    let events = topics["/events"]["messages"].as_array().expect("a list");
    let events: Vec<&Value> = events.iter().map(|it| &it[1]).collect();
    assert_eq!(events, outcome.all_events().iter().collect::<Vec<_>>());

    let diagnostics = &topics["/diagnostics"];
    assert_eq!(diagnostics["schema"], "diagnostic_msgs/DiagnosticArray");
    let messages = diagnostics["messages"].as_array().expect("a list");
    let levels = messages.iter().map(|it| {
        let status = it[1]["status"].as_array().expect("a list");
        let culprit = status.iter().find(|it| it["name"] == "culprit");
        culprit.expect("it has a status")["level"]
            .as_u64()
            .expect("a number")
    });
    let mut levels: Vec<u64> = levels.collect();
    levels.dedup();
    // Not started, working, failed, working but with a fault that is not over, working, stopped.
    assert_eq!(levels.first(), Some(&3));
    assert!(levels.windows(2).any(|it| it == [0, 2]), "{levels:?}");
    assert_eq!(levels.last(), Some(&3));
}

#[test]
fn reads_a_file_that_was_cut() {
    let Some(python) = python("mcap") else {
        return;
    };
    let application = counting();
    let file = application.folder().join("run.mcap");
    let path = file.to_str().expect("a path of this test");
    let arguments = ["--clock", "simulated", "--for", "120s", "--record", path];
    let _outcome = application.run(&arguments).ended_well();
    let whole = std::fs::read(&file).expect("the recording");
    std::fs::write(&file, &whole[..whole.len() * 3 / 5]).expect("a shorter one");
    let found = decoded(&python, &file, "cut");
    assert!(found["cut"].is_string(), "it ends in the middle");
    let ours = recording::read(&file).expect("it can be opened");
    assert_eq!(count(&found["topics"]), ours.filter(Result::is_ok).count());
}
