//! How long detection, decision and recovery took: percentiles by kind of fault and tier.

use std::collections::BTreeMap;

use super::amounts::took;
use super::markup::Markup;
use super::model::Run;
use crate::commands::bench::percentiles::nearest_rank;

/// What is told of each phase, in thousandths.
const RANKS: [(&str, usize); 4] = [("p50", 500), ("p90", 900), ("p99", 990), ("max", 1000)];

/// The phases, as the columns are called.
const PHASES: [&str; 3] = ["detection", "decision", "recovery"];

/// Times of one kind of fault in one tier, in microseconds, by phase.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
struct Times {
    faults: usize,
    phases: [Vec<u64>; 3],
}

/// The table; nothing without a fault.
pub(super) fn draw(markup: &mut Markup, runs: &[&Run]) {
    let times = times(runs);
    if times.is_empty() {
        return;
    }
    markup.element("div", &[("class", &"wide")], |wide| {
        wide.element("table", &[("class", &"figures")], |table| {
            table.element("thead", &[], head);
            table.element("tbody", &[], |body| {
                for ((kind, tier), times) in &times {
                    row(body, &kind.replace('_', " "), tier, times);
                }
            });
        });
    });
    let note = "Detection is from the first symptom until the fault was confirmed, decision until \
                the plan was made, recovery until the component worked again; a fault that nothing \
                had to be done about has no recovery. Percentiles are times that were measured \
                (nearest rank), by the clock of the run: in simulated time what the machine needs \
                takes none.";
    markup.leaf("p", &[("class", &"note")], note);
}

fn head(head: &mut Markup) {
    head.element("tr", &[], |row| {
        for name in ["fault", "tier", "n"] {
            row.leaf("th", &[("rowspan", &2)], name);
        }
        for phase in PHASES {
            row.leaf("th", &[("colspan", &RANKS.len())], phase);
        }
    });
    head.element("tr", &[], |row| {
        for (name, _) in PHASES.iter().flat_map(|_| RANKS) {
            row.leaf("th", &[], name);
        }
    });
}

fn row(body: &mut Markup, kind: &str, tier: &str, times: &Times) {
    body.element("tr", &[], |row| {
        row.leaf("td", &[], kind);
        row.leaf("td", &[], tier);
        row.leaf("td", &[("class", &"number")], times.faults);
        for phase in &times.phases {
            for (_, per_mille) in RANKS {
                let time = nearest_rank(phase, per_mille).map_or("–".to_owned(), took);
                row.leaf("td", &[("class", &"number")], time);
            }
        }
    });
}

/// All times, sorted; of several kinds also of all together.
fn times(runs: &[&Run]) -> BTreeMap<(String, String), Times> {
    let mut all: BTreeMap<(String, String), Times> = BTreeMap::new();
    for run in runs {
        for fault in run.faults.values() {
            let verdict = &fault.verdict;
            let key = (verdict.kind.clone(), tier(run, &verdict.component));
            let times = all.entry(key).or_default();
            times.faults += 1;
            times.phases[0].push(verdict.detection_us);
            times.phases[1].push(verdict.decision_us);
            times.phases[2].extend(verdict.handling_us);
        }
    }
    for phase in all.values_mut().flat_map(|times| &mut times.phases) {
        phase.sort_unstable();
    }
    all
}

/// Where a component ran, if a summary tells.
pub(super) fn tier(run: &Run, component: &str) -> String {
    let summary = run.summary.as_ref();
    let component = summary.and_then(|it| it.components.get(component));
    component.map_or("–".to_owned(), |it| it.tier.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::report::model::{ComponentSummary, Fault, FaultNumber, Summary, Verdict};

    fn run(faults: &[(&str, u64, Option<u64>)], tier: Option<&str>) -> Run {
        let faults = faults
            .iter()
            .zip(1..)
            .map(|((kind, detection_us, handling_us), id)| {
                let verdict = Verdict {
                    kind: (*kind).to_owned(),
                    component: "camera".to_owned(),
                    detection_us: *detection_us,
                    handling_us: *handling_us,
                    ..Verdict::default()
                };
                let fault = Fault {
                    verdict,
                    ..Fault::default()
                };
                (FaultNumber { container: 1, id }, fault)
            });
        let summary = tier.map(|tier| Summary {
            components: [(
                "camera".to_owned(),
                ComponentSummary {
                    tier: tier.to_owned(),
                    ..ComponentSummary::default()
                },
            )]
            .into(),
            ..Summary::default()
        });
        Run {
            faults: faults.collect(),
            summary,
            ..Run::default()
        }
    }

    #[test]
    fn times_are_told_by_kind_and_tier() {
        let guarded = run(
            &[
                ("hang", 30, Some(9)),
                ("hang", 10, None),
                ("panic", 1, Some(2)),
            ],
            Some("guarded"),
        );
        let unknown = run(&[("hang", 20, Some(4))], None);
        let times = times(&[&guarded, &unknown]);
        let found = times.iter().map(|((kind, tier), times)| {
            let [detection, _, recovery] = &times.phases;
            format!("{kind} {tier} {} {detection:?} {recovery:?}", times.faults)
        });
        assert_eq!(
            found.collect::<Vec<_>>(),
            [
                "hang guarded 2 [10, 30] [9]",
                "hang – 1 [20] [4]",
                "panic guarded 1 [1] [2]",
            ]
        );
    }

    #[test]
    fn a_table_has_a_row_for_each() {
        let mut markup = Markup::default();
        draw(&mut markup, &[&run(&[], None)]);
        assert_eq!(markup.into_text(), "");
        let mut markup = Markup::default();
        draw(&mut markup, &[&run(&[("hang", 1_000_000, None)], None)]);
        let table = markup.into_text();
        assert_eq!(table.matches("<tr>").count(), 3, "{table}");
        assert_eq!(table.matches(">1.00 s<").count(), 4, "{table}");
        assert_eq!(
            table.matches(">–<").count(),
            5,
            "tier and recovery: {table}"
        );
    }
}
