//! What the properties know of each component without the fault manager.

use std::time::Duration;

use fault_manager::ActionId;

use crate::oracle::Level;

/// What has become of one component in fact.
#[derive(Debug, Clone)]
pub struct Fact {
    pub incarnation: u32,
    pub in_error: bool,
    /// The action that has been asked for and has not ended.
    pub open: Option<ActionId>,
    pub awaits_first_cycle: bool,
    pub down: Level,
    /// Resets since the last replacement that worked, or clear.
    pub resets: Vec<Duration>,
    /// Resets since the component last worked.
    pub in_vain: u32,
    pub replacements: usize,
    /// The last one has not worked yet.
    pub replacing: bool,
}

impl Fact {
    /// It works: resets of a secondary that does are counted from nothing.
    pub fn works(&mut self) {
        self.in_vain = 0;
        if std::mem::take(&mut self.replacing) {
            self.resets.clear();
        }
    }
}
