//! Model files, good and bad.

use super::*;
use crate::problem::Severity;

const GOOD: &str = r#"<process_model name="lag">
  <state_space kind="continuous" period_ms="20">
    <a>0 1; -4 -2</a>
    <b>0; 4</b>
    <c>1 0</c>
  </state_space>
  <noise><process>0, 0.1</process><measurement>0.01</measurement></noise>
  <input_delay_ms>40</input_delay_ms><input_jitter_ms>2.5</input_jitter_ms>
  <inputs>
    <input name="speed">
      <case when="direction" equals="2"><term field="speed" scale="-1"/></case>
      <case offset="0.5"><term field="speed"/></case>
    </input>
  </inputs>
</process_model>"#;

fn outcome(text: &str) -> ProcessModelOutcome {
    load(&Document::from_bytes("model.xml", text.as_bytes()))
}

#[test]
fn a_model_is_read_with_its_defaults() {
    let outcome = outcome(GOOD);
    assert!(outcome.problems.is_empty(), "{:?}", outcome.problems);
    let model = outcome.model.expect("a good model");
    assert_eq!(model.name, "lag");
    assert_eq!(model.state_space.a.elements, [0.0, 1.0, -4.0, -2.0]);
    assert_eq!(model.state_space.d, Matrix::zeros(1, 1));
    assert_eq!(model.state_space.initial, [0.0, 0.0]);
    assert_eq!(model.process_noise.elements, [0.0, 0.0, 0.0, 0.1]);
    assert_eq!(model.input_delay, Duration::from_millis(40));
    assert_eq!(model.input_jitter, Duration::from_micros(2500));
    let cases = &model.inputs[0].cases;
    assert_eq!(cases[0].terms[0].scale, -1.0);
    assert_eq!(
        cases[0].condition.as_ref().map(|when| when.equals),
        Some(2.0)
    );
    assert_eq!((cases[1].terms[0].scale, cases[1].offset), (1.0, 0.5));
}

/// What is written, what instead, the line of the problem and its message.
const MISTAKES: [(&str, &str, u32, &str); 23] = [
    (
        "kind=\"continuous\"",
        "kind=\"continous\"",
        2,
        "`continous` in attribute kind of <state_space> is not understood",
    ),
    (
        "period_ms=\"20\"",
        "period_ms=\"0\"",
        2,
        "`0` in attribute period_ms of <state_space> is out of range",
    ),
    ("period_ms=\"20\"", "", 2, "<state_space> has no period_ms"),
    (
        "0 1; -4 -2",
        "0 1; -4",
        3,
        "row 2 of <a> has 1 numbers, the first one 2",
    ),
    (
        "0 1; -4 -2",
        "0 1 0; -4 -2 0",
        2,
        "<a> has 2 rows and 3 columns",
    ),
    ("0 1; -4 -2", "0 one; -4 -2", 3, "`one` in <a> is no number"),
    ("0 1; -4 -2", "0 1; -4 inf", 3, "`inf` in <a> is no number"),
    ("0 1; -4 -2", ";", 3, "<a> holds 1 rows of 0 numbers"),
    (
        "0 1; -4 -2",
        "0 1; -4 2",
        2,
        "the model is not stable: its state grows without bound",
    ),
    (
        "0 1; -4 -2",
        "0 1; -4 -2e9",
        2,
        "the period is too long for <a>",
    ),
    (
        "<b>0; 4</b>",
        "<b>0 4</b>",
        4,
        "<b> has 1 rows and 2 columns",
    ),
    (
        "<b>0; 4</b>",
        "<b>0 0; 4 4</b>",
        9,
        "the inputs are 1, the columns of <b> 2",
    ),
    ("<b>0; 4</b>", "", 2, "<state_space> has no <b>"),
    (
        "<c>1 0</c>",
        "<c>1 0</c><initial>0</initial>",
        5,
        "<initial> has 1 numbers",
    ),
    (
        "<c>1 0</c>",
        "<c>1 0</c><d>0 0</d>",
        5,
        "<d> has 1 rows and 2 columns",
    ),
    ("0, 0.1", "0 0.1 3", 7, "<process> has 3 rows and 3 columns"),
    (
        "0, 0.1",
        "0 0.1; 0.2 1",
        7,
        "<process> is no covariance: row 2, column 1 is not row 1, column 2",
    ),
    (
        "0, 0.1",
        "0 -1",
        7,
        "<process> is no covariance: a variance is negative",
    ),
    ("0.01", "0", 7, "the measurement noise is singular"),
    (
        "<input_delay_ms>40",
        "<input_delay_ms>-1",
        8,
        "`-1` in <input_delay_ms> is out of range",
    ),
    (
        "<case offset=\"0.5\"><term field=\"speed\"/></case>",
        "<case offset=\"x\"/>",
        12,
        "`x` in attribute offset of <case> is no number",
    ),
    ("equals=\"2\"", "", 11, "<case> has no equals"),
    (
        "<term field=\"speed\"/>",
        "<term/>",
        12,
        "<term> has no field",
    ),
];

#[test]
fn every_mistake_is_named_with_its_line() {
    for (written, instead, line, expected) in MISTAKES {
        let outcome = outcome(&GOOD.replacen(written, instead, 1));
        let found = outcome
            .problems
            .iter()
            .find(|problem| problem.message == expected);
        let found = found.unwrap_or_else(|| panic!("no `{expected}` in {:?}", outcome.problems));
        assert_eq!(found.place.line, line, "{expected}");
        assert!(found.place.column > 0 && found.help.is_some(), "{expected}");
        assert_eq!(found.severity, Severity::Error, "{expected}");
        assert!(outcome.model.is_none(), "{expected}");
    }
}

#[test]
fn all_mistakes_are_named_at_once() {
    let text = GOOD
        .replace("0 1; -4 -2", "0 x; y -2")
        .replace("<c>1 0</c>", "<c>z</c>")
        .replace("0.01", "none")
        .replace("field=\"speed\" scale=\"-1\"", "scale=\"-q\"");
    let outcome = outcome(&text);
    assert_eq!(outcome.problems.len(), 6, "{:#?}", outcome.problems);
}

#[test]
fn what_is_odd_but_usable_is_a_warning() {
    let cases = [
        (
            "0 1; -4 -2",
            "0 1; 0 -2",
            "a state of the model never forgets: its error adds up",
        ),
        (
            "<case when=\"direction\" equals=\"2\">",
            "<case>",
            "this case never counts",
        ),
        (
            "<inputs>",
            "<outputs/><inputs>",
            "unknown element <outputs> in <process_model>",
        ),
    ];
    for (written, instead, expected) in cases {
        let outcome = outcome(&GOOD.replacen(written, instead, 1));
        let messages: Vec<_> = outcome
            .problems
            .iter()
            .map(|problem| &problem.message)
            .collect();
        assert_eq!(messages, [expected]);
        assert!(outcome.model.is_some(), "{expected}");
    }
}

#[test]
fn a_discrete_model_is_stable_inside_of_the_unit_circle() {
    let discrete = |a: &str| {
        let text = GOOD
            .replace("continuous", "discrete")
            .replace("0 1; -4 -2", a);
        outcome(&text).problems.len()
    };
    for (a, problems) in [
        ("0.9 1; 0 0.5", 0),
        ("0 1; -1.1 0", 1),
        ("0 0.9; -0.9 0", 0),
    ] {
        assert_eq!(discrete(a), problems, "{a}");
    }
}
