//! What a run came to, for a person.

use std::io::{self, Write};
use std::path::Path;

use container::recording::RecordingSummary;
use container::summary::Summary;
use robot_simulation::RobotSummary;

/// Prints the summary.
pub(super) fn print(
    output: &mut impl Write,
    summary: &Summary,
    picture: Option<&Path>,
) -> io::Result<()> {
    writeln!(output)?;
    for (name, application) in &summary.applications {
        writeln!(
            output,
            "{name}: {} after {:.2} s of {} time ({})",
            application.state,
            application.time_s,
            application.clock,
            application.ended_by.replace('_', " ")
        )?;
    }
    match summary.robots.is_empty() {
        true => summary
            .robot
            .iter()
            .try_for_each(|it| drive(output, "robot", it))?,
        false => (summary.robots.iter())
            .try_for_each(|(name, it)| drive(output, &format!("robot of {name}"), it))?,
    }
    if let Some(adaptation) = &summary.adaptation {
        writeln!(
            output,
            "  self-adaptation: {} decisions, {} changes",
            adaptation.decisions, adaptation.changes
        )?;
    }
    components(output, summary)?;
    if let Some(recording) = &summary.recording {
        recorded(output, recording)?;
    }
    if let Some(picture) = picture {
        writeln!(output, "  picture of the drive: {}", picture.display())?;
    }
    output.flush()
}

fn drive(output: &mut impl Write, whose: &str, robot: &RobotSummary) -> io::Result<()> {
    match robot.time_s {
        Some(time_s) => writeln!(output, "  {whose}: reached its target after {time_s:.2} s")?,
        None => writeln!(
            output,
            "  {whose}: has not reached its target, {:.2} m to go",
            robot.distance_to_target_m
        )?,
    }
    writeln!(
        output,
        "  path {:.2} m, collisions {}, least clearance {:.2} m",
        robot.path_length_m, robot.collisions, robot.least_clearance_m
    )
}

fn components(output: &mut impl Write, summary: &Summary) -> io::Result<()> {
    let width = summary
        .components
        .keys()
        .map(|name| name.chars().count())
        .max()
        .unwrap_or_default()
        .max("component".len());
    writeln!(
        output,
        "  {:width$}  {:9} {:>11} {:>9} {:>8} {:>6}  tier",
        "component", "state", "incarnation", "cycles", "overruns", "faults"
    )?;
    for (name, component) in &summary.components {
        writeln!(
            output,
            "  {name:width$}  {:9} {:>11} {:>9} {:>8} {:>6}  {}",
            component.state,
            component.incarnation,
            component.cycles,
            component.overruns,
            component.faults,
            component.tier
        )?;
        if let Some(fault) = &component.last_fault {
            writeln!(output, "  {:width$}  last fault: {fault}", "")?;
        }
    }
    Ok(())
}

fn recorded(output: &mut impl Write, recording: &RecordingSummary) -> io::Result<()> {
    if let Some(file) = &recording.file {
        writeln!(
            output,
            "  recording: {}, {} messages",
            file.display(),
            recording.messages
        )?;
    }
    if let Some(last) = recording.black_box.last() {
        writeln!(
            output,
            "  black box: {} files, the last is {}",
            recording.black_box.len(),
            last.display()
        )?;
    }
    if recording.dropped > 0 {
        let topics = recording.dropped_by_topic.iter();
        let topics: Vec<String> = topics
            .map(|(topic, count)| format!("{topic} {count}"))
            .collect();
        writeln!(
            output,
            "  {} data were not recorded: {}",
            recording.dropped,
            topics.join(", ")
        )?;
    }
    Ok(())
}
