//! `steadfast adapt`: what self-adaptation would decide.

mod text;

use std::io::{self, IsTerminal as _, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Subcommand, ValueEnum};
use serde_json::{Value, json};
use system_model::task::{Placement, TaskSpecification};
use system_profile::load_task;
use task_adaptation::{Candidate, Choice, Judged, Plan, Rejection, plan};

use super::{exit_code, manual, output, problems};

/// What `steadfast adapt` is asked to do.
#[derive(Debug, Args)]
#[command(after_long_help = manual::ADAPT)]
pub struct AdaptArguments {
    #[command(subcommand)]
    command: AdaptCommand,
}

#[derive(Debug, Subcommand)]
enum AdaptCommand {
    /// Show all ways to do a task, how each is judged, and which one would be chosen
    ///
    /// Needs no robot: robots, their resources and the errors of components are taken from the file.
    #[command(after_long_help = manual::ADAPT)]
    Plan {
        /// The task: a file with the root task_profile
        #[arg(value_name = "TASK")]
        task: PathBuf,
        /// How the result is written
        #[arg(long, value_enum, default_value_t = Format::Text)]
        format: Format,
    },
}

/// How the result is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people: a table
    Text,
    /// For programs: one JSON object
    Json,
}

/// Plans and writes the result to standard output; problems of the file to standard error.
pub fn run(arguments: &AdaptArguments) -> ExitCode {
    let AdaptCommand::Plan { task: path, format } = &arguments.command;
    let outcome = load_task(path);
    let mut errors = io::stderr().lock();
    let colours = errors.is_terminal();
    // If nobody reads the text the exit code still tells.
    let _unread = problems::write(&mut errors, &outcome.problems, colours);
    let Some(task) = outcome.task else {
        return ExitCode::from(match outcome.is_readable {
            true => exit_code::REFUSED,
            false => exit_code::FILE,
        });
    };
    let plan = match plan(&task) {
        Ok(plan) => plan,
        Err(error) => {
            let _unread = writeln!(
                errors,
                "steadfast adapt: {}: {error}\n  help: remove links that matter little, or give \
                 fewer robots the components between them",
                path.display()
            );
            return ExitCode::from(exit_code::REFUSED);
        }
    };
    let written = match format {
        Format::Text => text::of(&task, &plan),
        Format::Json => format!("{:#}\n", as_json(&task, &plan)),
    };
    let mut standard_output = io::stdout().lock();
    let result = standard_output.write_all(written.as_bytes());
    let result = result.and_then(|()| standard_output.flush());
    let code = match plan.choice {
        Choice::Nothing => exit_code::REFUSED,
        Choice::Take(_) | Choice::Keep(_) => exit_code::DONE,
    };
    output::finish("adapt", result, code)
}

fn as_json(task: &TaskSpecification, plan: &Plan) -> Value {
    let generation = &plan.generation;
    let candidates: Value = plan.judged.iter().map(|it| candidate(task, it)).collect();
    let differences = plan.differences.iter().map(|difference| {
        json!({
            "candidate": difference.number,
            "hops": difference.hops_otherwise,
            "otherwise": components(task, &difference.otherwise),
            "otherwise_hops": difference.otherwise.hops,
        })
    });
    let (chosen, keeps) = match plan.choice {
        Choice::Take(number) => (Some(number), false),
        Choice::Keep(number) => (Some(number), true),
        Choice::Nothing => (None, false),
    };
    let names = generation.lacking.iter();
    let lacking: Vec<&str> = names.map(|it| task.components[*it].name.as_str()).collect();
    json!({
        "task": task.name,
        "combinations": count(generation.combinations),
        "groups": count(generation.groups),
        "left_out": count(generation.left_out),
        "hops": task.generation.hops.name(),
        "candidates": candidates,
        "chosen": chosen,
        "keeps_running": keeps,
        "nearest": plan.nearest.as_ref().map(|nearest| json!({
            "candidate": nearest.number,
            "lacks": reasons(task, &nearest.lacks),
        })),
        "lacking": lacking,
        "differences": differences.collect::<Value>(),
    })
}

fn candidate(task: &TaskSpecification, judged: &Judged) -> Value {
    let quality = judged.quality;
    json!({
        "number": judged.number,
        "components": components(task, &judged.candidate),
        "hops": judged.candidate.hops,
        "p_f": quality.map(|it| it.functional),
        "p_nf": quality.map(|it| it.non_functional),
        "p_t": quality.map(|it| it.total),
        "feasible": judged.is_feasible,
        "rejected_because": match judged.rejections.is_empty() {
            true => Value::Null,
            false => reasons(task, &judged.rejections).into(),
        },
    })
}

fn components(task: &TaskSpecification, candidate: &Candidate) -> Vec<String> {
    let placements = candidate.placements.iter();
    placements
        .map(|placement: &Placement| task.placement_name(*placement))
        .collect()
}

fn reasons(task: &TaskSpecification, rejections: &[Rejection]) -> String {
    let reasons = rejections.iter().map(|it| it.in_words(task));
    reasons.collect::<Vec<_>>().join("; ")
}

/// Numbers beyond those of JSON readers are approximate.
fn count(number: u128) -> Value {
    u64::try_from(number).map_or_else(|_| (number as f64).into(), Value::from)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn planned(name: &str) -> (TaskSpecification, Plan) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../profiles/tasks");
        let task = load_task(&folder.join(name)).task.expect("a good task");
        let plan = plan(&task).expect("a plan");
        (task, plan)
    }

    #[test]
    fn the_plan_as_json_has_the_numbers_of_the_paper() {
        let (task, plan) = planned("visual_servoing_two_robots.xml");
        let json = as_json(&task, &plan);
        assert_eq!(json["combinations"], 96);
        assert_eq!(json["groups"], 12);
        assert_eq!(json["chosen"], 9);
        assert_eq!(json["candidates"].as_array().map(Vec::len), Some(12));
        let ninth = &json["candidates"][8];
        assert_eq!(
            ninth["components"],
            json!([
                "R1:Cam_reader",
                "R2:Dehazer(SW)",
                "R1:SSD",
                "R1:Traj_Gen_1",
                "R1:PID",
                "R1:Tbot_motor"
            ])
        );
        assert_eq!(ninth["feasible"], true);
        assert_eq!(ninth["rejected_because"], Value::Null);
        for other in [0, 4, 11] {
            let reason = &json["candidates"][other]["rejected_because"];
            assert!(reason.is_string(), "{other}");
        }
        assert_eq!(json["differences"][1]["candidate"], 10);
    }

    #[test]
    fn where_nothing_is_feasible_the_nearest_is_named() {
        let (mut task, _) = planned("visual_servoing_one_robot.xml");
        task.robots[0].available[2] = 6.0;
        let plan = plan(&task).expect("a plan");
        let json = as_json(&task, &plan);
        assert_eq!(json["chosen"], Value::Null);
        assert_eq!(json["nearest"]["candidate"], 1);
        let lacks = json["nearest"]["lacks"].as_str().expect("words");
        assert!(
            lacks.starts_with("R1 has 6 W of power, 6.9 needed"),
            "{lacks}"
        );
        let text = text::of(&task, &plan);
        assert!(text.contains("No candidate is feasible"), "{text}");
        assert!(text.contains(lacks), "{text}");
    }

    #[test]
    fn the_text_names_the_chosen_one_and_where_hops_matter() {
        let (task, plan) = planned("visual_servoing_two_robots.xml");
        let text = text::of(&task, &plan);
        for part in [
            "96 combinations, 12 groups, 12 candidates",
            "Candidate 9 is chosen",
            "R2:Dehazer(SW)",
            "  10  ",
        ] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
    }
}
