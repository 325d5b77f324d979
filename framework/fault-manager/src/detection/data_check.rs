//! Checks of a port's data: intervals, jumps, frozen values (section 3.2.2 of Ahn et al., 2012).

mod interval;
mod jump;
mod standstill;
#[cfg(test)]
mod tests;

use system_model::data_type::DataType;
use system_model::rules::PortChecks;

use super::Finding;
use super::number::{Elements, UnknownField, unknown};
use interval::Interval;
use jump::Jump;
use standstill::Standstill;

/// What is wrong with a datum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Violation {
    /// It has not the size of its type, so no rule can look at it. Charged to the first rule.
    Size {
        /// Bytes that came.
        size: usize,
        /// Bytes that the type has.
        expected: usize,
    },
    /// `validity`: a value outside of the interval, or no finite number.
    Value {
        /// Which value.
        at: FieldElement,
        /// The value.
        value: f64,
        /// Least value allowed.
        minimum: Option<f64>,
        /// Largest value allowed.
        maximum: Option<f64>,
    },
    /// `rate_of_change`: a value that jumped, or that is no finite number.
    Jump {
        /// Which value.
        at: FieldElement,
        /// The value.
        value: f64,
        /// How fast it changed, in its unit per second.
        rate_per_second: f64,
        /// Largest rate allowed.
        maximum_per_second: f64,
    },
    /// `stuck`: so many equal data.
    Standstill {
        /// Index of the field in the data type; none for the whole datum.
        field: Option<usize>,
        /// Equal data so far, this one included.
        count: u32,
    },
}

/// One value of a datum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FieldElement {
    /// Index of the field in the data type.
    pub field: usize,
    /// Index in the field; 0 where it is no array.
    pub element: usize,
}

/// All data rules of one port.
#[derive(Debug, Clone)]
pub struct DataCheck {
    size: usize,
    intervals: Vec<Interval>,
    jumps: Vec<Jump>,
    standstills: Vec<Standstill>,
}

impl DataCheck {
    /// Prepares the `validity`, `rate_of_change` and `stuck` rules of a port whose data are of this
    /// type; their order is the index by which [`Self::check`] speaks of them.
    ///
    /// A rule without a field means every number of the datum but its time stamps (64-bit numbers
    /// in nanoseconds); `field="ranges"` all elements of an array, `field="ranges[2]"` one.
    ///
    /// # Errors
    /// All rules that name a field that the type does not have.
    pub fn compile(data_type: &DataType, checks: &PortChecks) -> Result<Self, Vec<UnknownField>> {
        let mut errors = Vec::new();
        let mut rules = 0;
        let mut resolve = |field: &Option<String>| {
            let index = rules;
            rules += 1;
            let found = Elements::resolve(data_type, field.as_deref());
            found.unwrap_or_else(|| {
                let name = field.as_deref().unwrap_or_default();
                errors.push(unknown(data_type, index, name));
                Vec::new()
            })
        };
        let validity = checks.validity.iter().map(|rule| &rule.value);
        let intervals = validity
            .map(|rule| Interval::new(rule, resolve(&rule.field)))
            .collect();
        let rates = checks.rate_of_change.iter().map(|rule| &rule.value);
        let jumps = rates
            .map(|rule| Jump::new(rule, resolve(&rule.field)))
            .collect();
        let stuck = checks.stuck.iter().map(|rule| &rule.value);
        let standstills = stuck
            .map(|rule| Standstill::new(rule, resolve(&rule.field)))
            .collect();
        if !errors.is_empty() {
            return Err(errors);
        }
        Ok(Self {
            size: data_type.size,
            intervals,
            jumps,
            standstills,
        })
    }

    /// Number of rules.
    pub fn rules(&self) -> usize {
        self.intervals.len() + self.jumps.len() + self.standstills.len()
    }

    /// Looks at the next datum. `found` is told of every rule, in order, what it says of this
    /// datum: one finding a rule, the first value that violates it. A rule that cannot judge this
    /// datum (the first one of a rate, one of a wrong size) says nothing. Returns whether any rule
    /// is violated.
    pub fn check(
        &mut self,
        stamp_ns: u64,
        bytes: &[u8],
        found: &mut impl FnMut(usize, Finding<Violation>),
    ) -> bool {
        if bytes.len() != self.size {
            let violation = Violation::Size {
                size: bytes.len(),
                expected: self.size,
            };
            if self.rules() > 0 {
                found(0, Finding::Violated(violation));
            }
            return self.rules() > 0;
        }
        let mut violated = false;
        let mut tell = |rule: usize, violation: Option<Violation>| {
            violated |= violation.is_some();
            found(rule, violation.map_or(Finding::Passed, Finding::Violated));
        };
        for (index, interval) in self.intervals.iter().enumerate() {
            tell(index, interval.check(bytes));
        }
        let first_jump = self.intervals.len();
        for (index, jump) in self.jumps.iter_mut().enumerate() {
            if let Some(judged) = jump.check(stamp_ns, bytes) {
                tell(first_jump + index, judged);
            }
        }
        let first_standstill = first_jump + self.jumps.len();
        for (index, standstill) in self.standstills.iter_mut().enumerate() {
            tell(first_standstill + index, standstill.check(bytes));
        }
        violated
    }

    /// Forgets earlier data: the next datum is the first one, as after its writer was replaced.
    pub fn reset(&mut self) {
        self.jumps.iter_mut().for_each(Jump::reset);
        self.standstills.iter_mut().for_each(Standstill::reset);
    }
}
