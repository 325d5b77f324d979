//! State that outlives the container: what a killed run has left the next one goes on from; what is
//! torn, foreign or stale is refused; a run that ends in order leaves nothing.

mod refusals;

use std::path::PathBuf;
use std::time::Duration;

use container::persistence::Record;
use rustix::process::Signal;
use serde_json::Value;
use tests::{Application, Member, Outcome, Watched, until};

/// A checkpoint is on the disk within a second; a busy machine gets more.
const WRITTEN_LIMIT: Duration = Duration::from_secs(60);

/// A process that was killed is gone at once.
const KILL_LIMIT: Duration = Duration::from_secs(30);

/// A counter's numbers outlive the container.
const RULE: &str = "<component name='counter'><resurrect><reset>true</reset>\
                    <backup persist='true'>10</backup></resurrect></component>";

/// A counter whose numbers are received, by these rules.
fn counting_by(rules: &str) -> Application {
    Application::new()
        .with(&Member::new("counter", "counter").property("remembers", "true"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .connect("data", "counter.output", "recorder.input")
        .rules(rules)
}

fn counting() -> Application {
    counting_by(RULE)
}

/// Where the harness lets a run look for state.
fn folder(application: &Application) -> PathBuf {
    application.folder().join("state/steadfast/application")
}

fn file(application: &Application, ending: &str) -> PathBuf {
    folder(application).join(format!("counter.{ending}"))
}

/// What is on the disk, newest first, with its file.
fn left(application: &Application) -> Vec<(Record, PathBuf)> {
    let files = ["a", "b"].map(|ending| file(application, ending));
    let read = |file: PathBuf| Some((Record::decode(&std::fs::read(&file).ok()?).ok()?, file));
    let mut records: Vec<_> = files.into_iter().filter_map(read).collect();
    records.sort_by_key(|(record, _)| std::cmp::Reverse(record.written));
    records
}

/// The last number that is in the memory of a counter.
fn number(record: &Record) -> u64 {
    let (number, _value) = record.memory.split_first_chunk().expect("a sample");
    u64::from_le_bytes(*number)
}

/// Runs it until it has written two checkpoints of its own, kills it, and says what is left.
fn run_and_kill(application: &Application) -> Vec<(Record, PathBuf)> {
    let before = left(application).first().map_or(0, |(it, _)| it.written);
    let run = application.start(&[]);
    let written = || {
        let left = left(application);
        left.len() == 2 && left.iter().all(|(it, _)| it.written > before)
    };
    assert!(until(WRITTEN_LIMIT, written), "nothing is written");
    kill(run);
    left(application)
}

fn kill(run: Watched) {
    run.signal(Signal::KILL);
    let finished = run.wait(KILL_LIMIT);
    assert_eq!(finished.code, None, "{finished}");
}

/// All numbers that the recorder got.
fn numbers(outcome: &Outcome) -> Vec<u64> {
    let logs = outcome.logs("recorder");
    let got = logs.iter().filter_map(|line| line.strip_prefix("got "));
    got.flat_map(|line| line.split(' ').filter_map(|it| it.split('=').next()))
        .map(|it| it.parse().expect("a number"))
        .collect()
}

fn notices(outcome: &Outcome) -> Vec<&str> {
    let events = outcome.all_events().iter();
    let notices = events.filter(|event| event["event"] == "notice");
    notices
        .filter_map(|event| event["message"].as_str())
        .collect()
}

fn restored(outcome: &Outcome) -> Option<&Value> {
    outcome
        .events("checkpoint_restored", "counter")
        .first()
        .copied()
}

/// Nothing was restored: the first number is the first.
fn began_anew(outcome: &Outcome) {
    assert_eq!(restored(outcome), None);
    assert_eq!(numbers(outcome).first(), Some(&1));
    assert_eq!(outcome.component("counter")["incarnation"], 1);
}

fn is_empty(application: &Application) -> bool {
    let entries = std::fs::read_dir(folder(application)).expect("it was made");
    entries.count() == 0
}

#[test]
fn a_killed_container_goes_on_where_its_checkpoint_was() {
    let application = counting();
    let mut last = 0;
    for incarnation in 1..=4 {
        let (newest, _) = run_and_kill(&application).remove(0);
        assert_eq!(newest.incarnation, incarnation);
        assert!(number(&newest) > last, "{} after {last}", number(&newest));
        last = number(&newest);
    }
    let (newest, _) = left(&application).remove(0);
    let outcome = application.run_really("500ms").ended_well();
    let event = restored(&outcome).expect("it is restored");
    assert_eq!(event["sequence"], newest.sequence);
    assert_eq!(event["incarnation"], 5);
    assert!(event["age_ms"].is_u64(), "{event}");
    assert_eq!(numbers(&outcome).first(), Some(&(number(&newest) + 1)));
    assert_eq!(outcome.component("counter")["incarnation"], 5);
    assert_eq!(outcome.component("counter")["faults"], 0);
    assert_eq!(outcome.component("recorder")["incarnation"], 1);
    // It has ended in order: nothing is left, and the next one begins anew.
    assert!(is_empty(&application));
    began_anew(&application.run_really("200ms").ended_well());
}

#[test]
fn fresh_begins_anew_and_removes_what_was_left() {
    let application = counting();
    let (newest, _) = run_and_kill(&application).remove(0);
    let run = application.start(&["--fresh"]);
    let anew = || {
        left(&application)
            .first()
            .is_some_and(|(it, _)| it.written < newest.written)
    };
    assert!(until(WRITTEN_LIMIT, anew), "what was left is there still");
    let outcome = application.interrupt(run).ended_well();
    began_anew(&outcome);
    assert!(is_empty(&application));
}

/// It is told by `--state-path` where state lies, and makes the folder for its user alone.
#[test]
fn state_lies_where_the_option_says() {
    use std::os::unix::fs::PermissionsExt as _;
    let application = counting();
    let elsewhere = application.folder().join("else/where");
    let path = elsewhere.display().to_string();
    let run = application.start(&["--state-path", &path]);
    let written = || elsewhere.join("application/counter.a").exists();
    assert!(until(WRITTEN_LIMIT, written));
    let metadata = std::fs::metadata(elsewhere.join("application")).expect("a folder");
    assert_eq!(metadata.permissions().mode() & 0o777, 0o700);
    let _in_order = application.interrupt(run).ended_well();
    assert!(!folder(&application).exists());
}

/// A component that dies before its first own checkpoint, or while it is initialised, goes on from the
/// inherited one by its recovery.
#[test]
fn an_early_crash_does_not_lose_it() {
    for place in ["at_cycle='1'", "callback='onInitialize'"] {
        let application = counting().injections(&format!(
            "<inject {place} component='counter' fault='segfault'/>"
        ));
        // Of the first run it is the state after its reset.
        let (newest, _) = run_and_kill(&application).remove(0);
        let outcome = application.run_really("500ms").ended_well();
        assert_eq!(outcome.faults("counter").len(), 1, "{place}");
        let note = format!("checkpoint {} restored", newest.sequence);
        let notes = outcome.notes();
        assert!(notes[0].ends_with(&note), "{place}: {notes:?}");
        let first = numbers(&outcome).first().copied();
        assert_eq!(first, Some(number(&newest) + 1), "{place}");
        let incarnation = newest.incarnation + 2;
        assert_eq!(
            outcome.component("counter")["incarnation"],
            incarnation,
            "{place}"
        );
    }
}

/// State that a component cannot go on from does not keep the robot from starting.
#[test]
fn a_component_that_cannot_recover_begins_anew() {
    for fault in ["fault='panic'", "fault='error_return' code='503'"] {
        let application = counting().injections(&format!(
            "<inject component='counter' callback='onRecover' {fault}/>"
        ));
        run_and_kill(&application);
        let outcome = application.run_really("500ms").ended_well();
        assert_eq!(outcome.faults("counter").len(), 1, "{fault}");
        assert_eq!(outcome.faults("counter")[0].1, "onRecover", "{fault}");
        assert_eq!(outcome.actions(), ["reset counter: done"], "{fault}");
        assert_eq!(numbers(&outcome).first(), Some(&1), "{fault}");
        assert_eq!(outcome.component("counter")["state"], "ACTIVE", "{fault}");
    }
}

/// In simulated time a run is the same every time, whatever is on the disk.
#[test]
fn simulated_time_leaves_the_disk_alone() {
    let application = counting();
    let outcome = application.simulate("100ms").ended_well();
    let expected = ["in simulated time no checkpoint outlives the container"];
    assert_eq!(notices(&outcome), expected);
    assert!(!folder(&application).exists());
}

#[test]
fn without_such_a_rule_nothing_is_written() {
    let application = counting_by(&RULE.replace("'true'", "'false'"));
    let _in_order = application.run_really("300ms").ended_well();
    assert!(!application.folder().join("state").exists());
}

/// The state of an application is the same whether it runs alone or with others.
#[test]
fn each_application_has_a_state_of_its_own() {
    let [one, other] = ["one", "other"].map(|name| {
        let application = counting();
        let text = std::fs::read_to_string(application.profile()).expect("it was written");
        let named = text.replace("<name>application</name>", &format!("<name>{name}</name>"));
        application.write("named.xml", named);
        let rules = format!("<fault_rules application='{name}'>{RULE}</fault_rules>");
        let rules = application.write("named_rules.xml", rules);
        (application, rules.display().to_string())
    });
    let files = [&one, &other].map(|(application, _)| application.folder().join("named.xml"));
    let rules = ["--rules", &one.1, "--rules", &other.1];
    let run = one.0.start_files(&files, &rules);
    let state = one.0.folder().join("state/steadfast");
    let written = |name: &str| state.join(name).join("counter.b").exists();
    assert!(until(WRITTEN_LIMIT, || written("one") && written("other")));
    kill(run);
    let arguments = ["--rules", &one.1, "--for", "200ms"];
    let outcome = one.0.run_file(&files[0], &arguments).ended_well();
    assert!(restored(&outcome).is_some());
    assert!(!written("one") && written("other"));
    let together = [&rules[..], &["--for", "200ms"]].concat();
    let outcome = one.0.run_together(&files, &together).ended_well();
    let restored = |name: &str| outcome.events("checkpoint_restored", name).len();
    assert_eq!((restored("one/counter"), restored("other/counter")), (0, 1));
}
