use std::path::Path;
use std::time::Duration;

use fault_manager::{Cause, Evidence, FaultId, Severity};
use recording::{Topic, read};

use super::*;

const SECOND_NS: u64 = 1_000_000_000;

fn verdict(id: u64, state: FaultState) -> Verdict {
    Verdict {
        id: FaultId(id),
        state,
        kind: "panic",
        component: "camera".to_owned(),
        incarnation: 1,
        node: String::new(),
        rule: None,
        evidence: Evidence::Size {
            port: String::new(),
            size: 0,
            expected: 0,
        },
        symptoms: 1,
        first_symptom_ns: 0,
        confirmed_ns: 0,
        cause: Cause::Root,
        severity: Severity::Reset,
        plan: Vec::new(),
        actions: Vec::new(),
        detection_us: 0,
        decision_us: 0,
        handling_us: None,
    }
}

/// A message in each second of a minute, and faults at some of them.
fn minute(options: BlackBoxOptions, faults: &[(u64, u64, FaultState)]) -> Vec<PathBuf> {
    let mut black_box = BlackBox::new(options, Arc::new([]), Vec::new()).unwrap();
    for second in 0..60 {
        let content = format!("{{\"t_ns\":{second}}}");
        let entry = Entry {
            source: Source::Topic(Topic::Events),
            log_ns: second * SECOND_NS,
            publish_ns: second * SECOND_NS,
            content: content.as_bytes(),
        };
        black_box.take(&entry).unwrap();
        for (_, id, state) in faults.iter().filter(|(at, _, _)| *at == second) {
            let verdict = verdict(*id, *state);
            black_box.judge(second * SECOND_NS, &verdict).unwrap();
        }
    }
    black_box.finish().unwrap();
    black_box.written().to_vec()
}

fn seconds(path: &Path) -> Vec<u64> {
    let messages = read(path).unwrap();
    messages.map(|it| it.unwrap().t_ns / SECOND_NS).collect()
}

#[test]
fn every_fault_has_its_file_and_a_burst_has_one() {
    use FaultState::{Confirmed, Healed, Prefailed};
    for (faults, expected) in [
        (&[][..], &[][..]),
        (&[(20, 1, Prefailed), (21, 1, Healed)], &[]),
        (&[(20, 1, Confirmed)], &[15..=22]),
        (&[(20, 1, Confirmed), (21, 1, Confirmed)], &[15..=22]),
        (&[(20, 1, Confirmed), (20, 2, Confirmed)], &[15..=22]),
        // The second of a burst keeps the file open, one that comes after it has its own.
        (&[(20, 1, Confirmed), (22, 2, Confirmed)], &[15..=24]),
        (
            &[(20, 1, Confirmed), (23, 2, Confirmed)],
            &[15..=22, 18..=25],
        ),
        (&[(0, 1, Confirmed), (59, 2, Confirmed)], &[0..=2, 54..=59]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let files = minute(BlackBoxOptions::new(folder.path().into()), faults);
        let files: Vec<Vec<u64>> = files.iter().map(|path| seconds(path)).collect();
        let expected: Vec<Vec<u64>> = expected.iter().map(|it| it.clone().collect()).collect();
        assert_eq!(files, expected, "{faults:?}");
    }
}

#[test]
fn a_burst_that_does_not_end_goes_on_in_further_files_and_the_oldest_make_room() {
    let folder = tempfile::tempdir().unwrap();
    let options = BlackBoxOptions {
        before: Duration::ZERO,
        after: Duration::from_secs(60),
        // Three messages of eleven bytes fill a file's share.
        folder_bytes: 30 * FILES_IN_FOLDER,
        ..BlackBoxOptions::new(folder.path().into())
    };
    let files = minute(options, &[(0, 1, FaultState::Confirmed)]);
    let there: Vec<&PathBuf> = files.iter().filter(|path| path.exists()).collect();
    assert!(files.len() > 15 && there.len() == 1, "{files:?}");
    assert_eq!(seconds(there[0]).last(), Some(&59));
}
