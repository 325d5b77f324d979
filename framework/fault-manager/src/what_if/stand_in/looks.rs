//! What is looked at from time to time, by the detectors of real runs: age of data, completed work,
//! overruns; and memory and process models, of which nothing is known but that they are wrong.

use std::time::Duration;

use system_model::fault::FaultKind;
use system_model::rules::Arming;

use super::{StandIn, State};
use crate::detection::Finding;
use crate::detection::liveness::{Freshness, Heartbeat, Overruns};
use crate::detectors::{heartbeat_rule, overrun_rule};
use crate::manager::FaultManager;
use crate::observation::{DetectorId, DetectorKind, Observation};
use crate::system::Scope;

/// How often the container looks.
const LOOK_PERIOD: Duration = Duration::from_millis(5);

/// All watches.
#[derive(Debug)]
pub(super) struct Looks {
    watches: Vec<Watch>,
    /// When to look next.
    pub due: Duration,
}

#[derive(Debug)]
struct Watch {
    component: usize,
    detector: DetectorId,
    what: What,
    complaining: bool,
    incarnation: u32,
}

#[derive(Debug)]
enum What {
    Age(Freshness, String),
    Work(Heartbeat),
    Overruns(Overruns),
    Memory,
}

impl Looks {
    /// As the rules have it.
    pub fn new(manager: &FaultManager, scopes: &[Scope]) -> Self {
        let mut watches = Vec::new();
        for (index, detector) in manager.detectors().iter().enumerate() {
            let what = what(manager, scopes, detector.component, &detector.kind);
            watches.extend(what.map(|mut what| {
                if detector.judgement.arming == Arming::Always {
                    what.arm();
                }
                Watch {
                    component: detector.component,
                    detector: DetectorId(index),
                    what,
                    complaining: false,
                    incarnation: 1,
                }
            }));
        }
        Self {
            watches,
            due: Duration::ZERO,
        }
    }
}

fn what(
    manager: &FaultManager,
    scopes: &[Scope],
    component: usize,
    kind: &DetectorKind,
) -> Option<What> {
    let system = &manager.system;
    let application = system.components[component].application;
    let first = system.applications[application].members.start;
    let all = &scopes[application].rules;
    let rules = &system.components[component].rules;
    Some(match kind {
        DetectorKind::Freshness { port } => {
            let port = rules.ports.get(*port)?;
            let rule = port.checks.freshness.as_ref()?;
            What::Age(Freshness::new(&rule.value), port.port.clone())
        }
        DetectorKind::Heartbeat => {
            let rule = heartbeat_rule(component, first, all, system)?;
            What::Work(Heartbeat::new(&rule.value))
        }
        DetectorKind::Overrun => {
            let rule = overrun_rule(component, first, all, system)?;
            What::Overruns(Overruns::new(&rule.value, 0))
        }
        DetectorKind::Memory => What::Memory,
        _ => return None,
    })
}

impl What {
    fn arm(&mut self) {
        match self {
            Self::Age(freshness, _) => freshness.arm(Duration::ZERO),
            Self::Work(heartbeat) => heartbeat.arm(Duration::ZERO, 0),
            Self::Overruns(_) | Self::Memory => {}
        }
    }
}

impl StandIn<'_> {
    /// Looks at everything, if it is time.
    pub(super) fn look(&mut self) {
        if self.now < self.looks.due {
            return;
        }
        let period = LOOK_PERIOD.as_nanos();
        let grid = (self.now.as_nanos() / period + 1) * period;
        self.looks.due = Duration::from_nanos(u64::try_from(grid).unwrap_or(u64::MAX));
        let mut watches = std::mem::take(&mut self.looks.watches);
        for watch in &mut watches {
            self.look_at(watch);
        }
        self.looks.watches = watches;
        self.look_at_models();
    }

    /// A component is looked at while it runs, or hangs, and is the instance that it was.
    fn look_at(&mut self, watch: &mut Watch) {
        let component = &self.components[watch.component];
        let same = component.incarnation == watch.incarnation;
        watch.incarnation = component.incarnation;
        let runs = component.state == State::Active || self.now < component.hanging_until;
        let goes_on = same && runs;
        let found = match &mut watch.what {
            What::Age(freshness, _) if !goes_on => {
                freshness.disarm();
                None
            }
            What::Work(heartbeat) if !goes_on => {
                heartbeat.disarm(component.cycles);
                None
            }
            _ if !goes_on => None,
            What::Age(freshness, port) => {
                let newest = self.wiring.newest(watch.component, port);
                verdict(freshness.step(self.now, newest), FaultKind::Stale)
            }
            What::Work(heartbeat) => {
                let found = heartbeat.step(self.now, component.cycles);
                verdict(found, FaultKind::HeartbeatMissed)
            }
            What::Overruns(overruns) => {
                let found = overruns.step(self.now, component.overruns);
                verdict(found, FaultKind::Overrun)
            }
            What::Memory if self.misfortune.leaks(watch.component, self.now) => {
                Some(Some(FaultKind::MemoryExceeded))
            }
            What::Memory => Some(None),
        };
        match found {
            Some(Some(kind)) => {
                watch.complaining = true;
                let port = match &watch.what {
                    What::Age(_, port) => port.clone(),
                    _ => String::new(),
                };
                self.complain(watch.component, watch.detector, kind, &port);
            }
            Some(None) if std::mem::take(&mut watch.complaining) => {
                self.observe(Observation::Passed(watch.detector));
            }
            Some(None) | None => {}
        }
    }
}

/// What is to be said of a finding: a symptom of a kind, or that all is well.
fn verdict<E>(found: Option<Finding<E>>, kind: FaultKind) -> Option<Option<FaultKind>> {
    found.map(|found| match found {
        Finding::Passed => None,
        Finding::Violated(_) => Some(kind),
    })
}
