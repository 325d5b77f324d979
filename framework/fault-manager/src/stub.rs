use crate::*;
use std::time::Duration;
pub struct FaultManager;
pub struct Scope {
    pub specification: system_model::specification::ApplicationSpecification,
    pub rules: system_model::rules::FaultRules,
}
impl FaultManager {
    pub fn new(_: Vec<Scope>) -> Self {
        Self
    }
    pub fn detectors(&self) -> &[Detector] {
        &[]
    }
    pub fn detector(&self, _: usize, _: &DetectorKind) -> Option<DetectorId> {
        None
    }
    pub fn observe(&mut self, _: Duration, _: Observation) -> Vec<Effect> {
        vec![]
    }
    pub fn due(&self) -> Option<Duration> {
        None
    }
    pub fn verdicts(&self) -> impl Iterator<Item = &Verdict> {
        [].into_iter()
    }
    pub fn is_emergency(&self) -> bool {
        false
    }
}
