//! Detection: what of the data, the work and the process is not as the rules say.
//!
//! A detector is compiled from a rule once and then fed; it says what it finds and when that is
//! over. It reads no clock and, once compiled, allocates nothing. What becomes of a finding
//! (debounce, fault, severity) is not decided here.

pub mod data_check;
pub mod liveness;
mod number;
pub mod process_model;
pub mod voting;

pub use number::{NumberReader, UnknownField};

/// What a detector finds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Finding<Evidence> {
    /// All is well, or is well again.
    Passed,
    /// A symptom, with its figures.
    Violated(Evidence),
}
