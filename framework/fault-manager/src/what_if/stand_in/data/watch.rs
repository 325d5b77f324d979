//! The checks of one port.

use system_model::fault::FaultKind;

use super::Datum;
use crate::manager::FaultManager;
use crate::observation::{DetectorId, DetectorKind};

/// The checks of one port.
#[derive(Debug, Default)]
pub(super) struct Watch {
    checks: Vec<Check>,
}

#[derive(Debug)]
struct Check {
    detector: DetectorId,
    what: What,
    complaining: bool,
}

#[derive(Debug)]
enum What {
    /// Whether it has limits; without them every number passes.
    Interval { limited: bool },
    /// Whether the last datum was far off.
    Jump { last: Option<bool> },
    /// So many equal data are a symptom.
    Standstill { limit: u32, count: u32 },
}

impl Watch {
    /// What the rules of a component say of a port.
    pub fn new(manager: &FaultManager, component: usize, port: &str) -> Self {
        let own = &manager.system.components[component].rules.ports;
        let Some(index) = own.iter().position(|rules| rules.port == port) else {
            return Self::default();
        };
        let checks = &own[index].checks;
        let mut watch = Self::default();
        let mut add = |kind: DetectorKind, what: What| {
            if let Some(detector) = manager.detector(component, &kind) {
                watch.checks.push(Check {
                    detector,
                    what,
                    complaining: false,
                });
            }
        };
        for (rule, one) in checks.validity.iter().enumerate() {
            let limited = one.value.minimum.is_some() || one.value.maximum.is_some();
            let kind = DetectorKind::Validity { port: index, rule };
            add(kind, What::Interval { limited });
        }
        for rule in 0..checks.rate_of_change.len() {
            let kind = DetectorKind::RateOfChange { port: index, rule };
            add(kind, What::Jump { last: None });
        }
        for (rule, one) in checks.stuck.iter().enumerate() {
            let kind = DetectorKind::Stuck { port: index, rule };
            let limit = one.value.count;
            add(kind, What::Standstill { limit, count: 0 });
        }
        watch
    }

    /// Looks at a datum: whether it passes, and what is to be told.
    pub fn look(&mut self, datum: Datum) -> (bool, Vec<(DetectorId, Option<FaultKind>)>) {
        let mut passes = true;
        let mut findings = Vec::new();
        for check in &mut self.checks {
            let found = check.what.look(datum);
            passes &= found.is_none();
            if found.is_some() || check.complaining {
                findings.push((check.detector, found));
            }
            check.complaining = found.is_some();
        }
        (passes, findings)
    }

    /// Another instance writes from now on.
    pub fn begin_anew(&mut self) {
        for check in &mut self.checks {
            match &mut check.what {
                What::Interval { .. } => {}
                What::Jump { last } => *last = None,
                What::Standstill { count, .. } => *count = 0,
            }
        }
    }
}

impl What {
    fn look(&mut self, datum: Datum) -> Option<FaultKind> {
        match self {
            Self::Interval { limited } => {
                let wrong = datum.no_number || (*limited && datum.far);
                wrong.then_some(FaultKind::OutOfRange)
            }
            Self::Jump { last } => {
                let before = last.replace(datum.far);
                let jumps = before.is_some_and(|before| before != datum.far || datum.wild);
                (datum.no_number || jumps).then_some(FaultKind::RateOfChange)
            }
            Self::Standstill { limit, count } => {
                *count = if datum.same {
                    count.saturating_add(1)
                } else {
                    1
                };
                (*count >= (*limit).max(2)).then_some(FaultKind::Stuck)
            }
        }
    }
}
