//! `steadfast bench overhead`, with few and short runs: what it says, not how fast the machine is.

use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use tests::{Watched, artifacts};

/// A dozen short runs on a busy machine.
const LIMIT: Duration = Duration::from_secs(240);

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("a number: {value}"))
}

fn ascending(times: &Value) -> bool {
    let times = ["p50", "p99", "p999", "max"].map(|it| number(&times[it]));
    times[0] > 0.0 && times.is_sorted()
}

#[test]
fn chains_memory_and_start_are_measured_on_real_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("overhead.svg");
    let mut command = Command::new(artifacts().join("steadfast"));
    command
        .args(["bench", "overhead", "--quick", "--format", "json"])
        .arg("--picture")
        .arg(&picture);
    let finished = Watched::spawn(&mut command).wait(LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");
    let result: Value = serde_json::from_str(&finished.stdout).expect("one JSON object");
    assert!(result["machine"]["cores"].as_u64() > Some(0), "{result}");

    let chains = result["chains"].as_array().expect("chains");
    let rows: Vec<(u64, &str, &str)> = chains
        .iter()
        .map(|row| {
            let text = |key: &str| row[key].as_str().expect("a text");
            let components = row["components"].as_u64().expect("a number");
            (components, text("tier"), text("rules"))
        })
        .collect();
    let expected = [
        (0, "guarded", "none"),
        (1, "guarded", "none"),
        (1, "guarded", "all"),
        (1, "process", "none"),
        (1, "process", "all"),
        (4, "guarded", "none"),
        (4, "guarded", "all"),
        (4, "process", "none"),
        (4, "process", "all"),
    ];
    assert_eq!(rows, expected);
    for row in chains {
        assert_eq!(row["cycle_ns"]["n"], 200, "{row}");
        assert!(number(&row["latency_us"]["n"]) > 0.0, "{row}");
        assert!(
            ascending(&row["cycle_ns"]) && ascending(&row["latency_us"]),
            "{row}"
        );
        assert!(number(&row["throughput_hz"]) > 0.0, "{row}");
    }

    memory_is_measured(&result);
    start_is_measured(&result);

    let drawn = std::fs::read_to_string(&picture).expect("a picture");
    assert!(drawn.starts_with("<svg") && drawn.ends_with("</svg>\n"));
    assert!(drawn.contains("guarded, all rules") && drawn.contains("process, all rules"));
}

fn memory_is_measured(result: &Value) {
    let memory = result["memory"].as_array().expect("memory");
    for (row, (rules, copies)) in memory.iter().zip([
        ("none", 2.0),
        ("all", 2.0),
        ("standby loaded", 3.0),
        ("standby warm", 3.0),
    ]) {
        assert_eq!(row["rules"], rules);
        assert_eq!(number(&row["threads"]), 1.0, "{row}");
        assert_eq!(
            number(&row["open_files"]),
            copies,
            "a file for each copy: {row}"
        );
        assert!(number(&row["library_copies_kib"]) > 0.0, "{row}");
    }
    assert_eq!(memory.len(), 8);
    for row in memory {
        let is_hosted = row["tier"] == "process";
        assert_eq!(number(&row["processes"]) >= 1.0, is_hosted, "{row}");
        assert!(number(&row["rss_kib"]) > 0.0, "{row}");
    }
}

fn start_is_measured(result: &Value) {
    let starts = result["start"].as_array().expect("starts");
    for (start, tier) in starts.iter().zip(["guarded", "process"]) {
        assert_eq!(
            (&start["components"], &start["tier"]),
            (&4.into(), &tier.into())
        );
        let phases =
            ["read_ms", "load_ms", "bring_up_ms", "launch_ms"].map(|it| number(&start[it]));
        assert!(phases.iter().all(|phase| *phase > 0.0), "{start}");
        let sum: f64 = phases.iter().sum();
        assert!((number(&start["ms"]) - sum).abs() < 1e-6, "{start}");
    }
    assert_eq!(starts.len(), 2);
}
