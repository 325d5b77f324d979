//! A tree ticked in simulated time, with stubs for leaves.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use behavior_tree::stub::{StubAnswer, StubAnswers};
use behavior_tree::{NodeId, Plan, Status, TickError, Tree, Value};
use clap::{Args, ValueEnum};
use serde_json::json;

use super::{ReadingArguments, assignment, load, write};
use crate::commands::{exit_code, output};

/// What `steadfast tree run` is asked to do.
#[derive(Debug, Args)]
pub(super) struct TrialArguments {
    /// A file of trees
    file: PathBuf,
    /// The tree; without it the one that the file names, or its only one
    #[arg(long, value_name = "ID")]
    tree: Option<String>,
    #[command(flatten)]
    reading: ReadingArguments,
    /// Tick so many times at most, unless the tree completes before
    #[arg(long, value_name = "N", default_value_t = 100)]
    ticks: u32,
    /// Simulated time between two ticks
    #[arg(long, value_name = "N", default_value_t = 100)]
    period_ms: u32,
    /// What a stub answers, by a node's name or kind, after running for so long; else SUCCESS at once
    #[arg(long = "answer", value_name = "NODE=STATUS[:MILLISECONDS]", value_parser = answer)]
    answers: Vec<(String, StubAnswer)>,
    /// An entry of the blackboard before the first tick; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    entries: Vec<(String, String)>,
    /// How changes are written
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people: one line for each change
    Text,
    /// For programs: one JSON object
    Json,
}

/// One change of one node.
struct Change {
    at: Duration,
    node: NodeId,
    before: Status,
    now: Status,
}

/// What a trial came to.
struct Trial {
    changes: Vec<Change>,
    ticks: u32,
    ended: Result<Status, TickError>,
}

pub(super) fn run(arguments: &TrialArguments) -> ExitCode {
    let options = arguments.reading.options(arguments.tree.as_ref());
    let plan = match load(&arguments.file, &options) {
        Ok(plan) => Arc::new(plan),
        Err(code) => return code,
    };
    let trial = tick(&plan, arguments);
    let text = match arguments.format {
        Format::Text => as_text(&plan, &trial),
        Format::Json => as_json(&plan, &trial),
    };
    let code = match trial.ended {
        Ok(_) => exit_code::DONE,
        Err(_) => exit_code::REFUSED,
    };
    output::finish("tree", write(&text), code)
}

fn tick(plan: &Arc<Plan>, arguments: &TrialArguments) -> Trial {
    let mut trial = Trial {
        changes: Vec::new(),
        ticks: 0,
        ended: Ok(Status::Idle),
    };
    let answers = StubAnswers {
        by_name: arguments.answers.iter().cloned().collect(),
    };
    let may_answer = arguments.reading.stubs;
    let mut make = |plan: &Plan, node: NodeId| match may_answer {
        true => answers.make(plan, node),
        false => Err("no component does its work; --stubs lets it answer SUCCESS".to_owned()),
    };
    let mut tree = match Tree::new(Arc::clone(plan), &mut make) {
        Ok(tree) => tree,
        Err(error) => {
            trial.ended = Err(error);
            return trial;
        }
    };
    for (key, value) in &arguments.entries {
        tree.set_entry(key, Value::of_literal(value));
    }
    let mut now = Duration::ZERO;
    while trial.ticks < arguments.ticks {
        let changes = &mut trial.changes;
        let mut observer = |node, before, status| {
            changes.push(Change {
                at: now,
                node,
                before,
                now: status,
            });
        };
        trial.ended = tree.tick(now, &mut observer);
        trial.ticks += 1;
        if !matches!(trial.ended, Ok(Status::Running)) {
            break;
        }
        if !tree.is_woken() {
            now += Duration::from_millis(arguments.period_ms.into());
        }
    }
    trial
}

fn as_text(plan: &Plan, trial: &Trial) -> String {
    let mut text = String::new();
    for change in &trial.changes {
        // Writing to memory does not fail.
        let _infallible = writeln!(
            text,
            "{:9.3} s  {:7} -> {:7}  {}",
            change.at.as_secs_f64(),
            change.before.name(),
            change.now.name(),
            plan.describe(change.node).path,
        );
    }
    let times = match trial.ticks {
        1 => "1 tick".to_owned(),
        ticks => format!("{ticks} ticks"),
    };
    let end = match &trial.ended {
        Ok(status) => format!("{} is {status} after {times}\n", plan.id),
        Err(error) => format!(
            "{} failed in tick {}: {error}\n  help: correct the script or port, or give the entry a \
             value with --set\n",
            plan.id, trial.ticks
        ),
    };
    text + &end
}

fn as_json(plan: &Plan, trial: &Trial) -> String {
    let changes = trial.changes.iter().map(|change| {
        json!({
            "time_s": change.at.as_secs_f64(),
            "node": plan.describe(change.node).path,
            "before": change.before.name(),
            "now": change.now.name(),
        })
    });
    let object = json!({
        "tree": plan.id,
        "ticks": trial.ticks,
        "status": trial.ended.as_ref().ok().map(|status| status.name()),
        "error": trial.ended.as_ref().err().map(ToString::to_string),
        "changes": changes.collect::<serde_json::Value>(),
    });
    format!("{object:#}\n")
}

/// `NODE=STATUS[:MILLISECONDS]`.
fn answer(text: &str) -> Result<(String, StubAnswer), String> {
    let (name, answer) = assignment(text)?;
    let (word, time) = answer.split_once(':').unwrap_or((&answer, "0"));
    let status = Status::named(word.trim()).filter(|status| *status != Status::Idle);
    let status = status.ok_or("the status is SUCCESS, FAILURE, RUNNING or SKIPPED")?;
    let time: u32 = time
        .trim()
        .parse()
        .map_err(|_| "the time is a whole number of milliseconds")?;
    let after = Duration::from_millis(time.into());
    Ok((name, StubAnswer { status, after }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_read() {
        let expected = StubAnswer {
            status: Status::Failure,
            after: Duration::from_millis(500),
        };
        assert_eq!(
            answer("Wait=FAILURE:500"),
            Ok(("Wait".to_owned(), expected))
        );
        assert_eq!(
            answer("Wait=RUNNING").map(|it| it.1.status),
            Ok(Status::Running)
        );
        for wrong in [
            "Wait",
            "=SUCCESS",
            "Wait=IDLE",
            "Wait=success",
            "Wait=SUCCESS:soon",
        ] {
            assert!(answer(wrong).is_err(), "{wrong}");
        }
    }
}
