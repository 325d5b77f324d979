//! Replaying: the rules of today on the data of yesterday.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use recording::{Layout, RecordingWriter};
use serde_json::Value;
use system_model::data_type::{DataType, Field, Scalar};
use tests::{Application, Finished, Member, Outcome, Watched, artifacts};

use super::{counting, messages};

/// A replay takes a second; a busy machine gets more.
const REPLAY_LIMIT: Duration = Duration::from_secs(100);

/// A run of two seconds that is recorded.
fn recorded(application: &Application) -> (PathBuf, Outcome) {
    let file = application.folder().join("run.mcap");
    let path = file.to_str().expect("a path of this test");
    let outcome = application.run(&["--clock", "simulated", "--for", "2s", "--record", path]);
    (file, outcome.ended_well())
}

fn replay(application: &Application, file: &Path, arguments: &[&str]) -> Finished {
    let mut command = Command::new(artifacts().join("steadfast"));
    command
        .arg("replay")
        .arg(file)
        .arg(application.profile())
        .args(arguments)
        .env_remove("STEADFAST_LIBRARY_PATH");
    Watched::spawn(&mut command).wait(REPLAY_LIMIT)
}

/// By rules: elements of `fault_rules`.
fn by_rules(application: &Application, file: &Path, rules: &str) -> Value {
    let rules = format!("<fault_rules application='application'>{rules}</fault_rules>");
    let rules = application.write("tried.xml", rules);
    let rules = rules.to_str().expect("a path of this test");
    let finished = replay(application, file, &["--rules", rules, "--format", "json"]);
    assert_eq!(finished.code, Some(0), "{finished}");
    serde_json::from_str(&finished.stdout).expect("the result is JSON")
}

fn confirmed_ns(result: &Value) -> Vec<u64> {
    let faults = result["faults"].as_array().expect("a list").iter();
    faults
        .map(|it| it["confirmed_ns"].as_u64().expect("a time"))
        .collect()
}

/// At most so large, confirmed by so many in a row; the component goes on in any case.
fn at_most(most: f64, count: u32) -> String {
    format!(
        "<component name='counter'><port name='output'><validity field='value'><max>{most}</max>\
         <confirm count='{count}'/><severity>ignore</severity></validity></port></component>"
    )
}

#[test]
fn tunes_a_rule_on_what_was_recorded() {
    let application = counting();
    let (file, _) = recorded(&application);
    // The counter counts from 1 at 0 ms, every 10 ms.
    for (most, count, expected) in [
        (50.0, 1, &[500_000_000][..]),
        (50.0, 4, &[530_000_000]),
        (150.0, 1, &[1_500_000_000]),
        (1000.0, 1, &[]),
    ] {
        let result = by_rules(&application, &file, &at_most(most, count));
        assert_eq!(confirmed_ns(&result), expected, "{most} {count}");
        // The panic of that time is on record, and is no finding of these rules.
        assert_eq!(result["recorded_faults"][0]["component"], "culprit");
        assert_eq!(result["data"], 200 + 200);
    }
}

#[test]
fn finds_what_the_run_itself_has_found() {
    let application = counting()
        .injections("<inject at='1s' component='recorder' port='input' fault='drop' for='200ms'/>")
        .injections("<inject at='1500ms' component='counter' port='output' fault='not_a_number' for='30ms'/>");
    let rules = "<component name='recorder'><severity>ignore</severity><port name='input'>\
                 <freshness max_age='50'/><validity field='value'/></port></component>\
                 <component name='counter'><severity>ignore</severity><port name='output'>\
                 <validity field='value'/></port></component>";
    let application = application.rules(rules);
    let (file, outcome) = recorded(&application);
    let of_ports = |verdict: &&&Value| verdict["component"] != "culprit";
    let found: Vec<(String, u64)> = outcome
        .verdicts()
        .iter()
        .filter(of_ports)
        .map(|it| {
            (
                it["kind"].to_string(),
                it["confirmed_ns"].as_u64().expect("a time"),
            )
        })
        .collect();
    assert!(found.len() >= 2, "{found:?}");
    let result = by_rules(&application, &file, rules);
    let again = result["faults"].as_array().expect("a list").iter();
    let again: Vec<(String, u64)> = again
        .map(|it| {
            (
                it["kind"].to_string(),
                it["confirmed_ns"].as_u64().expect("a time"),
            )
        })
        .collect();
    assert_eq!(again, found);
}

#[test]
fn feeds_a_component_as_it_was_fed() {
    let application = Application::new()
        .with(&Member::new("counter", "counter").priority(2))
        .with(
            &Member::new("recorder", "recorder")
                .property("verbose", "true")
                .priority(1),
        )
        .connect("data", "counter.output", "recorder.input");
    let (file, outcome) = recorded(&application);
    let again = application.folder().join("again.mcap");
    let path = again.to_str().expect("a path of this test");
    let finished = replay(
        &application,
        &file,
        &["--component", "recorder", "--output", path],
    );
    assert_eq!(finished.code, Some(0), "{finished}");
    let topics = messages(&again);
    let logs = topics["/events"]
        .iter()
        .filter(|it| it.value["component"] == "recorder");
    let logs = logs.filter_map(|it| Some(it.value["message"].as_str()?.to_owned()));
    let before = outcome.logs("recorder");
    assert!(before.len() > 100);
    assert_eq!(logs.collect::<Vec<_>>(), before);
}

/// A recording of one datum at `/counter/output`, of a type that was another one then.
fn of_another_layout(path: &Path) {
    let layout = Layout::new(&DataType {
        name: "Sample".to_owned(),
        size: 8,
        layout_hash: 1,
        fields: vec![Field {
            path: "number".to_owned(),
            unit: String::new(),
            offset: 0,
            scalar: Scalar::U64,
            count: 1,
        }],
    });
    let mut writer = RecordingWriter::create(path, &[]).expect("a file");
    let port = writer.add_port("counter", "output", "output", &layout);
    let port = port.expect("a channel");
    writer
        .write(port, 0, 0, b"{\"number\": 1}")
        .expect("a message");
    writer.finish().expect("the file's end");
}

#[test]
fn says_what_does_not_fit() {
    let application = counting();
    let (file, _) = recorded(&application);
    let no_recording = application.profile();
    let foreign = application.folder().join("foreign.mcap");
    of_another_layout(&foreign);
    let stranger = Application::new().with(&Member::new("stranger", "counter"));
    let partial = Application::new().with(&Member::new("culprit", "counter"));
    let (without_port, _) = recorded(&partial);
    let missing = Path::new("/nonexistent.mcap");
    for (application, file, component, code, words) in [
        (&application, missing, "", 2, &["cannot be read"][..]),
        (
            &application,
            &no_recording,
            "",
            2,
            &["is no MCAP file", "application.xml"],
        ),
        (
            &application,
            &foreign,
            "",
            4,
            &["another layout of 'Sample'", "libraries of that time"],
        ),
        (
            &stranger,
            &file,
            "",
            4,
            &["no data of any port", "belong together"],
        ),
        (
            &application,
            &file,
            "nobody",
            4,
            &["no component 'nobody'", "counter, culprit, recorder"],
        ),
        (
            &application,
            &without_port,
            "recorder",
            4,
            &["counter.output", "record that port"],
        ),
    ] {
        let arguments = ["--component", component];
        let arguments = if component.is_empty() {
            &[][..]
        } else {
            &arguments
        };
        let finished = replay(application, file, arguments);
        assert_eq!(finished.code, Some(code), "{finished}");
        for word in words {
            assert!(finished.stderr.contains(word), "'{word}': {finished}");
        }
    }
}
