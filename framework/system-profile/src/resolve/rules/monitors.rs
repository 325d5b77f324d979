//! Process-model monitors and voters: their ports, and whether a vote can be won.

use system_model::profile::Located;
use system_model::rules::{
    MonitorRule, RulePort, VotingMethod, VotingRule, VotingSource, VotingSpecification,
};
use system_model::specification::PortDirection;

use super::names::Names;
use crate::problem::Severity;
use crate::readers::rules::{DeclaredEnd, DeclaredMonitor, DeclaredSource, DeclaredVoting};
use crate::resolve::Assembly;
use crate::suggest::quoted;

/// With fewer sources than this nobody can be outvoted.
const LEAST_SOURCES: usize = 3;

/// A process-model monitor with its ports; none if one of them cannot be watched.
pub(super) fn process_model(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    declared: DeclaredMonitor,
) -> Option<MonitorRule> {
    let ports = |ends: &[DeclaredEnd]| {
        let ports: Vec<Option<RulePort>> = ends
            .iter()
            .map(|end| names.data_port(assembly, end, None))
            .collect();
        ports.into_iter().collect::<Option<Vec<_>>>()
    };
    let (inputs, outputs) = (ports(&declared.inputs), ports(&declared.outputs));
    Some(MonitorRule {
        name: declared.name.value,
        rule: declared.rule,
        inputs: inputs?,
        outputs: outputs?,
    })
}

/// A voter with its ports; none if one of them cannot take part.
pub(super) fn voting(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    declared: DeclaredVoting,
) -> Option<VotingSpecification> {
    check_number(assembly, &declared);
    check_weights(assembly, &declared.rule, &declared.sources);
    let mut sources: Vec<VotingSource> = Vec::new();
    let mut complete = true;
    for source in &declared.sources {
        let port = names.data_port(assembly, &source.end, Some(PortDirection::Output));
        let Some(port) = port else {
            complete = false;
            continue;
        };
        if sources.iter().any(|other| other.port == port) {
            assembly.report_at(
                Severity::Error,
                &source.end.port.place,
                format!("the port {} votes twice", quoted(&port.port)),
                "name each source once",
            );
        }
        sources.push(VotingSource {
            port,
            weight: source.weight.unwrap_or(1.0),
        });
    }
    let output = declared.output.as_ref();
    let output =
        output.and_then(|end| names.data_port(assembly, end, Some(PortDirection::Input)))?;
    let types = declared.sources.iter().zip(&sources);
    for (source, found) in types.filter(|(_, found)| found.port.data_type != output.data_type) {
        assembly.report_at(
            Severity::Error,
            &source.end.port.place,
            format!(
                "a source of `{}` for an input of `{}`",
                quoted(&found.port.data_type),
                quoted(&output.data_type)
            ),
            "all sources of a voter have the data type of the input that gets its value",
        );
    }
    complete.then_some(VotingSpecification {
        name: declared.name.value,
        rule: declared.rule,
        sources,
        output,
    })
}

fn check_number(assembly: &Assembly<'_>, declared: &DeclaredVoting) {
    let rule = &declared.rule;
    let (of, found) = (rule.value.of, declared.sources.len());
    let report = |message: String, help: &str| {
        assembly.report_at(Severity::Error, &rule.place, message, help);
    };
    if of != found {
        report(
            format!("a voter of {of} whose inputs are {found}"),
            "write one <input component=\"…\" port=\"…\"/> for each source",
        );
    }
    if of < LEAST_SOURCES && rule.value.method != VotingMethod::Weighted {
        report(
            format!("a voter of {of} cannot outvote anybody"),
            "with one liar at least three sources are needed",
        );
    } else if of.is_multiple_of(2) && rule.value.method == VotingMethod::Median {
        report(
            format!("the median of {of}, an even number"),
            "it lies between two sources, of which one may lie; use an odd number, or majority",
        );
    }
}

fn check_weights(assembly: &Assembly<'_>, rule: &Located<VotingRule>, sources: &[DeclaredSource]) {
    let given = sources
        .iter()
        .filter(|source| source.weight.is_some())
        .count();
    let weighted = rule.value.method == VotingMethod::Weighted;
    if weighted && given != sources.len() {
        assembly.report_at(
            Severity::Error,
            &rule.place,
            format!("{given} of {} sources have a weight", sources.len()),
            "write weights=\"…\" with a number for each source, or weight=\"…\" at each",
        );
    }
    if !weighted && given > 0 {
        assembly.report_at(
            Severity::Error,
            &rule.place,
            "weights of a vote in which all sources count the same",
            "write method=\"weighted\", or remove the weights",
        );
    }
}
