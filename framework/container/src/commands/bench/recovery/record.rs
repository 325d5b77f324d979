//! What the event file of a run says of its faults.

use std::collections::BTreeMap;
use std::io;

use serde::Deserialize;

/// What the event file says.
#[derive(Debug, Default)]
pub(super) struct Record {
    /// By component and number of the fault: the last verdict.
    verdicts: BTreeMap<(String, u64), Verdict>,
    /// By component: what a sink said when it was stopped.
    pub(super) accounts: BTreeMap<String, Account>,
    /// By component: data that were set aside.
    pub(super) set_aside: BTreeMap<String, u64>,
}

#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(super) struct Verdict {
    pub(super) first_symptom_ns: u64,
    pub(super) confirmed_ns: u64,
    pub(super) decision_us: u64,
    pub(super) actions: Vec<Action>,
    /// When its last action was first seen to be done.
    #[serde(skip)]
    pub(super) done_ns: Option<u64>,
}

#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(super) struct Action {
    pub(super) action: String,
    pub(super) outcome: String,
    #[serde(default)]
    pub(super) note: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Account {
    pub(super) missing: u64,
    pub(super) repeated: u64,
}

#[derive(Deserialize)]
struct Line {
    t_ns: u64,
    event: String,
    #[serde(default)]
    component: String,
    #[serde(default)]
    id: u64,
    #[serde(default)]
    message: String,
}

/// What an emergency stop is called in verdicts.
pub(super) const EMERGENCY_STOP: &str = "emergency stop";

impl Record {
    /// Reads an event file.
    ///
    /// # Errors
    /// If a line is no event.
    pub(super) fn read(text: &str) -> io::Result<Self> {
        let mut record = Self::default();
        for text in text.lines() {
            let line: Line = serde_json::from_str(text)?;
            match line.event.as_str() {
                "verdict" => record.take_verdict(line, serde_json::from_str(text)?),
                "datum_set_aside" => *record.set_aside.entry(line.component).or_default() += 1,
                "log" => {
                    if let Some(account) = Account::read(&line.message) {
                        record.accounts.insert(line.component, account);
                    }
                }
                _ => {}
            }
        }
        Ok(record)
    }

    fn take_verdict(&mut self, line: Line, mut verdict: Verdict) {
        let key = (line.component, line.id);
        let known = self.verdicts.get(&key).and_then(|known| known.done_ns);
        let is_done = verdict
            .actions
            .last()
            .is_some_and(|it| it.outcome == "done");
        verdict.done_ns = known.or(is_done.then_some(line.t_ns));
        self.verdicts.insert(key, verdict);
    }

    /// The faults of a component, oldest first.
    pub(super) fn verdicts_of<'record>(
        &'record self,
        component: &'record str,
    ) -> impl Iterator<Item = &'record Verdict> {
        let of_it = self.verdicts.iter();
        of_it.filter_map(move |((of, _), verdict)| (of == component).then_some(verdict))
    }
}

impl Account {
    /// From the words of a relay: `received 3, missing 0, repeated 0, last 3`.
    fn read(text: &str) -> Option<Self> {
        let figure = |name: &str| {
            let (_, rest) = text.split_once(&format!("{name} "))?;
            rest.split(',').next()?.parse().ok()
        };
        Some(Self {
            missing: figure("missing")?,
            repeated: figure("repeated")?,
        })
    }
}
