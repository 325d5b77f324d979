//! From what is on record to the figures of each row.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::application::{Batch, CALLBACK_DEADLINE_MS, relay_name, sink_name};
use super::record::{EMERGENCY_STOP, Record, Verdict};
use super::scenario::{Fault, Handling};
use super::witness::Seen;

/// What one batch says of one row.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Row {
    /// Which row of the group.
    pub(super) handling: Handling,
    /// Each fault that was measured.
    pub(super) times: Vec<Times>,
    /// Data that never came through, beyond what the dead instance had in work; unknown where an
    /// emergency stop keeps data back.
    pub(super) lost: Option<u64>,
    /// Data that came through twice.
    pub(super) duplicated: Option<u64>,
    /// How the faults were handled, in the words of the verdicts, and how many of them.
    pub(super) notes: BTreeMap<String, u32>,
}

/// How long one fault took, in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Times {
    /// From the fault until it was confirmed.
    pub(super) detection_ns: u64,
    /// From there until the plan was made.
    pub(super) decision_ns: u64,
    /// From there until the first callback of who took over was completed, or the actuator had
    /// worked on its safe command.
    pub(super) handling_ns: u64,
}

impl Times {
    /// All three.
    pub(super) fn total_ns(&self) -> u64 {
        self.detection_ns + self.decision_ns + self.handling_ns
    }
}

/// The rows of a batch; `seen` by the number of the component.
pub(super) fn evaluate(batch: &Batch, seen: &[Seen], record: &Record) -> Vec<Row> {
    let handlings = batch.group.handlings.iter();
    let row = |handling: &Handling| {
        let mut row = Row {
            handling: *handling,
            times: Vec::new(),
            lost: Some(0),
            duplicated: Some(0),
            notes: BTreeMap::new(),
        };
        let relays = batch.relays().zip(seen);
        for ((number, _), seen) in relays.filter(|((_, of), _)| of == handling) {
            row.add(batch.group.fault, number, seen, record);
        }
        row
    };
    handlings.map(row).collect()
}

impl Row {
    fn add(&mut self, fault: Fault, number: u32, seen: &Seen, record: &Record) {
        let relay = relay_name(number);
        let verdicts: Vec<&Verdict> = record.verdicts_of(&relay).collect();
        let failures = verdicts.len() as u64;
        for (index, verdict) in verdicts.iter().enumerate() {
            let next = verdicts.get(index + 1);
            let before_ns = next.map_or(u64::MAX, |next| next.first_symptom_ns);
            if let Some(times) = times(fault, self.handling, verdict, seen, before_ns) {
                self.times.push(times);
                *self.notes.entry(note(verdict)).or_default() += 1;
            }
        }
        let account = record.accounts.get(&sink_name(number));
        let account = account.filter(|_| self.handling != Handling::EmergencyStop);
        let set_aside = record.set_aside.get(&relay).copied().unwrap_or_default();
        let in_work = match fault {
            // The bad datum itself is void.
            Fault::OutOfRange => failures,
            _ => set_aside,
        };
        let lost = account.map(|it| it.missing.saturating_sub(in_work));
        self.lost = self.lost.zip(lost).map(|(sum, lost)| sum + lost);
        let duplicated = account.map(|it| it.repeated);
        self.duplicated = self
            .duplicated
            .zip(duplicated)
            .map(|(sum, more)| sum + more);
    }
}

/// The times of one fault; none if it was not handled in this way, or its end was not seen before
/// the next one.
fn times(
    fault: Fault,
    handling: Handling,
    verdict: &Verdict,
    seen: &Seen,
    before_ns: u64,
) -> Option<Times> {
    let symptom_ns = verdict.first_symptom_ns;
    let begin_ns = match fault {
        Fault::OutOfRange => symptom_ns,
        _ => {
            let before = seen.misbehaved_ns.iter().rev();
            let acted_ns = before.copied().find(|acted_ns| *acted_ns <= symptom_ns)?;
            let deadline_ns = match fault {
                Fault::Hang => CALLBACK_DEADLINE_MS * 1_000_000,
                _ => 0,
            };
            acted_ns + deadline_ns
        }
    };
    let last = verdict.actions.last()?;
    let is_stop = last.action == EMERGENCY_STOP;
    if is_stop != (handling == Handling::EmergencyStop) {
        return None;
    }
    let end_ns = if is_stop {
        verdict.done_ns?
    } else {
        let mut works = seen.works_since_ns.iter().copied();
        works.find(|works_ns| (symptom_ns..before_ns).contains(works_ns))?
    };
    let detection_ns = verdict.confirmed_ns.saturating_sub(begin_ns);
    let decision_ns = verdict.decision_us * 1000;
    let rest_ns = end_ns.saturating_sub(verdict.confirmed_ns);
    Some(Times {
        detection_ns,
        decision_ns: decision_ns.min(rest_ns),
        handling_ns: rest_ns.saturating_sub(decision_ns),
    })
}

/// How a fault was handled, without the number of the checkpoint.
fn note(verdict: &Verdict) -> String {
    let note = verdict.actions.last().map_or("", |action| &action.note);
    let note: String = note.chars().filter(|it| !it.is_ascii_digit()).collect();
    note.replace("checkpoint  restored", "checkpoint restored")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::bench::recovery::scenario::{Group, Tier};

    const EVENTS: &str = r#"
{"t_ns":900,"event":"run_started","application":"recovery","clock":"real","seed":1,"components":3}
{"t_ns":3000,"event":"verdict","id":1,"component":"relay_0","first_symptom_ns":2500,"confirmed_ns":2600,"decision_us":1,"actions":[{"action":"reset relay_0","outcome":"under_way"}]}
{"t_ns":9000,"event":"verdict","id":1,"component":"relay_0","first_symptom_ns":2500,"confirmed_ns":2600,"decision_us":1,"actions":[{"action":"reset relay_0","outcome":"done","note":"by a warm standby, checkpoint 17 restored"}]}
{"t_ns":9500,"event":"datum_set_aside","component":"relay_0","port":"input","stamp_ns":7}
{"t_ns":9900,"event":"verdict","id":2,"component":"relay_1","first_symptom_ns":9800,"confirmed_ns":9850,"decision_us":0,"actions":[]}
{"t_ns":9950,"event":"log","component":"sink_0","level":"information","message":"received 90, missing 3, repeated 2, last 95"}
{"t_ns":9960,"event":"log","component":"sink_1","level":"information","message":"received 95, missing 0, repeated 0, last 95"}
"#;

    fn batch(fault: Fault, handling: Handling) -> Batch {
        Batch {
            load_percent: 10,
            group: Group {
                tier: Tier::Guarded,
                fault,
                handlings: vec![handling],
            },
            chains: 2,
            faults: 1,
        }
    }

    #[test]
    fn a_fault_is_timed_from_when_it_acted_until_the_successor_has_worked() {
        let record = Record::read(EVENTS.trim()).expect("events");
        let seen = [
            Seen {
                misbehaved_ns: vec![100, 2000, 5000],
                works_since_ns: vec![150, 4000, 8000],
            },
            Seen::default(),
        ];
        let rows = evaluate(
            &batch(Fault::Trap, Handling::ResetCheckpoint),
            &seen,
            &record,
        );
        let times = Times {
            detection_ns: 600,
            decision_ns: 1000,
            handling_ns: 400,
        };
        assert_eq!(times.total_ns(), 2000);
        let note = "by a warm standby, checkpoint restored".to_owned();
        let expected = Row {
            handling: Handling::ResetCheckpoint,
            times: vec![times],
            lost: Some(2),
            duplicated: Some(2),
            notes: BTreeMap::from([(note, 1)]),
        };
        assert_eq!(rows, [expected]);
    }

    #[test]
    fn bad_data_count_from_when_they_were_written() {
        let record = Record::read(EVENTS.trim()).expect("events");
        let seen = [
            Seen {
                misbehaved_ns: vec![],
                works_since_ns: vec![4000],
            },
            Seen::default(),
        ];
        let rows = evaluate(&batch(Fault::OutOfRange, Handling::Reset), &seen, &record);
        let total_ns: Vec<u64> = rows[0].times.iter().map(Times::total_ns).collect();
        assert_eq!(total_ns, [1500]);
    }

    #[test]
    fn what_an_emergency_stop_keeps_back_is_not_counted() {
        let events = EVENTS.replace("reset relay_0", EMERGENCY_STOP);
        let record = Record::read(events.trim()).expect("events");
        let seen = [
            Seen {
                misbehaved_ns: vec![2000],
                works_since_ns: vec![],
            },
            Seen::default(),
        ];
        let rows = evaluate(&batch(Fault::Trap, Handling::EmergencyStop), &seen, &record);
        let total_ns: Vec<u64> = rows[0].times.iter().map(Times::total_ns).collect();
        assert_eq!(total_ns, [7000], "until the stop was on record as done");
        assert_eq!((rows[0].lost, rows[0].duplicated), (None, None));
    }
}
