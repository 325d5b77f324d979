//! A voter in front of an input: several sources, one value (Ahn et al. 2012, section 3.2.4 and
//! figure 4b). The component that reads gets the voted value and knows of nothing.

use std::sync::Arc;
use std::time::Duration;

use fault_manager::detection::NumberReader;
use fault_manager::detection::voting::{Opinion, SourceValue, Voter};
use fault_manager::{DetectorId, Evidence, Number, Observation, Symptom};
use system_model::data_type::Field;
use system_model::fault::FaultKind;

use super::Circumstances;
use super::safe_value::write_number;
use crate::port::{Datum, Receiver};
use crate::status::ComponentStatus;

/// A source whose newest datum is so much older than the newest of all has no vote: five data of a
/// sensor of 50 Hz.
const OLDEST_VOTE: Duration = Duration::from_millis(100);

/// A voter with its sources.
pub struct VotedInput {
    name: String,
    voter: Voter,
    tolerance: f64,
    /// What is voted on.
    reader: NumberReader,
    field: Field,
    sources: Vec<Source>,
    votes: Vec<SourceValue>,
    /// The datum that is delivered.
    voted: Datum,
}

/// One source.
pub struct Source {
    /// What it sends.
    pub receiver: Receiver,
    /// How much it counts.
    pub weight: f64,
    /// Whom a dissent is charged to.
    pub detector: DetectorId,
    /// The component behind it.
    pub status: Arc<ComponentStatus>,
    /// Its newest datum.
    pub newest: Datum,
    /// Whether it dissents.
    pub complaining: bool,
}

impl VotedInput {
    /// A voter on one field of data of `size` bytes.
    pub fn new(
        name: String,
        voter: Voter,
        tolerance: f64,
        (reader, field): (NumberReader, Field),
        sources: Vec<Source>,
        size: usize,
    ) -> Self {
        Self {
            name,
            voter,
            tolerance,
            reader,
            field,
            votes: Vec::with_capacity(sources.len()),
            sources,
            voted: Datum::empty(size),
        }
    }

    /// The voted datum, if any source has sent since the last time and there is a value. Dissenters
    /// are reported.
    pub(super) fn receive(&mut self, at: Circumstances<'_>) -> Option<&Datum> {
        let mut fresh = false;
        for source in &mut self.sources {
            while let Some(datum) = source.receiver.receive() {
                source.newest.copy_from(datum);
                fresh = true;
            }
        }
        if !fresh {
            return None;
        }
        let newest_ns = self.sources.iter().map(|it| it.newest.stamp_ns()).max()?;
        let oldest_ns = newest_ns.saturating_sub(crate::clock::nanoseconds(OLDEST_VOTE));
        self.votes.clear();
        let reader = &self.reader;
        self.votes
            .extend(self.sources.iter().map(|source| SourceValue {
                value: reader.read(source.newest.bytes()),
                weight: source.weight,
                // Incarnations count from 1: 0 is a source that has sent nothing yet.
                is_fresh: source.newest.incarnation() > 0 && source.newest.stamp_ns() >= oldest_ns,
            }));
        let vote = self.voter.vote(&self.votes);
        if let Some(value) = vote.value {
            self.judge(value, at);
        }
        self.deliver(vote.value?, newest_ns)
    }

    /// The datum of the source that is nearest to the vote, with the voted value in it.
    fn deliver(&mut self, value: f64, stamp_ns: u64) -> Option<&Datum> {
        let distance = |index: &usize| (self.votes[*index].value - value).abs();
        let nearest = (0..self.votes.len())
            .filter(|index| self.votes[*index].is_fresh && distance(index).is_finite())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let source = &self.sources[nearest].newest;
        self.voted.copy_from(source);
        self.voted.set_origin(stamp_ns, source.incarnation());
        write_number(self.voted.bytes_mut(), &self.field, value);
        Some(&self.voted)
    }

    fn judge(&mut self, voted: f64, at: Circumstances<'_>) {
        for (index, opinion) in self.voter.opinions().iter().enumerate() {
            let source = &mut self.sources[index];
            match opinion {
                Opinion::Dissents { .. } => {
                    source.complaining = true;
                    let votes = self.votes.iter();
                    let evidence = Evidence::Votes {
                        voter: self.name.clone(),
                        value: Number(self.votes[index].value),
                        voted: Number(voted),
                        tolerance: self.tolerance,
                        votes: votes
                            .map(|vote| vote.is_fresh.then_some(Number(vote.value)))
                            .collect(),
                    };
                    at.observations
                        .report(Observation::Symptom(Box::new(Symptom {
                            detector: source.detector,
                            incarnation: source.status.incarnation(),
                            kind: FaultKind::VotingDissent,
                            return_code: 0,
                            at: Duration::from_nanos(at.now_ns),
                            runs: true,
                            evidence,
                        })));
                }
                Opinion::Agrees if source.complaining => {
                    source.complaining = false;
                    at.observations.report(Observation::Passed(source.detector));
                }
                Opinion::Agrees | Opinion::Silent => {}
            }
        }
    }
}
