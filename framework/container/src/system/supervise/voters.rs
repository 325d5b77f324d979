//! Voters: put in front of the input that gets the voted value, and connected to their sources.

use std::sync::Arc;

use fault_manager::DetectorKind;
use fault_manager::detection::NumberReader;
use fault_manager::detection::voting::Voter;
use system_model::data_type::DataType;
use system_model::rules::{VotingSource as SourceRule, VotingSpecification};
use system_model::specification::{ExecutionKind, QueuePolicy};

use super::{Subjects, misfit};
use crate::assembly::AssemblyProblem;
use crate::component::{InputTap, PortEnd, VotedInput, VotingSource};
use crate::port::{Datum, connection};
use crate::wake::Wake;

/// Inserts all voters.
pub(super) fn insert(subjects: &Subjects<'_>, problems: &mut Vec<AssemblyProblem>) {
    for (number, rule) in subjects.rules.votings.iter().enumerate() {
        if let Err(problem) = insert_one(subjects, number, rule) {
            problems.push(problem);
        }
    }
}

fn insert_one(
    subjects: &Subjects<'_>,
    number: usize,
    rule: &VotingSpecification,
) -> Result<(), AssemblyProblem> {
    let place = &rule.rule.place;
    let found = subjects.port(rule.output.component, &rule.output.port);
    let Some((index, data_type)) =
        found.and_then(|(index, port)| Some((index, port.data_type.as_ref()?)))
    else {
        // A port that the library lacks is reported at its declaration.
        return Ok(());
    };
    let path = rule.sources.first().and_then(|it| it.port.field.as_deref());
    let reader = NumberReader::compile(data_type, path, 0).map_err(|unknown| {
        misfit(
            place,
            format!("voter '{}': {unknown}", rule.name),
            format!(
                "the fields of '{}' are {}",
                data_type.name,
                unknown.known.join(", ")
            ),
        )
    })?;
    let field = data_type
        .fields
        .iter()
        .find(|field| path.is_none_or(|path| field.path == path))
        .cloned()
        .ok_or_else(|| {
            misfit(
                place,
                format!(
                    "voter '{}' votes on one number of '{}'",
                    rule.name, data_type.name
                ),
                "name a field, without an index".to_owned(),
            )
        })?;
    let mut sources = Vec::new();
    for (position, source) in rule.sources.iter().enumerate() {
        sources.extend(connect(
            subjects,
            rule,
            data_type,
            (number, position),
            source,
        )?);
    }
    let voter = Voter::new(&rule.rule.value, sources.len());
    let tolerance = rule.rule.value.tolerance;
    let size = data_type.size;
    let voted = VotedInput::new(
        rule.name.clone(),
        voter,
        tolerance,
        (reader, field),
        sources,
        size,
    );
    subjects.with_component(rule.output.component, |component| {
        if let Some(PortEnd::DataInput(input)) = component.services_mut().port_mut(index) {
            let tap = input
                .tap
                .get_or_insert_with(|| Box::new(InputTap::default()));
            tap.voter = Some(Box::new(voted));
        }
    });
    Ok(())
}

/// A connection from a source to the voter.
fn connect(
    subjects: &Subjects<'_>,
    rule: &VotingSpecification,
    data_type: &DataType,
    (voting, position): (usize, usize),
    source: &SourceRule,
) -> Result<Option<VotingSource>, AssemblyProblem> {
    let component = source.port.component;
    let kind = DetectorKind::Voting {
        voting,
        source: position,
    };
    let (Some((index, port)), Some(detector)) = (
        subjects.port(component, &source.port.port),
        subjects.detector(component, kind),
    ) else {
        return Ok(None);
    };
    if !port.data_type.as_ref().is_some_and(|it| it.fits(data_type)) {
        return Err(misfit(
            &rule.rule.place,
            format!(
                "voter '{}': port '{}' does not carry '{}', which its reader takes",
                rule.name, source.port.port, data_type.name
            ),
            "all sources of a voter and its output have one type".to_owned(),
        ));
    }
    let (sender, receiver) = connection(QueuePolicy::Last, 1, data_type.size);
    let wake = wake_of(subjects, rule.output.component);
    subjects.with_component(component, |component| {
        if let Some(PortEnd::DataOutput(output)) = component.services_mut().port_mut(index) {
            output.connections.push((sender, wake));
        }
    });
    Ok(Some(VotingSource {
        receiver,
        weight: source.weight,
        detector,
        status: Arc::clone(&subjects.assembly.statuses[component]),
        newest: Datum::empty(data_type.size),
        complaining: false,
    }))
}

/// What wakes the reader, if data do.
fn wake_of(subjects: &Subjects<'_>, component: usize) -> Option<Arc<Wake>> {
    let runs = |member: &crate::executor::Member| usize::try_from(member.number) == Ok(component);
    let executors = subjects.assembly.executors.iter();
    let executor = executors
        .filter(|executor| executor.kind == ExecutionKind::Aperiodic)
        .find(|executor| executor.members.iter().any(runs))?;
    Some(Arc::clone(&executor.wake))
}
