//! When symptoms are a fault.

use std::time::Duration;

use fault_manager::{FaultState, Observation};
use system_model::fault::FaultKind;
use system_model::rules::{ComponentSeverity, Confirmation};

use crate::life::{OVERRUN, judged, overruns};
use crate::support::{Bench, application, located};

/// What happens at which millisecond.
enum Step {
    Bad(u64),
    Good(u64),
}

use Step::{Bad, Good};

/// Name, symptoms wanted, within milliseconds; what happens; the first symptom and the time from it
/// to the fault, in milliseconds.
type Case = (
    &'static str,
    u32,
    Option<u64>,
    Vec<Step>,
    Option<(u64, u64)>,
);

fn cases() -> Vec<Case> {
    vec![
        ("the first is enough", 1, None, vec![Bad(5)], Some((5, 0))),
        ("too few", 3, None, vec![Bad(5), Bad(6)], None),
        (
            "in a row",
            3,
            None,
            vec![Bad(5), Bad(900), Bad(2000)],
            Some((5, 1995)),
        ),
        (
            "a good one between",
            2,
            None,
            vec![Bad(5), Good(6), Bad(7)],
            None,
        ),
        (
            "within",
            2,
            Some(100),
            vec![Bad(5), Bad(105)],
            Some((5, 100)),
        ),
        ("not within", 2, Some(100), vec![Bad(5), Bad(106)], None),
        (
            "a good one between does not count within",
            2,
            Some(100),
            vec![Bad(5), Good(6), Bad(7)],
            Some((5, 2)),
        ),
        (
            "the window slides",
            3,
            Some(100),
            vec![Bad(0), Bad(60), Bad(120), Bad(150)],
            Some((60, 90)),
        ),
    ]
}

#[test]
fn symptoms_become_a_fault_by_the_debounce() {
    for (case, count, within, steps, expected) in cases() {
        let judgement = judged(ComponentSeverity::Ignore, count, within);
        let mut bench = Bench::new(vec![overruns(judgement)]);
        for step in steps {
            let (Bad(at) | Good(at)) = step;
            bench.now = Duration::from_millis(at);
            match step {
                Bad(_) => bench.complain(0, &OVERRUN, FaultKind::Overrun, true),
                Good(_) => {
                    let detector = bench.detector(0, &OVERRUN);
                    bench.tell(Observation::Passed(detector));
                }
            }
        }
        let verdict = bench.records.values().next();
        let found = verdict.map(|one| (one.first_symptom_ns / 1_000_000, one.detection_us / 1_000));
        assert_eq!(found, expected, "{case}");
    }
}

#[test]
fn too_few_symptoms_are_forgotten() {
    let judgement = judged(ComponentSeverity::Ignore, 2, Some(100));
    let mut bench = Bench::new(vec![overruns(judgement)]);
    bench.complain(0, &OVERRUN, FaultKind::Overrun, true);
    let states = |bench: &Bench| -> Vec<FaultState> {
        bench.manager.verdicts().map(|one| one.state).collect()
    };
    assert_eq!(states(&bench), [FaultState::Prefailed]);
    assert_eq!(bench.manager.due(), Some(Duration::from_millis(100)));
    bench.wait(100);
    assert_eq!(states(&bench), []);
    assert!(bench.records.is_empty());
}

#[test]
fn a_component_that_does_not_run_needs_no_second_symptom() {
    let mut scope = application("robot", &["planner"]);
    scope.rules.components[0].confirmation = Some(located(Confirmation {
        count: 3,
        within: None,
    }));
    let mut bench = Bench::new(vec![scope]);
    bench.crash(0);
    assert_eq!(bench.acts.len(), 1);
}
