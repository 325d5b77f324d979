//! Checks of a port's data, with the detectors that they speak for.

use std::time::Duration;

use fault_manager::detection::Finding;
use fault_manager::detection::data_check::{DataCheck, Violation};
use fault_manager::{DetectorId, Evidence, Number, Observation, Symptom};
use system_model::data_type::DataType;
use system_model::fault::FaultKind;

use super::Circumstances;

/// Checks of the data of one port, with whom they are reported as.
pub struct Watch {
    port: String,
    data_type: DataType,
    check: DataCheck,
    /// By the index of the rule: who complains, and whether it does.
    detectors: Vec<(DetectorId, bool)>,
}

impl Watch {
    /// Checks of a port's data; `detectors` in the order of the check's rules.
    pub fn new(
        port: String,
        data_type: DataType,
        check: DataCheck,
        detectors: Vec<DetectorId>,
    ) -> Self {
        Self {
            port,
            data_type,
            check,
            detectors: detectors.into_iter().map(|id| (id, false)).collect(),
        }
    }

    /// Looks at a datum; whether anything is wrong with it.
    #[inline]
    pub(super) fn look(&mut self, stamp_ns: u64, bytes: &[u8], at: Circumstances<'_>) -> bool {
        let Self {
            port,
            data_type,
            check,
            detectors,
        } = self;
        check.check(stamp_ns, bytes, &mut |rule, finding| {
            let Some((detector, complaining)) = detectors.get_mut(rule) else {
                return;
            };
            match finding {
                Finding::Passed if *complaining => {
                    *complaining = false;
                    at.observations.report(Observation::Passed(*detector));
                }
                Finding::Passed => {}
                Finding::Violated(violation) => {
                    *complaining = true;
                    complain(*detector, port, data_type, &violation, at);
                }
            }
        })
    }

    /// Another instance writes from now on: what is compared with earlier data begins anew.
    pub fn begin_anew(&mut self) {
        self.check.reset();
    }
}

#[cold]
fn complain(
    detector: DetectorId,
    port: &str,
    data_type: &DataType,
    violation: &Violation,
    at: Circumstances<'_>,
) {
    let port = port.to_owned();
    let field = |index: usize| {
        let field = data_type.fields.get(index);
        field.map_or_else(String::new, |field| field.path.clone())
    };
    let (kind, evidence) = match *violation {
        Violation::Size { size, expected } => (
            FaultKind::WrongSize,
            Evidence::Size {
                port,
                size,
                expected,
            },
        ),
        Violation::Value {
            at,
            value,
            minimum,
            maximum,
        } => (
            FaultKind::OutOfRange,
            Evidence::Value {
                port,
                field: field(at.field),
                value: Number(value),
                minimum,
                maximum,
            },
        ),
        Violation::Jump {
            at,
            value,
            rate_per_second,
            maximum_per_second,
        } => (
            FaultKind::RateOfChange,
            Evidence::Jump {
                port,
                field: field(at.field),
                value: Number(value),
                rate: Number(rate_per_second),
                maximum_per_second,
            },
        ),
        Violation::Standstill { field: of, count } => (
            FaultKind::Stuck,
            Evidence::Frozen {
                port,
                field: of.map_or_else(String::new, field),
                count,
            },
        ),
    };
    at.observations
        .report(Observation::Symptom(Box::new(Symptom {
            detector,
            incarnation: at.incarnation,
            kind,
            return_code: 0,
            at: Duration::from_nanos(at.now_ns),
            runs: true,
            evidence,
        })));
}
