//! What happened in a run, in one paragraph.

use std::collections::BTreeMap;

use super::amounts::{at, count, list, number, seconds};
use super::model::{Run, Summary};

/// Kinds and actions that are counted one by one; what is rarer is summed up.
const MOST_KINDS: usize = 6;

/// What happened.
pub(super) fn paragraph(run: &Run) -> String {
    let sentences = [
        beginning(run),
        injected(run),
        faults(run),
        done(run),
        restarts(run),
        run.summary.as_ref().map(ending).unwrap_or_default(),
        lost(run),
    ];
    let sentences = sentences.into_iter().filter(|it| !it.is_empty());
    sentences.collect::<Vec<String>>().join(" ")
}

fn beginning(run: &Run) -> String {
    let (from_ns, to_ns) = run.span_ns.unwrap_or_default();
    let time = match run.clock.as_str() {
        "" => String::new(),
        clock => format!(" of {clock} time"),
    };
    let seed = match (run.seed, run.clock.as_str()) {
        (Some(seed), "simulated") => format!(" (seed {seed})"),
        _ => String::new(),
    };
    let ended = match run.ended_by.as_deref() {
        Some(reason) => format!("It ended: {}.", reason.replace('_', " ")),
        None => "How it ended is not on record: the run was cut off, or still goes on.".to_owned(),
    };
    format!(
        "{} ran with {} for {}{time}{seed}. {ended}",
        name(run),
        count(run.states.len() - run.tree_rows, "component"),
        at(to_ns.saturating_sub(from_ns)),
    )
}

/// Its name, or that it has none.
pub(super) fn name(run: &Run) -> &str {
    match run.application.as_str() {
        "" => "An application",
        name => name,
    }
}

fn injected(run: &Run) -> String {
    let begins = run.incidents.iter();
    let begins = begins.filter(|it| it.kind == "injection" && it.text.ends_with("begins"));
    let first = begins.clone().next();
    match (begins.count(), first) {
        (0, _) | (_, None) => String::new(),
        (1, Some(first)) => {
            let what = first.text.trim_end_matches(" begins");
            format!(
                "One fault was made on purpose: {what} at {}.",
                at(first.t_ns)
            )
        }
        (number, Some(first)) => format!(
            "{number} times a fault was made on purpose, first {} at {}.",
            first.text.trim_end_matches(" begins"),
            at(first.t_ns)
        ),
    }
}

fn faults(run: &Run) -> String {
    if run.faults.is_empty() {
        return "No fault was confirmed.".to_owned();
    }
    let mut places: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for fault in run.faults.values() {
        let verdict = &fault.verdict;
        *places
            .entry((&verdict.kind, &verdict.component))
            .or_default() += 1;
    }
    let names = places.iter().map(|((kind, component), times)| {
        let kind = kind.replace('_', " ");
        match times {
            1 => format!("{kind} of {component}"),
            _ => format!("{times} times {kind} of {component}"),
        }
    });
    let consequences = run.faults.values();
    let consequences = consequences
        .filter(|it| it.verdict.cause.is_object())
        .count();
    let because = match consequences {
        0 => String::new(),
        _ => format!("; {consequences} of them followed from another one"),
    };
    let verb = if run.faults.len() == 1 { "was" } else { "were" };
    let many = count(run.faults.len(), "fault");
    format!(
        "{many} {verb} confirmed: {}{because}.",
        some(names.collect())
    )
}

fn done(run: &Run) -> String {
    let mut actions: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for action in run.faults.values().flat_map(|it| &it.verdict.actions) {
        *actions
            .entry((&action.action, &action.outcome))
            .or_default() += 1;
    }
    if actions.is_empty() {
        return String::new();
    }
    let names = actions.iter().map(|((action, outcome), times)| {
        let outcome = match *outcome {
            "done" => String::new(),
            other => format!(" ({})", other.replace('_', " ")),
        };
        match times {
            1 => format!("{action}{outcome}"),
            _ => format!("{times} times {action}{outcome}"),
        }
    });
    format!("What was done: {}.", some(names.collect()))
}

/// The first few, and how many more there are.
fn some(mut parts: Vec<String>) -> String {
    let more = parts.len().saturating_sub(MOST_KINDS);
    if more > 1 {
        parts.truncate(MOST_KINDS);
        parts.push(format!("{more} more"));
    }
    list(&parts)
}

fn restarts(run: &Run) -> String {
    let restarts = run.incidents.iter();
    match restarts
        .filter(|it| it.kind == "container_restarted")
        .count()
    {
        0 => String::new(),
        1 => "The container itself died once and was restarted.".to_owned(),
        times => format!("The container itself died {times} times and was restarted."),
    }
}

fn ending(summary: &Summary) -> String {
    let states = summary.applications.iter();
    let states = states.map(|(name, it)| format!("{name} was {}", it.state));
    let idle = summary
        .components
        .iter()
        .filter(|(_, it)| it.state != "ACTIVE");
    let idle: Vec<String> = idle
        .map(|(name, it)| format!("{name} {}", it.state))
        .collect();
    let idle = match idle.is_empty() {
        true => String::new(),
        false => format!(" ({})", some(idle)),
    };
    let mut text = format!("In the end {}{idle}.", list(&states.collect::<Vec<_>>()));
    if let Some(robot) = &summary.robot {
        text += &match (robot.reached, robot.time_s) {
            (true, Some(time_s)) => format!(" The robot reached its target after {time_s:.2} s"),
            _ => format!(
                " The robot did not reach its target, {} m were to go",
                number(robot.distance_to_target_m)
            ),
        };
        text += &format!(
            "; its way was {:.2} m, with {} and {:.2} m of clearance at least.",
            robot.path_length_m,
            count(
                usize::try_from(robot.collisions).unwrap_or(usize::MAX),
                "collision"
            ),
            robot.least_clearance_m
        );
    }
    text
}

fn lost(run: &Run) -> String {
    let mut text = String::new();
    if run.events_lost > 0 {
        text = format!(
            "{} events were lost: the record is not complete.",
            run.events_lost
        );
    }
    if run.verdicts_left_out > 0 {
        let last = run
            .faults
            .values()
            .last()
            .map_or(0, |it| it.verdict.confirmed_ns);
        text += &format!(
            " A report has room for {} faults of a run: {} verdicts of later ones, behind {:.0} s, \
             stand in the event file only.",
            run.faults.len(),
            run.verdicts_left_out,
            seconds(last)
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::commands::report::gathering::Gathering;

    fn told(events: &[serde_json::Value], summary: serde_json::Value) -> String {
        let mut gathering = Gathering::new("events.jsonl".to_owned());
        for event in events {
            gathering.learn(event).expect("an event");
        }
        let mut run = gathering.finish();
        run.summary = serde_json::from_value(summary).expect("a summary");
        paragraph(&run)
    }

    #[test]
    fn a_run_is_told() {
        let verdict = |id: u64, action: &str, outcome: &str| {
            json!({"t_ns": 3_000_000_000u64, "event": "verdict", "id": id, "kind": "out_of_range",
                   "component": "left_sonar", "cause": "root",
                   "actions": [{"action": action, "outcome": outcome}]})
        };
        let events = [
            json!({"t_ns": 0, "event": "run_started", "application": "patrol", "clock": "simulated",
                   "seed": 7}),
            json!({"t_ns": 0, "event": "state", "component": "left_sonar", "to": "ACTIVE"}),
            json!({"t_ns": 2_000_000_000u64, "event": "injection", "fault": "unplug_sonar",
                   "change": "begins"}),
            verdict(1, "reset left_sonar", "done"),
            verdict(2, "reset left_sonar", "done"),
            verdict(3, "stop left_sonar", "failed"),
            json!({"t_ns": 9_000_000_000u64, "event": "run_stopped", "reason": "duration_elapsed",
                   "events_lost": 4}),
        ];
        let summary = json!({
            "applications": {"patrol": {"state": "DEGRADED"}},
            "components": {"left_sonar": {"state": "INACTIVE"}},
            "robot": {"reached": true, "time_s": 8.5, "collisions": 1, "path_length_m": 4.0,
                      "least_clearance_m": 0.125},
        });
        assert_eq!(
            told(&events, summary),
            "patrol ran with 1 component for 9.000 s of simulated time (seed 7). It ended: duration \
             elapsed. One fault was made on purpose: unplug_sonar at 2.000 s. 3 faults were \
             confirmed: 3 times out of range of left_sonar. What was done: 2 times reset left_sonar \
             and stop left_sonar (failed). In the end patrol was DEGRADED (left_sonar INACTIVE). The \
             robot reached its target after 8.50 s; its way was 4.00 m, with 1 collision and 0.12 m \
             of clearance at least. 4 events were lost: the record is not complete."
        );
    }

    #[test]
    fn a_run_that_was_cut_off_is_told_as_such() {
        let text = told(
            &[json!({"t_ns": 0, "event": "notice", "message": "x"})],
            json!(null),
        );
        assert_eq!(
            text,
            "An application ran with 0 components for 0.000 s. How it ended is not on record: the \
             run was cut off, or still goes on. No fault was confirmed."
        );
    }
}
