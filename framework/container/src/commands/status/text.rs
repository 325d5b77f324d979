//! The status as a person reads it.

use std::fmt::Write as _;

use serde_json::Value;

use crate::commands::words::{number, table, word};

const HEADINGS: [&str; 10] = [
    "COMPONENT",
    "LEVEL",
    "STATE",
    "TIER",
    "EXECUTOR",
    "RATE/Hz",
    "LOAD/%",
    "OVERRUNS",
    "INC",
    "STANDBY",
];

/// All of it.
pub(super) fn of(status: &Value) -> String {
    let mut text = String::new();
    let applications = status["applications"].as_object().into_iter().flatten();
    for (name, state) in applications {
        let _infallible = writeln!(text, "{name}: {}", word(state));
    }
    let container = &status["container"];
    let _infallible = writeln!(
        text,
        "{} s of {} time; process {}, up {} s, {} threads, {} restarts",
        number(&status["time_s"], 1),
        word(&status["clock"]),
        word(&container["process"]),
        number(&container["uptime_s"], 1),
        word(&container["threads"]),
        word(&container["restarts"]),
    );
    let _infallible = writeln!(
        text,
        "dropped: {} data of ports, {} events, {} symptoms",
        word(&container["port_data_dropped"]),
        word(&container["events_lost"]),
        word(&container["symptoms_dropped"]),
    );
    if status["emergency_stop"] == true {
        text += "EMERGENCY STOP latched; 'steadfast fault clear --all' ends it\n";
    }
    text += &trees(&status["trees"]);
    text += "\n";
    text + &components(&status["components"])
}

/// One line for each behaviour tree: what it does.
pub fn trees(trees: &Value) -> String {
    let mut text = String::new();
    for (name, tree) in trees.as_object().into_iter().flatten() {
        let doing = tree["doing"].as_array().into_iter().flatten();
        let doing: Vec<String> = doing.map(|path| short(&word(path))).collect();
        let _infallible = writeln!(
            text,
            "tree {}: {}{}{}",
            word(&Value::from(name.as_str())),
            word(&tree["state"]),
            if doing.is_empty() { "" } else { ", at " },
            doing.join(", "),
        );
    }
    text
}

/// The end of a path, which tells most.
fn short(path: &str) -> String {
    const NAMES: usize = 3;
    let names: Vec<&str> = path.split('/').collect();
    match names.len() > NAMES {
        true => format!("…/{}", names[names.len() - NAMES..].join("/")),
        false => path.to_owned(),
    }
}

/// The table of components, with the last fault of each below it.
pub fn components(components: &Value) -> String {
    let components = components.as_object();
    let mut rows = vec![HEADINGS.map(str::to_owned)];
    let mut faults = String::new();
    for (name, one) in components.into_iter().flatten() {
        rows.push([
            word(&Value::from(name.as_str())),
            word(&one["level"]),
            word(&one["state"]),
            word(&one["tier"]),
            executor(one),
            number(&one["rate_hz"], 1),
            number(&one["load_percent"], 1),
            word(&one["overruns"]),
            word(&one["incarnation"]),
            standbys(&one["standbys"]),
        ]);
        let fault = word(&one["last_fault"]);
        if !fault.is_empty() {
            let _infallible = writeln!(faults, "last fault of {name}: {fault}");
        }
    }
    table(&rows, |column| (5..=8).contains(&column)) + &faults
}

fn executor(one: &Value) -> String {
    let period = one["period_ms"].as_f64();
    let kind = word(&one["execution"]);
    period.map_or_else(|| kind.clone(), |period| format!("{kind} {period} ms"))
}

/// `warm obstacle_avoidance_simple`, in brackets if it is not there.
fn standbys(standbys: &Value) -> String {
    let standbys = standbys.as_array().into_iter().flatten();
    let words = standbys.map(|one| {
        let words = format!("{} {}", word(&one["preload"]), word(&one["of"]));
        match one["ready"] == true {
            true => words,
            false => format!("({words})"),
        }
    });
    words.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_status_is_readable_whatever_is_missing() {
        let status = json!({
            "applications": {"patrol": "DEGRADED"}, "clock": "real", "time_s": 12.34,
            "emergency_stop": true,
            "trees": {"mission": {"state": "running", "doing": ["M/a/b/c/Sleep", "M/Wait"]},
                "rescue": {"state": "waiting", "doing": []}},
            "container": {"process": 7, "uptime_s": 12.0, "threads": 9, "restarts": 0,
                "port_data_dropped": 3, "events_lost": 0, "symptoms_dropped": 0},
            "components": {
                "camera": {"level": "WARN", "state": "ACTIVE", "tier": "process",
                    "execution": "periodic", "period_ms": 40.0, "rate_hz": 24.96,
                    "load_percent": 8.04, "overruns": 2, "incarnation": 3,
                    "last_fault": "segfault in onExecute: \u{1b}[2J",
                    "standbys": [{"of": "spare", "preload": "warm", "ready": true},
                        {"of": "other", "preload": "loaded", "ready": false}]},
                "odd": 3,
            },
        });
        assert_eq!(
            of(&status),
            "patrol: DEGRADED\n\
             12.3 s of real time; process 7, up 12.0 s, 9 threads, 0 restarts\n\
             dropped: 3 data of ports, 0 events, 0 symptoms\n\
             EMERGENCY STOP latched; 'steadfast fault clear --all' ends it\n\
             tree mission: running, at …/b/c/Sleep, M/Wait\n\
             tree rescue: waiting\n\n\
             COMPONENT  LEVEL  STATE   TIER     EXECUTOR        RATE/Hz  LOAD/%  OVERRUNS  INC  STANDBY\n\
             camera     WARN   ACTIVE  process  periodic 40 ms     25.0     8.0         2    3  warm spare, (loaded other)\n\
             odd\n\
             last fault of camera: segfault in onExecute: \u{FFFD}[2J\n"
        );
        assert!(of(&Value::Null).contains("COMPONENT"));
    }
}
