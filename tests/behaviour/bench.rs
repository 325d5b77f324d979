//! The studies of `steadfast bench` come to their end and say what they promise to say. Nothing here
//! looks at a time: how fast a machine is, is no behaviour.

use std::collections::BTreeSet;
use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use tests::{Watched, artifacts};

/// Many times what the quick study takes.
const LIMIT: Duration = Duration::from_secs(300);

fn numbers(value: &Value) -> bool {
    let is_number = |key: &str| value[key].as_f64().is_some_and(|it| it >= 0.0);
    ["p50", "p99", "p999", "max"].into_iter().all(is_number)
}

#[test]
fn recovery_is_measured_for_every_fault_and_handling() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("recovery.svg");
    let mut bench = Command::new(artifacts().join("steadfast"));
    bench
        .args(["bench", "recovery", "--quick", "--all", "--format", "json"])
        .arg("--picture")
        .arg(&picture)
        .env("TMPDIR", folder.path());
    let finished = Watched::spawn(&mut bench).wait(LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");

    let study: Value = serde_json::from_str(&finished.stdout).expect("one JSON object");
    let keys: BTreeSet<&str> = study
        .as_object()
        .expect("one")
        .keys()
        .map(String::as_str)
        .collect();
    assert_eq!(keys, BTreeSet::from(["machine", "floor", "rows"]));
    assert!(study["machine"]["cores"].as_u64().is_some_and(|it| it > 0));

    the_floor_is_complete(&study);
    the_rows_are_complete(&study);

    let picture = std::fs::read_to_string(&picture).expect("a picture");
    assert!(picture.starts_with("<svg") && picture.contains("load 10 %"));
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .expect("the folder")
        .collect();
    assert_eq!(left.len(), 1, "nothing is left but the picture: {left:?}");
}

fn the_floor_is_complete(study: &Value) {
    let floor = study["floor"].as_array().expect("a list");
    let names: BTreeSet<&str> = floor
        .iter()
        .filter_map(|row| row["name"].as_str())
        .collect();
    assert_eq!(
        names,
        BTreeSet::from(["death_notice", "dlopen", "process_wake", "signal", "trap"])
    );
    assert!(
        floor
            .iter()
            .all(|row| row["load_percent"] == 10 && numbers(&row["us"])),
        "{study:#}"
    );
}

fn the_rows_are_complete(study: &Value) {
    let rows = study["rows"].as_array().expect("a list");
    let faults = ["trap", "panic", "hang", "error_return", "out_of_range"];
    let guarded = faults.map(|fault| ("guarded", fault));
    let process = faults.map(|fault| ("process", fault));
    let killed = ("process", "host_killed");
    for (tier, fault) in guarded.into_iter().chain(process).chain([killed]) {
        for handling in [
            "reset",
            "reset_checkpoint",
            "secondary_cold",
            "secondary_loaded",
            "secondary_warm",
        ] {
            let of_it = |row: &&Value| {
                row["tier"] == tier && row["fault"] == fault && row["handling"] == handling
            };
            let row = rows.iter().find(of_it);
            let row = row.unwrap_or_else(|| panic!("{tier}, {fault}, {handling}: {study:#}"));
            assert_eq!(row["load_percent"], 10, "{row}");
            assert!(row["n"].as_u64().is_some_and(|n| n > 0), "{row}");
            for phase in ["detection_us", "decision_us", "handling_us", "total_us"] {
                assert!(numbers(&row[phase]), "{phase}: {row}");
            }
            assert_eq!(row["duplicated"], 0, "{row}");
            assert!(row["lost"].is_u64(), "{row}");
        }
    }
    let stops = rows
        .iter()
        .filter(|row| row["handling"] == "emergency_stop");
    assert!(stops.clone().count() > 0 && stops.clone().all(|row| row["lost"].is_null()));
}
