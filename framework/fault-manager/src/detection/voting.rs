//! Voting between sources of one value (section 3.2.4 of Ahn et al., 2012).

mod group;

use system_model::rules::{VotingMethod, VotingRule};

/// What one source says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourceValue {
    /// Its newest value.
    pub value: f64,
    /// How much it counts: for [`VotingMethod::Weighted`] only.
    pub weight: f64,
    /// Whether the value is fresh. One that is no finite number is never used.
    pub is_fresh: bool,
}

/// What a vote says of one source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Opinion {
    /// It said nothing usable.
    Silent,
    /// It agrees, or nobody can tell.
    Agrees,
    /// It differs from the voted value by more than the tolerance, and others do not.
    Dissents {
        /// Its value minus the voted one.
        difference: f64,
    },
}

/// The result of a vote.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vote {
    /// The voted value, if there is one.
    pub value: Option<f64>,
    /// Whether it has the consent of two sources, or there is only one. Where it has not, no source
    /// is blamed: one of them is wrong, but nobody can tell which.
    pub is_decided: bool,
}

/// A voter between so many sources.
///
/// | usable sources | median | majority | weighted |
/// |---|---|---|---|
/// | none | no value | no value | no value |
/// | one | its value | its value | its value |
/// | two that agree | that of the lower index | mean | mean by weight |
/// | two that do not | no value | no value | no value |
/// | more, some agree | the middle one | mean of the largest group | mean by weight of those that agree |
/// | more, none agree | the middle one, undecided | no value | no value |
///
/// Of an even number the middle one is that of the two middle values whose source has the lower
/// index; of groups of equal size that of the lowest index counts.
#[derive(Debug, Clone)]
pub struct Voter {
    method: VotingMethod,
    tolerance: f64,
    /// Indices of usable sources.
    usable: Vec<usize>,
    opinions: Vec<Opinion>,
}

impl Voter {
    /// A voter between `sources` sources.
    pub fn new(rule: &VotingRule, sources: usize) -> Self {
        Self {
            method: rule.method,
            tolerance: rule.tolerance,
            usable: Vec::with_capacity(sources),
            opinions: vec![Opinion::Silent; sources],
        }
    }

    /// What the last vote says of each source, in their order.
    pub fn opinions(&self) -> &[Opinion] {
        &self.opinions
    }

    /// Votes. Sources beyond the number that the voter was made for are not heard.
    pub fn vote(&mut self, sources: &[SourceValue]) -> Vote {
        let sources = &sources[..sources.len().min(self.opinions.len())];
        let is_usable = |source: &SourceValue| source.is_fresh && source.value.is_finite();
        self.usable.clear();
        let indices = 0..sources.len();
        self.usable
            .extend(indices.filter(|index| is_usable(&sources[*index])));
        let value = match (self.method, self.usable.len()) {
            (_, 0) => None,
            (_, 1) => Some(sources[self.usable[0]].value),
            (VotingMethod::Median, 2) => {
                group::agreeing_pair(sources, &self.usable, self.tolerance)
            }
            (VotingMethod::Median, _) => Some(group::median(sources, &mut self.usable)),
            (VotingMethod::Majority, _) => group::majority(sources, &self.usable, self.tolerance),
            (VotingMethod::Weighted, _) => {
                group::weighted(sources, &mut self.usable, self.tolerance)
            }
        };
        let tolerance = self.tolerance;
        let agrees = |source: &SourceValue, value: f64| {
            is_usable(source) && (source.value - value).abs() <= tolerance
        };
        let supporters = |value: f64| {
            let supporters = sources.iter().filter(|source| agrees(source, value));
            supporters.count()
        };
        let usable = sources.iter().filter(|source| is_usable(source)).count();
        let is_decided = value.is_some_and(|value| usable == 1 || supporters(value) >= 2);
        self.opinions.fill(Opinion::Silent);
        for (opinion, source) in self.opinions.iter_mut().zip(sources) {
            *opinion = match value {
                _ if !is_usable(source) => Opinion::Silent,
                Some(value) if is_decided && !agrees(source, value) => Opinion::Dissents {
                    difference: source.value - value,
                },
                _ => Opinion::Agrees,
            };
        }
        Vote { value, is_decided }
    }
}

#[cfg(test)]
mod tests;
