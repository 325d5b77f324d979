//! Sequences of data and what the rules say of them.

use system_model::profile::Located;
use system_model::rules::{Judgement, RateOfChangeRule, StuckRule, ValidityRule};
use system_model::specification::Place;

use super::*;
use crate::detection::number::tests::{range_type, ranges};

fn located<Rule>(value: Rule) -> Located<Rule> {
    Located {
        value,
        place: Place::default(),
    }
}

fn validity(field: Option<&str>, minimum: Option<f64>, maximum: Option<f64>) -> PortChecks {
    PortChecks {
        validity: vec![located(ValidityRule {
            field: field.map(str::to_owned),
            minimum,
            maximum,
            judgement: Judgement::default(),
        })],
        ..PortChecks::default()
    }
}

fn rate(field: Option<&str>, maximum_per_second: f64) -> PortChecks {
    PortChecks {
        rate_of_change: vec![located(RateOfChangeRule {
            field: field.map(str::to_owned),
            maximum_per_second,
            judgement: Judgement::default(),
        })],
        ..PortChecks::default()
    }
}

fn stuck(field: Option<&str>, count: u32) -> PortChecks {
    PortChecks {
        stuck: vec![located(StuckRule {
            field: field.map(str::to_owned),
            count,
            judgement: Judgement::default(),
        })],
        ..PortChecks::default()
    }
}

/// What each datum leads to: '.' passed, '!' violated, ' ' nothing said.
fn verdicts(checks: &PortChecks, data: &[(u64, Vec<u8>)]) -> String {
    let mut check = DataCheck::compile(&range_type(), checks).expect("known fields");
    let verdict = |(milliseconds, bytes): &(u64, Vec<u8>)| {
        let mut verdict = ' ';
        let violated = check.check(milliseconds * 1_000_000, bytes, &mut |rule, finding| {
            assert_eq!(rule, 0);
            verdict = match finding {
                Finding::Passed => '.',
                Finding::Violated(_) => '!',
            };
        });
        assert_eq!(violated, verdict == '!');
        verdict
    };
    data.iter().map(verdict).collect()
}

#[test]
fn intervals_hold_finite_numbers_only() {
    let cases = [
        (Some("ranges"), Some(0.03), Some(3.0), (0.03, 3.0), '.'),
        (Some("ranges"), Some(0.03), Some(3.0), (0.5, 0.0), '!'),
        (Some("ranges[0]"), Some(0.03), Some(3.0), (0.5, 0.0), '.'),
        (Some("ranges[1]"), Some(0.03), Some(3.0), (0.5, 0.0), '!'),
        (Some("ranges"), None, None, (1e300, -1e300), '.'),
        (Some("ranges"), None, None, (f64::NAN, 0.0), '!'),
        (None, None, None, (0.0, f64::INFINITY), '!'),
        (None, None, None, (0.0, f64::NEG_INFINITY), '!'),
        (
            Some("ranges"),
            Some(f64::NEG_INFINITY),
            None,
            (f64::NEG_INFINITY, 0.0),
            '!',
        ),
        // The time stamp, 77, is none of the values that are meant.
        (None, Some(-5.0), Some(5.0), (1.0, 2.0), '.'),
        (Some("time"), Some(-5.0), Some(5.0), (1.0, 2.0), '!'),
        (Some("kind"), Some(0.0), None, (1.0, 2.0), '!'),
        (Some("ranges"), Some(1.0), Some(-1.0), (0.0, 0.0), '!'),
    ];
    for (field, minimum, maximum, (left, right), expected) in cases {
        let data = [(0, ranges(left, right, -1))];
        let found = verdicts(&validity(field, minimum, maximum), &data);
        assert_eq!(
            found,
            expected.to_string(),
            "{field:?} {minimum:?} {left} {right}"
        );
    }
}

#[test]
fn the_evidence_names_the_first_bad_value() {
    let checks = validity(Some("ranges"), Some(0.03), Some(3.0));
    let mut check = DataCheck::compile(&range_type(), &checks).expect("known fields");
    let mut findings = Vec::new();
    check.check(0, &ranges(1.0, 4.0, 0), &mut |_, finding| {
        findings.push(finding)
    });
    let violation = Violation::Value {
        at: FieldElement {
            field: 1,
            element: 1,
        },
        value: 4.0,
        minimum: Some(0.03),
        maximum: Some(3.0),
    };
    assert_eq!(findings, [Finding::Violated(violation)]);
}

#[test]
fn jumps_are_measured_by_the_time_of_the_data() {
    let nan = f64::NAN;
    let huge = f64::MAX;
    // Values of the left range at these milliseconds; at most 2 a second.
    let cases: [(&[(u64, f64)], &str); 8] = [
        (&[(0, 0.0), (500, 1.0), (1000, 0.0)], " .."),
        (&[(0, 0.0), (400, 1.0), (900, 1.5)], " !."),
        (&[(0, 0.0), (0, 9.0), (1, 0.0), (2, 9.0)], "  .!"),
        (&[(0, 0.0), (0, 9.0), (1, 9.0)], "  !"),
        (&[(0, 0.0), (100, nan), (500, 1.0)], " !."),
        (&[(0, nan), (100, 7.0), (200, 7.1)], "!.."),
        (&[(9, 0.0), (3, 100.0), (1003, 101.0)], "  ."),
        (&[(0, huge), (1, -huge)], " !"),
    ];
    for (data, expected) in cases {
        let data = data.iter().map(|(at, left)| (*at, ranges(*left, 0.0, 0)));
        let data: Vec<_> = data.collect();
        assert_eq!(verdicts(&rate(Some("ranges"), 2.0), &data), expected);
        assert_eq!(verdicts(&rate(None, 2.0), &data), expected);
    }
}

#[test]
fn equal_data_are_counted() {
    let nan = f64::NAN;
    type Case<'a> = (Option<&'a str>, &'a [(f64, f64, i8)], &'a str);
    let cases: [Case<'_>; 6] = [
        (None, &[(1.0, 2.0, 0), (1.0, 2.0, 0), (1.0, 2.0, 0)], "..!"),
        (None, &[(1.0, 2.0, 0), (1.0, 2.0, 0), (1.0, 2.0, 1)], "..."),
        (
            Some("ranges"),
            &[(1.0, 2.0, 0), (1.0, 2.0, 1), (1.0, 2.0, 2)],
            "..!",
        ),
        (
            Some("ranges[1]"),
            &[(1.0, 2.0, 0), (3.0, 2.0, 1), (4.0, 2.0, 2)],
            "..!",
        ),
        (Some("kind"), &[(nan, 0.0, 0); 3], "..!"),
        (
            Some("ranges"),
            &[(nan, 0.0, 0), (nan, 0.0, 0), (nan, 0.0, 0)],
            "..!",
        ),
    ];
    for (field, data, expected) in cases {
        let data = data
            .iter()
            .map(|(left, right, kind)| (0, ranges(*left, *right, *kind)));
        let data: Vec<_> = data.collect();
        assert_eq!(verdicts(&stuck(field, 3), &data), expected, "{field:?}");
    }
    // All bytes 0, as the memory of the rule is at first.
    let data = [(0, vec![0; 32]), (1, vec![0; 32])];
    assert_eq!(verdicts(&stuck(None, 2), &data), ".!");
}

#[test]
fn a_datum_of_the_wrong_size_violates_and_is_not_read() {
    for length in [0, 31, 33] {
        let data = [(0, vec![0; length])];
        assert_eq!(verdicts(&validity(None, None, None), &data), "!");
        assert_eq!(verdicts(&stuck(None, 2), &data), "!");
    }
    assert_eq!(verdicts(&PortChecks::default(), &[(0, Vec::new())]), " ");
}

#[test]
fn after_a_reset_the_next_datum_is_the_first() {
    let mut checks = rate(Some("ranges"), 2.0);
    checks.stuck = stuck(Some("kind"), 2).stuck;
    let mut check = DataCheck::compile(&range_type(), &checks).expect("known fields");
    let mut told = Vec::new();
    for (value, reset) in [(0.0, true), (1e9, true), (-1e9, false)] {
        told.clear();
        check.check(5, &ranges(value, 0.0, 0), &mut |rule, finding| {
            told.push((rule, finding))
        });
        assert_eq!(told, [(1, Finding::Passed)]);
        if reset {
            check.reset();
        }
    }
    assert!(check.check(6, &ranges(1e9, 0.0, 0), &mut |_, _| {}));
}

#[test]
fn every_unknown_field_is_named_with_those_there_are() {
    let mut checks = validity(Some("rang"), None, None);
    checks.rate_of_change = rate(Some("ranges"), 1.0).rate_of_change;
    checks.stuck = stuck(Some("ranges[7]"), 2).stuck;
    let errors = DataCheck::compile(&range_type(), &checks).expect_err("unknown fields");
    let named: Vec<_> = errors
        .iter()
        .map(|error| (error.index, &error.field[..]))
        .collect();
    assert_eq!(named, [(0, "rang"), (2, "ranges[7]")]);
    assert_eq!(
        errors[0].to_string(),
        "Ranges has no field `rang`; it has time, ranges, kind"
    );
}
