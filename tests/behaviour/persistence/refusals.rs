//! What is not restored, and what is said of it; a robot whose disk refuses runs all the same.

use super::*;

/// A file as it was left, changed, with the checksum of the change.
fn rewrite(file: &PathBuf, change: impl FnOnce(&mut Record)) {
    let mut record = Record::decode(&std::fs::read(file).expect("a file")).expect("whole");
    change(&mut record);
    let mut bytes = Vec::new();
    record.encode(&mut bytes);
    std::fs::write(file, bytes).expect("it can be written");
}

#[test]
fn of_a_torn_newest_the_previous_is_used() {
    let application = counting();
    let [(newest, torn), (previous, _)] = run_and_kill(&application).try_into().expect("two files");
    let content = std::fs::read(&torn).expect("a file");
    std::fs::write(&torn, &content[..content.len() - 1]).expect("it can be torn");
    let outcome = application.run_really("500ms").ended_well();
    let expected = format!(
        "checkpoint {} is refused: it is torn: {} bytes of {}; the previous one is used",
        torn.display(),
        content.len() - 1,
        content.len()
    );
    assert_eq!(notices(&outcome), [expected]);
    let event = restored(&outcome).expect("the previous one is restored");
    assert_eq!(event["sequence"], previous.sequence);
    assert!(previous.sequence < newest.sequence);
    assert_eq!(numbers(&outcome).first(), Some(&(number(&previous) + 1)));
}

#[test]
fn what_is_foreign_is_refused_and_the_component_begins_anew() {
    let application = counting();
    for (change, reason) in [
        (
            (|it| it.origin.application = "another".to_owned()) as fn(&mut Record),
            "of application 'another', not 'application'",
        ),
        (
            |it| it.origin.component = "another".to_owned(),
            "of component 'another', not 'counter'",
        ),
        (
            |it| it.origin.library.checksum ^= 1,
            "of another build of library 'libcounter.so'",
        ),
        (
            |it| it.memory.push(0),
            "it has 17 bytes, the registered memory 16",
        ),
    ] {
        let files = run_and_kill(&application);
        for (_, file) in &files {
            rewrite(file, change);
        }
        let outcome = application.run_really("200ms").ended_well();
        began_anew(&outcome);
        let expected = files.iter().map(|(_, file)| {
            let file = file.display();
            format!("checkpoint {file} is refused: it is foreign: {reason}; 'counter' begins anew")
        });
        assert_eq!(notices(&outcome), expected.collect::<Vec<_>>());
        assert!(is_empty(&application), "they are gone with the run's own");
    }
}

#[test]
fn what_is_stale_is_refused() {
    let application = counting_by(&RULE.replace("'true'", "'true' max_age='1ms'"));
    run_and_kill(&application);
    let outcome = application.run_really("200ms").ended_well();
    began_anew(&outcome);
    let notices = notices(&outcome);
    assert_eq!(notices.len(), 2);
    let stale = |notice: &&str| notice.contains("is refused: it is stale: ");
    assert!(notices.iter().all(stale), "{notices:?}");
}

#[test]
fn a_second_container_leaves_the_state_of_the_first_alone() {
    let application = counting();
    let first = application.start(&[]);
    assert!(until(WRITTEN_LIMIT, || left(&application).len() == 2));
    let second = counting();
    let path = folder(&application);
    let base = path
        .parent()
        .expect("it lies in a folder")
        .display()
        .to_string();
    let arguments = ["--state-path", &base, "--fresh", "--for", "200ms"];
    let outcome = second.run(&arguments).ended_well();
    began_anew(&outcome);
    let expected = format!(
        "the state of 'application' is lost with the container: {} is in use by another container",
        path.display()
    );
    assert_eq!(notices(&outcome), [expected]);
    assert_eq!(left(&application).len(), 2, "they are the first one's");
    let _in_order = application.interrupt(first).ended_well();
    assert!(is_empty(&application));
}

#[test]
fn a_disk_that_refuses_does_not_keep_a_robot_from_running() {
    let application = counting();
    let file = application.write("no_folder", "");
    let path = file.display().to_string();
    let outcome = application
        .run(&["--state-path", &path, "--for", "200ms"])
        .ended_well();
    began_anew(&outcome);
    let notices = notices(&outcome);
    let expected = format!("the state of 'application' is lost with the container: {path}/");
    assert!(notices[0].starts_with(&expected), "{notices:?}");
}

/// While it runs: said once when it begins and once when it is over.
#[test]
fn a_disk_that_refuses_for_a_while_is_told_of() {
    let application = counting();
    let run = application.start(&[]);
    assert!(until(WRITTEN_LIMIT, || left(&application).len() == 2));
    let blocked = file(&application, "new");
    let events = || {
        let text = std::fs::read_to_string(application.folder().join("events.jsonl"));
        text.unwrap_or_default()
    };
    // Until it is there: the writer renames what it finds under this name.
    assert!(until(WRITTEN_LIMIT, || std::fs::create_dir(&blocked).is_ok()));
    let refused = || events().contains("the state of 'counter' cannot be written");
    assert!(until(WRITTEN_LIMIT, refused));
    std::fs::remove_dir(&blocked).expect("an empty folder");
    let again = || events().contains("the state of 'counter' is written again");
    assert!(until(WRITTEN_LIMIT, again));
    let outcome = application.interrupt(run).ended_well();
    assert_eq!(notices(&outcome).len(), 2);
}
