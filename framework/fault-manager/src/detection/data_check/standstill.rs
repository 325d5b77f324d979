//! `stuck`: data do not stay exactly the same.

use std::ops::Range;

use system_model::rules::StuckRule;

use super::Violation;
use crate::detection::number::Elements;

/// One rule, prepared.
#[derive(Debug, Clone)]
pub(super) struct Standstill {
    /// The field that the rule names.
    field: Option<usize>,
    /// What is compared, without the gaps between fields.
    bytes: Vec<Range<usize>>,
    /// What those bytes were in the last datum.
    last: Vec<u8>,
    /// Equal data up to now; 0 before the first.
    count: u32,
    limit: u32,
}

impl Standstill {
    pub(super) fn new(rule: &StuckRule, elements: Vec<Elements>) -> Self {
        let named = elements.first().map(|elements| elements.field);
        let mut bytes: Vec<Range<usize>> = Vec::new();
        for elements in elements {
            match bytes.last_mut() {
                Some(last) if last.end == elements.bytes.start => last.end = elements.bytes.end,
                _ => bytes.push(elements.bytes),
            }
        }
        Self {
            field: named.filter(|_| rule.field.is_some()),
            last: vec![0; bytes.iter().map(Range::len).sum()],
            bytes,
            count: 0,
            limit: rule.count,
        }
    }

    pub(super) fn reset(&mut self) {
        self.count = 0;
    }

    pub(super) fn check(&mut self, bytes: &[u8]) -> Option<Violation> {
        let mut is_equal = !self.last.is_empty() && self.count > 0;
        let mut last = &mut self.last[..];
        for range in &self.bytes {
            let (own, rest) = last.split_at_mut(range.len());
            let new = &bytes[range.clone()];
            if own != new {
                is_equal = false;
                own.copy_from_slice(new);
            }
            last = rest;
        }
        self.count = match is_equal {
            true => self.count.saturating_add(1),
            false => 1,
        };
        // One datum alone is equal to nothing.
        (self.count >= self.limit.max(2)).then_some(Violation::Standstill {
            field: self.field,
            count: self.count,
        })
    }
}
