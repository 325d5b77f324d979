//! Files that cannot be run: a clear error with its place, the exit code of its kind, nothing
//! started.

use std::fs::File;
use std::io::{BufWriter, Write as _};

use tests::{Application, Member};

const FILE: i32 = 2;
const PROFILE: i32 = 1;

/// Runs `content` as an application.
#[track_caller]
fn refused(content: &[u8], words: &[&str]) {
    let application = Application::new();
    let file = application.write("bad.xml", content);
    application.run_file(&file, &[]).was_refused(PROFILE, words);
}

#[test]
fn malformed() {
    refused(
        b"<package_profile><name>a</name",
        &["bad.xml:1:", "without its `>`"],
    );
    refused(
        b"<package_profile>\n<name>a</nom>\n</package_profile>",
        &["bad.xml:2:", "</name>"],
    );
    refused(b"", &["bad.xml:1:1", "holds no element"]);
    refused(&[0xff, 0xfe, 0x00, 0x01, 0x02], &["bad.xml"]);
}

#[test]
fn half_written() {
    let application = Application::new().with(&Member::new("counter", "counter"));
    let whole = std::fs::read(application.profile()).expect("the profile was written");
    // Without the last characters of the closing tag, and half of it.
    for length in [whole.len() - 3, whole.len() / 2] {
        let file = application.write("half.xml", &whole[..length]);
        let outcome = application.run_file(&file, &[]);
        outcome.was_refused(PROFILE, &["half.xml"]);
    }
}

#[test]
fn a_wrong_root() {
    refused(b"<robot/>", &["bad.xml:1:", "robot"]);
    let application = Application::new().with(&Member::new("counter", "counter"));
    let component = application.folder().join("counter.xml");
    let outcome = application.run_file(&component, &[]);
    outcome.was_refused(PROFILE, &["counter.xml", "component_profile"]);
}

#[test]
fn a_million_deep() {
    let mut text = b"<package_profile>".to_vec();
    for _ in 0..1_000_000 {
        text.extend_from_slice(b"<a>");
    }
    refused(&text, &["bad.xml", "more than 128 elements in each other"]);
}

#[test]
fn a_hundred_megabytes() {
    let application = Application::new();
    let path = application.folder().join("huge.xml");
    let mut file = BufWriter::new(File::create(&path).expect("a huge file"));
    file.write_all(b"<package_profile>").expect("room for it");
    for _ in 0..100_000 {
        // A thousand characters each.
        file.write_all(&[b' '; 1000]).expect("room for it");
    }
    file.flush().expect("room for it");
    let outcome = application.run_file(&path, &[]);
    outcome.was_refused(PROFILE, &["huge.xml"]);
}

#[test]
fn a_file_that_is_not_there() {
    let application = Application::new();
    let path = application.folder().join("nowhere.xml");
    let outcome = application.run_file(&path, &[]);
    outcome.was_refused(FILE, &["nowhere.xml", "cannot be read"]);
}

#[test]
fn outputs_that_cannot_be_written() {
    let application = Application::new().with(&Member::new("counter", "counter"));
    let nowhere = application.folder().join("nowhere/events.jsonl");
    let nowhere = nowhere.to_str().expect("temporary paths are text");
    let outcome = application.run(&["--clock", "simulated", "--for", "1s", "--picture", nowhere]);
    // Without a world there is no drive to draw.
    assert_eq!(outcome.finished().code, Some(0), "{}", outcome.finished());
    let application = Application::new().with(&Member::new("counter", "counter"));
    std::fs::create_dir(application.folder().join("events.jsonl")).expect("a folder in the way");
    let finished = application
        .start(&["--clock", "simulated", "--for", "1s"])
        .wait(std::time::Duration::from_secs(100));
    assert_eq!(finished.code, Some(FILE), "{finished}");
    assert!(
        finished.stderr.contains("events.jsonl cannot be written"),
        "{finished}"
    );
}

#[test]
fn two_components_of_one_name() {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("counter", "counter"))
        .simulate("1s")
        .was_refused(PROFILE, &["counter", "application.xml:4:"]);
}

#[test]
fn a_profile_that_is_not_there() {
    let application = Application::new().with(&Member::new("counter", "counter"));
    std::fs::remove_file(application.folder().join("counter.xml")).expect("it was there");
    application
        .simulate("1s")
        .was_refused(PROFILE, &["counter.xml", "application.xml:3:"]);
}

#[test]
fn a_reference_outside_the_search_path() {
    let outside = Application::new().with(&Member::new("counter", "counter"));
    let folder = outside.folder().file_name().expect("a folder has a name");
    let reference = format!("../{}/counter.xml", folder.to_string_lossy());
    Application::new()
        .with_reference("counter", &reference)
        .simulate("1s")
        .was_refused(PROFILE, &[&reference, "application.xml:3:"]);
}

#[test]
fn ports_that_do_not_fit_each_other() {
    let application = || {
        Application::new()
            .with(&Member::new("counter", "counter"))
            .with(&Member::new("recorder", "recorder"))
            .with(&Member::new("listener", "listener"))
    };
    for (kind, source, target, words) in [
        ("data", "counter.output", "counter.output", "output"),
        ("data", "recorder.input", "counter.output", "input"),
        ("event", "counter.output", "listener.news", "event"),
        ("data", "counter.output", "listener.news", "event"),
        ("data", "counter.outputs", "recorder.input", "outputs"),
        ("data", "center.output", "recorder.input", "center"),
    ] {
        let outcome = application().connect(kind, source, target).simulate("1s");
        outcome.was_refused(PROFILE, &["application.xml:", words]);
    }
}

/// Everything that is wrong is said at once.
#[test]
fn all_problems_are_listed() {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder").kind("sometimes"))
        .connect("data", "counter.outputs", "recorder.input")
        .with_reference("ghost", "ghost.xml")
        .simulate("1s")
        .was_refused(PROFILE, &["outputs", "sometimes", "ghost.xml"]);
}
