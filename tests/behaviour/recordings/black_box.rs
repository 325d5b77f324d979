//! The black box: a file around every fault.

use std::path::{Path, PathBuf};

use serde_json::Value;
use tests::{Application, Outcome};

use super::{counting, messages};

fn run(application: &Application, more: &[&str]) -> (Outcome, Vec<PathBuf>) {
    let folder = application.folder().join("faults");
    let path = folder.to_str().expect("a path of this test");
    let arguments = ["--black-box", path, "--black-box-before", "200ms"];
    let arguments = [&arguments[..], &["--black-box-after", "100ms"], more].concat();
    let outcome = application.run(&arguments).ended_well();
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .expect("the black box has its folder")
        .map(|entry| entry.expect("it can be listed").path())
        .collect();
    files.sort();
    (outcome, files)
}

fn name(path: &Path) -> &str {
    path.file_name().and_then(|it| it.to_str()).expect("a name")
}

#[test]
fn has_what_lies_around_a_fault_and_nothing_else() {
    let application = counting();
    let (outcome, files) = run(&application, &["--clock", "simulated", "--for", "1s"]);
    assert_eq!(
        files.iter().map(|it| name(it)).collect::<Vec<_>>(),
        ["blackbox-000001-culprit_panic.mcap"]
    );
    let verdict = outcome.verdicts()[0];
    let confirmed_ns = verdict["confirmed_ns"].as_u64().expect("a time");
    let topics = messages(&files[0]);
    let numbers = &topics["/counter/output"];
    let times: Vec<u64> = numbers.iter().map(|it| it.t_ns).collect();
    assert_eq!(times.first(), Some(&(confirmed_ns - 200_000_000)));
    assert_eq!(times.last(), Some(&(confirmed_ns + 100_000_000)));
    assert_eq!(times.len(), 31);
    let verdicts = &topics["/verdicts"];
    assert_eq!(
        verdicts.last().map(|it| &it.value["id"]),
        Some(&verdict["id"])
    );
    let level = |message: &recording::Message| -> Value {
        let status = message.value["status"].as_array().expect("a list");
        let culprit = status.iter().find(|it| it["name"] == "culprit");
        culprit.expect("it has a status")["level"].clone()
    };
    let levels: Vec<Value> = topics["/diagnostics"].iter().map(level).collect();
    assert!(levels.iter().any(|it| it == 2), "{levels:?}");
}

#[test]
fn never_loses_the_second_fault_of_a_burst() {
    // The first one comes at 300 ms, and its file ends at 400 ms.
    let application = counting().injections(
        "<inject at='350ms' component='recorder' fault='panic'/>\
         <inject at='900ms' component='recorder' fault='panic'/>",
    );
    let (outcome, files) = run(&application, &["--clock", "simulated", "--for", "2s"]);
    let ids = |path: &PathBuf| {
        let topics = messages(path);
        let ids = topics["/verdicts"].iter().map(|it| it.value["id"].as_u64());
        let mut ids: Vec<u64> = ids.map(|it| it.expect("a number")).collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    };
    let ids: Vec<Vec<u64>> = files.iter().map(ids).collect();
    // What becomes of the second one later is in the file of the third, too.
    assert!(
        ids.len() == 2 && ids[0] == [1, 2] && ids[1].contains(&3),
        "{ids:?}"
    );
    assert_eq!(
        outcome.summary()["recording"]["black_box"]
            .as_array()
            .map(Vec::len),
        Some(2)
    );
}

#[test]
fn works_in_real_time_and_for_hosted_components() {
    let application = counting().in_hosts();
    let (_, files) = run(&application, &["--for", "2s"]);
    let culprit = files.iter().find(|it| name(it).contains("culprit_panic"));
    let topics = messages(culprit.expect("its fault has a file"));
    assert!(topics["/counter/output"].len() > 10);
}

#[test]
fn leaves_nothing_where_nothing_failed() {
    let application = Application::new().with(&tests::Member::new("counter", "counter"));
    let (_, files) = run(&application, &["--clock", "simulated", "--for", "1s"]);
    assert_eq!(files, [""; 0].map(PathBuf::from));
}
