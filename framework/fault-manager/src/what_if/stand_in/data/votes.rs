//! Votes: who is alone with what he says is outvoted, if there are two others.

use system_model::fault::FaultKind;
use system_model::rules::{RulePort, VotingSpecification};

use super::{Datum, Port, StandIn, Wiring};
use crate::manager::FaultManager;
use crate::observation::{DetectorId, DetectorKind};

/// Of fewer sources nobody can tell which one is wrong.
const DECISIVE: usize = 3;

/// A voter.
#[derive(Debug)]
pub(super) struct Vote {
    /// The input that gets what is voted.
    pub output: Port,
    sources: Vec<Source>,
}

#[derive(Debug)]
struct Source {
    port: Port,
    detector: Option<DetectorId>,
    /// What it said last, if that was not yet voted on.
    said: Option<Datum>,
}

impl Vote {
    pub fn new(
        voting: usize,
        rule: &VotingSpecification,
        first: usize,
        manager: &FaultManager,
    ) -> Self {
        let end = |port: &RulePort| (first + port.component, port.port.clone());
        let sources = rule.sources.iter().enumerate().map(|(source, one)| {
            let port = end(&one.port);
            Source {
                detector: manager.detector(port.0, &DetectorKind::Voting { voting, source }),
                port,
                said: None,
            }
        });
        Self {
            output: end(&rule.output),
            sources: sources.collect(),
        }
    }

    /// Who is to be blamed.
    fn dissenting(&mut self) -> Vec<(usize, DetectorId)> {
        let decisive = self.sources.len() >= DECISIVE;
        let sources = self.sources.iter_mut();
        sources
            .filter_map(|source| {
                let far = source.said.take().is_some_and(|datum| datum.far);
                (far && decisive).then_some((source.port.0, source.detector?))
            })
            .collect()
    }
}

impl Wiring {
    /// A source has said something; the voted input gets a right value of it.
    pub(super) fn hear(&mut self, port: &Port, datum: Datum) {
        let mut voted = Vec::new();
        for vote in &mut self.votes {
            for source in vote.sources.iter_mut().filter(|one| one.port == *port) {
                source.said = Some(datum);
                voted.push(vote.output.clone());
            }
        }
        for input in voted {
            if let Some(input) = self.input(&input) {
                input.receive(Datum::new(datum.stamp));
            }
        }
    }
}

impl StandIn<'_> {
    /// The component that reads this input looks at what was voted.
    pub(super) fn vote(&mut self, input: &Port) {
        let votes = self.wiring.votes.iter_mut();
        let mut votes = votes.filter(|vote| vote.output == *input);
        let Some(dissenting) = votes.next().map(Vote::dissenting) else {
            return;
        };
        for (component, detector) in dissenting {
            self.complain(component, detector, FaultKind::VotingDissent, &input.1);
        }
    }
}
