//! Each node with each answer of its children, in the first tick.

use crate::harness::Trial;

const LETTERS: [char; 4] = ['S', 'F', 'R', 'K'];

/// Lines: the first child answers SUCCESS, FAILURE, RUNNING, SKIPPED; columns: the second does.
const CONTROLS: [(&str, &str); 20] = [
    ("Sequence", "SFRS FFFF RRRR SFRK"),
    // It lets others work after a child that completes at once.
    ("AsyncSequence", "RRRR FFFF RRRR SFRK"),
    ("SequenceWithMemory", "SFRS FFFF RRRR SFRK"),
    ("ReactiveSequence", "SFRS FFFF RRRR SFRK"),
    ("Fallback", "SSSS SFRF RRRR SFRK"),
    ("AsyncFallback", "SSSS RRRR RRRR SFRK"),
    ("ReactiveFallback", "SSSS SFRF RRRR SFRK"),
    // All must succeed, and one failure is too many.
    ("Parallel", "SFRS FFFF RFRR SFRK"),
    (
        "Parallel success_count=1 failure_count=2",
        "SSSS SFRR SRRR SRRK",
    ),
    (
        "Parallel success_count=2 failure_count=2",
        "SFRR FFFF RFRR RFRK",
    ),
    ("ParallelAll", "SFRS FFRF RRRR SFRK"),
    ("ParallelAll max_failures=2", "SSRS SFRS RRRR SSRK"),
    ("IfThenElse", "SFRK FFFF RRRR KKKK"),
    ("WhileDoElse", "SFRK FFFF RRRR KKKK"),
    ("TryCatch", "SSSS FFRF RRRR KKKK"),
    ("RecoveryNode", "SSSS FFRF RRRR KKKK"),
    ("PipelineSequence", "SFRS FFFF RRRR SFRK"),
    ("RoundRobin", "SSSS SFRF RRRR SFRK"),
    ("NonblockingSequence", "SFRS FFFF RFRR SFRK"),
    ("PersistentSequence", "SFRS FFFF RRRR SFRK"),
];

/// What a node answers when its child answers SUCCESS, FAILURE, RUNNING, SKIPPED.
const DECORATORS: [(&str, &str); 20] = [
    ("Inverter", "FSRK"),
    ("ForceSuccess", "SSRK"),
    ("ForceFailure", "FFRK"),
    ("KeepRunningUntilFailure", "RFRK"),
    ("Repeat num_cycles=1", "SFRK"),
    ("Repeat num_cycles=2", "RFRK"),
    ("Repeat num_cycles=-1", "RFRK"),
    ("Repeat num_cycles=0", "SSSS"),
    ("RetryUntilSuccessful num_attempts=1", "SFRK"),
    ("RetryUntilSuccessful num_attempts=2", "SRRK"),
    ("RetryUntilSuccessful num_attempts=-1", "SRRK"),
    ("Timeout msec=100", "SFRK"),
    ("Delay delay_msec=0", "SFRK"),
    ("Delay delay_msec=100", "RRRR"),
    ("RunOnce", "SFRK"),
    ("Precondition if=true", "SFRK"),
    ("Precondition if=false", "FFFF"),
    ("Precondition if=false else=SKIPPED", "KKKK"),
    ("LoopInt queue=1;2 value={v}", "RFRR"),
    ("RateController hz=10", "SFRK"),
];

#[test]
fn controls_answer_by_their_children() {
    for (node, grid) in CONTROLS {
        let mut cells = grid.chars().filter(|cell| !cell.is_whitespace());
        for first in LETTERS {
            for second in LETTERS {
                let text = format!("({node} {first} {second})");
                let answer = Trial::new(&text).answers(1);
                assert_eq!(Some(answer), cells.next().map(String::from), "{text}");
            }
        }
    }
}

#[test]
fn decorators_answer_by_their_child() {
    for (node, row) in DECORATORS {
        for (child, expected) in LETTERS.into_iter().zip(row.chars()) {
            let text = format!("({node} {child})");
            assert_eq!(Trial::new(&text).answers(1), expected.to_string(), "{text}");
        }
    }
}

#[test]
fn leaves_answer_by_their_ports() {
    for (leaf, expected) in [
        ("(AlwaysSuccess )", "S"),
        ("(AlwaysFailure )", "F"),
        ("(Script code=\"a := 1\")", "S"),
        ("(ScriptCondition code=\"1 < 2\")", "S"),
        ("(ScriptCondition code=\"2 < 1\")", "F"),
        ("(SetBlackboard value=1 output_key=a)", "S"),
        ("(UnsetBlackboard key=a)", "S"),
        ("(Sleep msec=15)", "RRS"),
        ("(Sleep msec=0)", "S"),
        ("(WasEntryUpdated entry=a)", "F"),
    ] {
        assert_eq!(Trial::new(leaf).answers(expected.len()), expected, "{leaf}");
    }
}

#[test]
fn switches_answer_by_the_case_that_fits() {
    for (variable, expected) in [("1", "S"), ("2", "F"), ("3", "R"), ("{unset}", "R")] {
        let text = format!("(Switch2 variable={variable} case_1=1 case_2=2 S F R)");
        assert_eq!(Trial::new(&text).answers(1), expected, "{text}");
    }
    // Of two that fit the last counts; a number fits its text.
    let text =
        "(Sequence (Script code=\"v := 1\") (Switch2 variable={v} case_1=1 case_2=1.0 S F R))";
    assert_eq!(Trial::new(text).answers(1), "F");
}
