//! Nodes over several ticks, 10 ms apart: what they answer, and what they ask of their leaves.

use behavior_tree::Status;

use crate::harness::Trial;

/// A tree, its answers, and how often each leaf is ticked and halted until then.
type Row = (&'static str, &'static str, &'static [u32], &'static [u32]);

const ROWS: [Row; 40] = [
    // A sequence goes on where it was; a reactive one begins anew.
    ("(Sequence S RS S)", "RS", &[1, 2, 1], &[0, 0, 0]),
    ("(Sequence S RF S)", "RF", &[1, 2, 0], &[0, 0, 0]),
    ("(Sequence S FS S)", "FS", &[2, 2, 1], &[0, 0, 0]),
    ("(SequenceWithMemory S FS S)", "FS", &[1, 2, 1], &[0, 0, 0]),
    ("(ReactiveSequence S RS S)", "RS", &[2, 2, 1], &[0, 0, 0]),
    ("(ReactiveSequence SF R)", "RF", &[2, 1], &[0, 1]),
    ("(ReactiveSequence SR R)", "RR", &[2, 1], &[0, 1]),
    ("(Fallback F RF S)", "RS", &[1, 2, 1], &[0, 0, 0]),
    ("(ReactiveFallback FS R)", "RS", &[2, 1], &[0, 1]),
    ("(ReactiveFallback F RF S)", "RS", &[2, 2, 1], &[0, 0, 0]),
    ("(AsyncSequence S S S)", "RRS", &[1, 1, 1], &[0, 0, 0]),
    ("(AsyncFallback F F S)", "RRS", &[1, 1, 1], &[0, 0, 0]),
    // A child that was running does not end the tick when it completes.
    ("(AsyncSequence RS S)", "RS", &[2, 1], &[0, 0]),
    // A completed child of a parallel is not ticked again; those that run are halted at the end.
    ("(Parallel S RS)", "RS", &[1, 2], &[0, 0]),
    ("(Parallel R RF)", "RF", &[2, 2], &[1, 0]),
    (
        "(Parallel success_count=1 failure_count=2 R RS)",
        "RS",
        &[2, 2],
        &[1, 0],
    ),
    (
        "(Parallel success_count=-2 failure_count=2 F RS S)",
        "RS",
        &[1, 2, 1],
        &[0, 0, 0],
    ),
    ("(Parallel K RS)", "RS", &[2, 2], &[0, 0]),
    ("(ParallelAll F RS)", "RF", &[1, 2], &[0, 0]),
    (
        "(Repeat num_cycles=2 (Parallel S S))",
        "RS",
        &[2, 2],
        &[0, 0],
    ),
    // The condition of IfThenElse is asked once, that of WhileDoElse always.
    ("(IfThenElse SF RS F)", "RS", &[1, 2, 0], &[0, 0, 0]),
    ("(IfThenElse RF S RS)", "RRS", &[2, 0, 2], &[0, 0, 0]),
    ("(WhileDoElse SF R S)", "RS", &[2, 1, 1], &[0, 1, 0]),
    ("(WhileDoElse FS R R)", "RR", &[2, 1, 1], &[0, 0, 1]),
    ("(WhileDoElse SF R)", "RF", &[2, 1], &[0, 1]),
    // The last child of TryCatch cleans up, and changes nothing about the failure.
    ("(TryCatch S RF RS)", "RRF", &[1, 2, 2], &[0, 0, 0]),
    ("(TryCatch R S)", "RR", &[2, 0], &[0, 0]),
    // Help, then the same again; the budget counts helps that succeeded.
    (
        "(RecoveryNode number_of_retries=2 FFS S)",
        "S",
        &[3, 2],
        &[0, 0],
    ),
    (
        "(RecoveryNode number_of_retries=2 F S)",
        "F",
        &[3, 2],
        &[0, 0],
    ),
    (
        "(RecoveryNode number_of_retries=2 FS RS)",
        "RS",
        &[2, 2],
        &[0, 0],
    ),
    (
        "(RecoveryNode number_of_retries=2 F F)",
        "F",
        &[1, 1],
        &[0, 0],
    ),
    (
        "(RecoveryNode number_of_retries=0 F S)",
        "F",
        &[1, 0],
        &[0, 0],
    ),
    // Earlier children of a pipeline are ticked again while a later one runs.
    ("(PipelineSequence S RS S)", "RS", &[2, 2, 1], &[0, 0, 0]),
    ("(PipelineSequence SR R)", "RR", &[2, 2], &[0, 0]),
    ("(PipelineSequence SF R)", "RF", &[2, 1], &[0, 1]),
    ("(PipelineSequence RS R)", "RR", &[2, 1], &[0, 0]),
    ("(NonblockingSequence RS S)", "RS", &[2, 2], &[0, 0]),
    ("(NonblockingSequence R SF)", "RF", &[2, 2], &[1, 0]),
    // One turn each.
    (
        "(Repeat num_cycles=3 (RoundRobin S S S))",
        "RRS",
        &[1, 1, 1],
        &[0, 0, 0],
    ),
    ("(RoundRobin F RS F)", "RS", &[1, 2, 0], &[0, 0, 0]),
];

const DECORATORS: [Row; 16] = [
    ("(Repeat num_cycles=3 S)", "RRS", &[3], &[0]),
    // A cycle that took several ticks is followed by the next in the same tick.
    ("(Repeat num_cycles=2 RSRS)", "RRS", &[4], &[0]),
    (
        "(RetryUntilSuccessful num_attempts=3 FFS)",
        "RRS",
        &[3],
        &[0],
    ),
    ("(RetryUntilSuccessful num_attempts=2 F)", "RF", &[2], &[0]),
    ("(Timeout msec=25 R)", "RRRF", &[3], &[1]),
    ("(Timeout msec=25 RRS)", "RRS", &[3], &[0]),
    ("(Timeout msec=0 R)", "RRRR", &[4], &[0]),
    ("(Delay delay_msec=25 S)", "RRRS", &[1], &[0]),
    (
        "(Repeat num_cycles=2 (Delay delay_msec=15 S))",
        "RRRRS",
        &[2],
        &[0],
    ),
    ("(Sequence (RunOnce S) S)", "SS", &[1, 2], &[0, 0]),
    ("(RunOnce then_skip=false F)", "FFF", &[1], &[0]),
    ("(KeepRunningUntilFailure SSF)", "RRF", &[3], &[0]),
    ("(Precondition if=true RS)", "RS", &[2], &[0]),
    ("(LoopInt queue=1;2;3 value={v} S)", "RRRS", &[3], &[0]),
    ("(LoopInt queue=1;2 value={v} RSRF)", "RRRF", &[4], &[0]),
    // 50 times a second are every second tick.
    (
        "(PipelineSequence (RateController hz=50 S) R)",
        "RRRR",
        &[2, 4],
        &[0, 0],
    ),
];

#[test]
fn trees_answer_and_ask_as_they_should() {
    for (text, answers, ticks, halts) in ROWS.iter().chain(&DECORATORS) {
        let mut trial = Trial::new(text);
        assert_eq!(trial.answers(answers.len()), *answers, "{text}");
        assert_eq!(trial.ticks(), *ticks, "ticks of {text}");
        assert_eq!(trial.halts(), *halts, "halts of {text}");
    }
}

#[test]
fn what_runs_is_halted_once_and_begins_anew() {
    for text in [
        "(Sequence S R)",
        "(ReactiveFallback F R)",
        "(Parallel R)",
        "(IfThenElse S R)",
        "(RecoveryNode F R)",
        "(Timeout msec=0 R)",
        "(RateController R)",
        "(Switch2 variable=1 case_1=1 case_2=2 R S S)",
    ] {
        let mut trial = Trial::new(text);
        assert_eq!(trial.tick(), Status::Running, "{text}");
        trial.halt().expect("halting works");
        trial.halt().expect("halting works");
        assert_eq!(trial.halts().iter().sum::<u32>(), 1, "{text}");
        for node in trial.tree.plan().node_ids() {
            assert_eq!(trial.tree.status(node), Status::Idle, "{text}");
        }
        assert_eq!(trial.tick(), Status::Running, "{text}");
    }
}

#[test]
fn a_halted_sequence_with_memory_goes_on_where_it_was() {
    let mut trial = Trial::new("(SequenceWithMemory S R)");
    trial.tick();
    trial.halt().expect("halting works");
    trial.tick();
    assert_eq!(trial.ticks(), [1, 2]);
}

#[test]
fn a_loop_lets_others_work_and_says_so() {
    let mut trial = Trial::new("(Repeat num_cycles=-1 S)");
    for _cycle in 0..1000 {
        assert_eq!(trial.tick(), Status::Running);
        assert!(trial.tree.is_woken());
    }
    let mut trial = Trial::new("(RecoveryNode number_of_retries=1000000 F S)");
    assert_eq!(trial.tick(), Status::Running);
    assert!(trial.tree.is_woken());
    let mut trial = Trial::new("(Sequence R)");
    trial.tick();
    assert!(!trial.tree.is_woken());
}

#[test]
fn an_error_halts_the_tree_and_names_the_node() {
    let mut trial = Trial::new("(Parallel name=both failure_count=2 R (Inverter SX))");
    assert_eq!(trial.tick(), Status::Failure);
    let mut trial = Trial::new("(Parallel failure_count=2 R (Inverter RX))");
    assert_eq!(trial.tick(), Status::Running);
    let error = trial.tick_after(10).expect_err("the leaf is broken");
    assert_eq!(error.path, "Main/Parallel/Inverter/RX");
    assert_eq!(error.message, "the leaf is broken");
    assert_eq!(trial.halts(), [1, 1]);
    for node in trial.tree.plan().node_ids() {
        assert_eq!(trial.tree.status(node), Status::Idle);
    }
}
