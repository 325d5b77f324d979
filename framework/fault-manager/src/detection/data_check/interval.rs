//! `validity`: every value is a number inside of an interval.

use system_model::rules::ValidityRule;

use super::{FieldElement, Violation};
use crate::detection::number::Elements;

/// One rule, prepared.
#[derive(Debug, Clone)]
pub(super) struct Interval {
    /// Only those that can violate it: an integer without limits is always a number.
    elements: Vec<Elements>,
    minimum: Option<f64>,
    maximum: Option<f64>,
}

impl Interval {
    pub(super) fn new(rule: &ValidityRule, mut elements: Vec<Elements>) -> Self {
        if rule.minimum.is_none() && rule.maximum.is_none() {
            elements.retain(Elements::is_floating);
        }
        Self {
            elements,
            minimum: rule.minimum,
            maximum: rule.maximum,
        }
    }

    pub(super) fn check(&self, bytes: &[u8]) -> Option<Violation> {
        // The infinities are outside of every interval, and NaN is never inside of one.
        let minimum = self.minimum.unwrap_or(f64::MIN).max(f64::MIN);
        let maximum = self.maximum.unwrap_or(f64::MAX).min(f64::MAX);
        let is_outside = |value: f64| !(value >= minimum && value <= maximum);
        self.elements.iter().find_map(|elements| {
            let position = elements.find(bytes, is_outside)?;
            Some(Violation::Value {
                at: FieldElement {
                    field: elements.field,
                    element: elements.first + position,
                },
                value: elements.value(bytes, position)?,
                minimum: self.minimum,
                maximum: self.maximum,
            })
        })
    }
}
