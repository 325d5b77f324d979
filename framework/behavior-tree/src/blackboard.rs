//! All blackboards of a tree in one row of slots; which key of which tree is which slot was found
//! when the tree was compiled.

use crate::plan::Plan;
use crate::script::Environment;
use crate::value::Value;

#[derive(Debug)]
pub(crate) struct Blackboard {
    slots: Vec<Slot>,
    names: Vec<String>,
}

#[derive(Debug, Clone)]
struct Slot {
    value: Option<Value>,
    /// How often it was written.
    writes: u64,
    is_declared: bool,
}

impl Blackboard {
    pub(crate) fn new(plan: &Plan) -> Self {
        let slot = |entry: &crate::plan::Entry| Slot {
            value: entry.initial.clone(),
            writes: u64::from(entry.initial.is_some()),
            is_declared: entry.is_declared,
        };
        Self {
            slots: plan.entries.iter().map(slot).collect(),
            names: plan.entries.iter().map(|it| it.name.clone()).collect(),
        }
    }

    /// How often a slot was written; 0 if it holds nothing.
    pub(crate) fn writes(&self, slot: usize) -> u64 {
        let slot = &self.slots[slot];
        match slot.value {
            Some(_) => slot.writes,
            None => 0,
        }
    }

    pub(crate) fn unset(&mut self, slot: usize) {
        self.slots[slot].value = None;
        self.slots[slot].is_declared = false;
    }
}

impl Environment for Blackboard {
    fn get(&self, slot: usize) -> Option<&Value> {
        self.slots[slot].value.as_ref()
    }

    fn is_declared(&self, slot: usize) -> bool {
        self.slots[slot].is_declared
    }

    fn set(&mut self, slot: usize, value: Value) {
        let slot = &mut self.slots[slot];
        slot.value = Some(value);
        slot.writes += 1;
        slot.is_declared = true;
    }

    fn name(&self, slot: usize) -> String {
        self.names[slot].clone()
    }
}
