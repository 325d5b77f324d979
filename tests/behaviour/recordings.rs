//! Recordings: everything that happened is in the file, and the tools of others read it.

mod black_box;
mod ecosystem;
mod replay;

use std::collections::BTreeMap;
use std::path::Path;

use recording::{Message, read};
use rustix::process::Signal;
use serde_json::{Value, json};
use tests::{Application, Member};

/// A counter whose numbers are received, and another one that panics once.
pub(crate) fn counting() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter").priority(3))
        .with(&Member::new("culprit", "counter").priority(2))
        .with(&Member::new("recorder", "recorder").priority(1))
        .connect("data", "counter.output", "recorder.input")
        .injections("<inject at='300ms' component='culprit' fault='panic'/>")
}

/// All messages of a whole file by topic.
pub(crate) fn messages(path: &Path) -> BTreeMap<String, Vec<Message>> {
    let mut reader = read(path).expect("the file can be opened");
    let mut topics = BTreeMap::<String, Vec<Message>>::new();
    for message in reader.by_ref() {
        let message = message.expect("the file is whole");
        let topic = message.topic().to_owned();
        topics.entry(topic).or_default().push(message);
    }
    assert!(!reader.was_cut());
    topics
}

fn values(messages: &[Message]) -> Vec<Value> {
    messages
        .iter()
        .map(|message| message.value.clone())
        .collect()
}

#[test]
fn hold_every_datum_event_and_state() {
    let application = counting().injections(
        "<inject at='500ms' component='counter' port='output' fault='not_a_number' for='20ms'/>",
    );
    let file = application.folder().join("run.mcap");
    let path = file.to_str().expect("a path of this test");
    let outcome = application
        .run(&["--clock", "simulated", "--for", "1s", "--record", path])
        .ended_well();
    let topics = messages(&file);

    let numbers = topics["/counter/output"].iter();
    let numbers: Vec<u64> = numbers
        .map(|it| it.value["number"].as_u64().expect("a number"))
        .collect();
    assert_eq!(numbers, (1..=100).collect::<Vec<_>>());
    // The injected datum is recorded as it was sent: JSON has no number for it.
    let odd = topics["/counter/output"]
        .iter()
        .filter(|it| it.value["value"] == "NaN");
    assert_eq!(
        odd.map(|it| it.t_ns).collect::<Vec<_>>(),
        [500_000_000, 510_000_000]
    );

    assert_eq!(values(&topics["/events"]), outcome.all_events());
    let states = topics["/states"]
        .iter()
        .filter(|it| it.value["component"] == "culprit");
    let states: Vec<&Value> = states.map(|it| &it.value["to"]).collect();
    assert_eq!(states, outcome.states("culprit").iter().collect::<Vec<_>>());
    let verdicts = topics["/verdicts"].last().expect("there was a fault");
    assert_eq!(verdicts.value["component"], "culprit");

    let summary = &outcome.summary()["recording"];
    let all: usize = topics.values().map(Vec::len).sum();
    assert_eq!(summary["messages"], json!(all));
    assert_eq!(summary["dropped"], 0);
}

#[test]
fn say_what_they_do_not_hold() {
    let application =
        Application::new().with(&Member::new("counter", "counter").property("burst", "20000"));
    let file = application.folder().join("run.mcap");
    let path = file.to_str().expect("a path of this test");
    let outcome = application
        .interrupt_when(&["--record", path], Signal::INT, |events| {
            events.contains("the recording is not complete")
        })
        .ended_well();
    let topics = messages(&file);
    let summary = &outcome.summary()["recording"];
    let dropped = summary["dropped"].as_u64().expect("a number");
    assert!(dropped > 0);
    assert_eq!(
        summary["dropped_by_topic"],
        json!({"/counter/output": dropped})
    );
    let recorded = topics["/counter/output"].len() as u64;
    // All cycles were whole, and some came after the summary was drawn.
    assert_eq!((recorded + dropped) % 20_000, 0);
    assert!(recorded + dropped >= outcome.cycles("counter") * 20_000);
    let said = format!("{dropped} data were not recorded");
    assert!(
        outcome.raw_events().contains(&said),
        "{}",
        outcome.raw_events()
    );
    let last = topics["/diagnostics"].last().expect("diagnostics");
    let status = last.value["status"].as_array().expect("a list").last();
    let status = status.expect("the recording's own");
    assert_eq!(
        (&status["name"], &status["level"]),
        (&json!("recording"), &json!(1))
    );
}

#[test]
fn leave_out_what_is_longer_than_wanted() {
    let application = counting();
    let file = application.folder().join("run.mcap");
    let path = file.to_str().expect("a path of this test");
    let arguments = ["--clock", "simulated", "--for", "1s", "--record", path];
    let outcome = application
        .run(&[&arguments[..], &["--record-max-bytes-per-datum", "15"]].concat())
        .ended_well();
    assert!(!messages(&file).contains_key("/counter/output"));
    assert!(
        outcome
            .raw_events()
            .contains("not recorded, because a datum is longer")
    );
}

#[test]
fn are_the_same_byte_for_byte_in_the_same_simulated_run() {
    let record = |name: &str| {
        let application = counting();
        let file = application.folder().join(name);
        let path = file.to_str().expect("a path of this test");
        let _outcome = application
            .run(&["--clock", "simulated", "--for", "2s", "--record", path])
            .ended_well();
        std::fs::read(&file).expect("the recording")
    };
    assert!(record("one.mcap") == record("two.mcap"));
}

#[test]
fn of_a_container_that_is_killed_can_be_read_up_to_there() {
    let application = counting();
    let file = application.folder().join("run.mcap");
    let path = file.to_str().expect("a path of this test");
    let run = application.start(&["--record", path]);
    // Two chunks are in the file.
    assert!(tests::until(std::time::Duration::from_secs(60), || {
        let mut reader = read(&file).into_iter().flatten();
        reader.any(|it| it.is_ok_and(|it| it.t_ns > 2_000_000_000))
    }));
    run.signal(Signal::KILL);
    let _killed = run.wait(std::time::Duration::from_secs(30));
    let mut reader = read(&file).expect("the file can be opened");
    let topics: Vec<String> = reader
        .by_ref()
        .map(|it| it.expect("whole up to its end").topic().to_owned())
        .collect();
    assert!(reader.was_cut());
    assert!(topics.iter().filter(|it| *it == "/counter/output").count() > 100);
}

#[test]
fn that_cannot_be_written_stop_the_start_and_say_so() {
    let application = counting();
    let outcome = application.run(&["--record", "/nonexistent/run.mcap"]);
    outcome.was_refused(2, &["/nonexistent/run.mcap", "cannot be written"]);
}
