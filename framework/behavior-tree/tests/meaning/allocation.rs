//! A tick allocates nothing.

use std::time::Duration;

use behavior_tree::{NodeId, Status};

use crate::harness::Trial;

#[test]
fn a_tick_allocates_nothing() {
    let text = "(ReactiveSequence
        (Script code=\"n := 1; n += 2; word := 'text'\")
        (Fallback (Inverter S<_skipIf=\"n > 5 || word != 'text'\">) S<port={n}>)
        (Parallel success_count=1 (Repeat num_cycles=3 S) (RetryUntilSuccessful num_attempts=2 F))
        (Switch2 variable={n} case_1=1 case_2=3 S S F)
        (Precondition if=\"n == 3\" S)
        (RecoveryNode FS S)
        (PipelineSequence (RateController hz=50 S) (Timeout msec=15 R)))";
    // One line, as the harness reads it.
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut trial = Trial::new(&text);
    let mut ignored = |_node: NodeId, _before: Status, _now: Status| {};
    let mut now = Duration::ZERO;
    let mut tick = || {
        now += Duration::from_millis(10);
        trial
            .tree
            .tick(now, &mut ignored)
            .expect("all ports have values")
    };
    let first = tick();
    let counted = allocation_counter::measure(|| {
        for _tick in 0..1000 {
            tick();
        }
    });
    assert_eq!(first, Status::Running);
    assert_eq!(counted.count_total, 0, "{counted:?}");
}
