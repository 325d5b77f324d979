//! A plan as a person reads it.

use std::fmt::Write as _;

use system_model::task::{HopCount, TaskSpecification};
use task_adaptation::{Candidate, Choice, Difference, Judged, Plan};

use super::{components, reasons};

/// The plan as a table and a few sentences.
pub fn of(task: &TaskSpecification, plan: &Plan) -> String {
    let mut text = String::new();
    let generation = &plan.generation;
    // Writing to memory does not fail, here and below.
    let _infallible = writeln!(
        text,
        "{}: {} combinations, {} groups, {} candidates\n",
        task.name,
        generation.combinations,
        generation.groups,
        generation.candidates.len()
    );
    for component in &generation.lacking {
        let name = &task.components[*component].name;
        let _infallible = writeln!(
            text,
            "No robot has {name}, without which the task cannot be done."
        );
    }
    if !plan.judged.is_empty() {
        table(task, plan, &mut text);
    }
    conclusion(task, plan, &mut text);
    text
}

fn table(task: &TaskSpecification, plan: &Plan, text: &mut String) {
    let _infallible = writeln!(
        text,
        "   #  hops     P_F    P_NF     P_T  components, and why not"
    );
    for judged in &plan.judged {
        let number = judged.number;
        let mark = match plan.choice {
            Choice::Take(chosen) | Choice::Keep(chosen) if chosen == number => '>',
            _ => ' ',
        };
        let _infallible = writeln!(
            text,
            "{mark}{number:>3}  {:>4}  {}  {}",
            judged.candidate.hops,
            numbers(judged),
            listed(task, &judged.candidate)
        );
        if !judged.rejections.is_empty() {
            let reasons = reasons(task, &judged.rejections);
            let _infallible = writeln!(text, "{:37}{reasons}", "");
        }
    }
    text.push('\n');
}

fn numbers(judged: &Judged) -> String {
    match judged.quality {
        Some(quality) => format!(
            "{:>6.4}  {:>6.4}  {:>6.4}",
            quality.functional, quality.non_functional, quality.total
        ),
        None => format!("{:>6}  {:>6}  {:>6}", "-", "-", "-"),
    }
}

fn listed(task: &TaskSpecification, candidate: &Candidate) -> String {
    components(task, candidate).join(" ")
}

fn conclusion(task: &TaskSpecification, plan: &Plan, text: &mut String) {
    let sentence = match (&plan.choice, &plan.nearest) {
        (Choice::Take(number), _) => format!("Candidate {number} is chosen."),
        (Choice::Keep(number), _) => {
            format!("Candidate {number} runs, and none is better by enough: nothing changes.")
        }
        (Choice::Nothing, Some(nearest)) => format!(
            "No candidate is feasible. The nearest is {}: {}.",
            nearest.number,
            reasons(task, &nearest.lacks)
        ),
        (Choice::Nothing, None) => "There is no candidate.".to_owned(),
    };
    let _infallible = writeln!(text, "{sentence}");
    if plan.generation.left_out > 0 {
        let _infallible = writeln!(
            text,
            "Groups without a candidate here: {} (the task's limit is {}{}).",
            plan.generation.left_out,
            task.generation.limit,
            match task.generation.judges_running {
                true => "",
                false => ", and what runs is left out",
            }
        );
    }
    differences(task, &plan.differences, text);
}

fn differences(task: &TaskSpecification, differences: &[Difference], text: &mut String) {
    if differences.is_empty() {
        return;
    }
    let other_way = match task.generation.hops {
        HopCount::Whole => "essential components only",
        HopCount::Essential => "all components in use",
    };
    let _infallible = writeln!(
        text,
        "\nWith node hops counted along {other_way} other candidates would stand for these groups:"
    );
    for difference in differences {
        let _infallible = writeln!(
            text,
            "{:>4}  {:>4} hops instead of {}  {}",
            difference.number,
            difference.otherwise.hops,
            difference.hops_otherwise,
            listed(task, &difference.otherwise)
        );
    }
}
