//! Faults and recoveries of one component on its bar; those that lie on each other are one mark.

use super::super::amounts::{at, seconds};
use super::super::model::Run;
use super::super::scale::Scale;

/// Marks of one kind that are nearer than this cannot be told apart, in pixels.
const NEAREST: f64 = 5.0;

/// Words of marks that lie on each other are told so far.
const MOST_WORDS: usize = 5;

/// A mark.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mark {
    pub(super) x: f64,
    pub(super) class: &'static str,
    /// In words.
    pub(super) what: String,
    /// Where it leads.
    pub(super) target: Option<String>,
}

/// Of each fault of a component where it was confirmed, and where it was over.
pub(super) fn marks(run: &Run, component: &str, time: &Scale, anchor: &str) -> Vec<Mark> {
    let faults = run.faults.iter();
    let faults = faults.filter(|(_, fault)| fault.verdict.component == component);
    let marks = faults.flat_map(|(number, fault)| {
        let verdict = &fault.verdict;
        let target = Some(format!("#{anchor}-fault-{number}"));
        let mark = |t_ns: u64, class, word: &str| Mark {
            x: time.place(seconds(t_ns)),
            class,
            what: format!("fault {number} {}: {word} at {}", verdict.kind, at(t_ns)),
            target: target.clone(),
        };
        let end = fault
            .end_ns()
            .map(|end_ns| mark(end_ns, "recovered", "over"));
        [
            Some(mark(verdict.confirmed_ns, "fault-mark", "confirmed")),
            end,
        ]
    });
    marks.flatten().collect()
}

/// Marks of one kind that lie on each other become one that tells of all.
pub(super) fn merged(mut marks: Vec<Mark>) -> Vec<Mark> {
    marks.sort_by(|one, other| one.class.cmp(other.class).then(one.x.total_cmp(&other.x)));
    let mut merged: Vec<(Mark, usize)> = Vec::new();
    for mark in marks {
        let last = merged.last_mut();
        match last.filter(|(last, _)| last.class == mark.class && mark.x - last.x < NEAREST) {
            Some((last, count)) => {
                *count += 1;
                if *count <= MOST_WORDS {
                    last.what = format!("{}\n{}", last.what, mark.what);
                }
            }
            None => merged.push((mark, 1)),
        }
    }
    let merged = merged.into_iter().map(|(mut mark, count)| {
        if count > MOST_WORDS {
            mark.what = format!("{}\nand {} more", mark.what, count - MOST_WORDS);
        }
        mark
    });
    merged.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_on_each_other_become_one() {
        let mark = |x, class| Mark {
            x,
            class,
            what: "a fault".to_owned(),
            target: None,
        };
        let fault = |x| mark(x, "fault-mark");
        for (marks, expected) in [
            (vec![], vec![]),
            (vec![fault(1.0), fault(9.0)], vec![(1.0, 1), (9.0, 1)]),
            (vec![fault(3.0), fault(1.0)], vec![(1.0, 2)]),
            (
                vec![fault(1.0), mark(1.0, "recovered")],
                vec![(1.0, 1), (1.0, 1)],
            ),
            (vec![fault(1.0); 9], vec![(1.0, MOST_WORDS + 1)]),
        ] {
            let found = merged(marks).into_iter();
            let found: Vec<(f64, usize)> =
                found.map(|it| (it.x, it.what.lines().count())).collect();
            assert_eq!(found, expected);
        }
    }
}
