//! `rate_of_change`: no value changes faster than a limit.

use system_model::rules::RateOfChangeRule;

use super::{FieldElement, Violation};
use crate::detection::number::Elements;

const NANOSECONDS_PER_SECOND: f64 = 1e9;

/// One rule, prepared.
#[derive(Debug, Clone)]
pub(super) struct Jump {
    elements: Vec<Elements>,
    maximum_per_second: f64,
    /// The last finite value of each element, in their order, and its time.
    last: Vec<(f64, u64)>,
    newest_ns: Option<u64>,
}

impl Jump {
    pub(super) fn new(rule: &RateOfChangeRule, elements: Vec<Elements>) -> Self {
        let count = elements.iter().map(Elements::count).sum();
        Self {
            elements,
            maximum_per_second: rule.maximum_per_second,
            last: vec![(f64::NAN, 0); count],
            newest_ns: None,
        }
    }

    pub(super) fn reset(&mut self) {
        self.newest_ns = None;
    }

    /// Nothing about the first datum, nor about a second one of the same time: it has no rate, but
    /// the next one is compared with the one before it, so a jump between them is seen then.
    /// Time that runs backwards begins anew.
    pub(super) fn check(&mut self, stamp_ns: u64, bytes: &[u8]) -> Option<Option<Violation>> {
        match self.newest_ns {
            Some(newest_ns) if stamp_ns == newest_ns => None,
            Some(newest_ns) if stamp_ns > newest_ns => {
                self.newest_ns = Some(stamp_ns);
                Some(self.compare(stamp_ns, bytes))
            }
            _ => {
                self.last.fill((f64::NAN, stamp_ns));
                self.newest_ns = Some(stamp_ns);
                let violation = self.compare(stamp_ns, bytes);
                violation.map(Some)
            }
        }
    }

    /// A value that is no number violates the rule and leaves the last good one to be compared with
    /// the next; a value without a good one before it passes.
    fn compare(&mut self, stamp_ns: u64, bytes: &[u8]) -> Option<Violation> {
        let mut violation = None;
        let mut all = self.last.iter_mut();
        for elements in &self.elements {
            for (position, last) in (0..elements.count()).zip(&mut all) {
                let value = elements.value(bytes, position)?;
                let elapsed_s = stamp_ns.saturating_sub(last.1) as f64 / NANOSECONDS_PER_SECOND;
                let rate_per_second = match last.0.is_nan() && value.is_finite() {
                    true => 0.0,
                    false => (value - last.0) / elapsed_s,
                };
                if value.is_finite() {
                    *last = (value, stamp_ns);
                }
                if rate_per_second.abs() <= self.maximum_per_second {
                    continue;
                }
                violation.get_or_insert(Violation::Jump {
                    at: FieldElement {
                        field: elements.field,
                        element: elements.first + position,
                    },
                    value,
                    rate_per_second,
                    maximum_per_second: self.maximum_per_second,
                });
            }
        }
        violation
    }
}
