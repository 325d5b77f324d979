//! What a run that died has left to a component of the next one.

use std::time::Duration;

use system_model::life_cycle::LifeCycleState;

use super::{Component, OperationError};
use crate::event_log::Event;
use crate::guard::Callback;
use crate::guard::loss::Loss;
use crate::persistence::CopySender;

/// A checkpoint of a run that died.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Inheritance {
    /// The last incarnation of that run.
    pub incarnation: u32,
    /// Number of the checkpoint.
    pub sequence: u64,
    /// How old it is.
    pub age: Duration,
    /// The memory.
    pub memory: Vec<u8>,
}

impl Component {
    /// Copies of its registered memory are handed over there as well, from the next checkpoint on.
    /// Does nothing if no checkpoints are taken.
    pub fn persist_checkpoints(&mut self, disk: CopySender) {
        if let Some(checkpoints) = &mut self.checkpoints {
            checkpoints.disk = Some(disk);
        }
    }

    /// How many bytes it has registered; none if it has registered nothing.
    pub fn registered_bytes(&self) -> Option<usize> {
        self.services.critical().map(|memory| memory.size())
    }

    /// A copy of its registered memory, if it has registered any.
    pub fn critical_copy(&self) -> Option<Vec<u8>> {
        let memory = self.services.critical_memory()?;
        let mut bytes = vec![0; memory.size()];
        memory.copy_to(&mut bytes).then_some(bytes)
    }

    /// Fills its registered memory; whether it has registered so much.
    pub fn set_critical(&mut self, bytes: &[u8]) -> bool {
        let memory = self.services.critical();
        memory.is_some_and(|memory| memory.size() == bytes.len() && memory.copy_from(bytes))
    }

    /// What a run that died has left to it: restored by [`Self::inherit`]. Does nothing if no
    /// checkpoints are taken.
    pub fn set_inheritance(&mut self, inheritance: Inheritance) {
        if let Some(checkpoints) = &mut self.checkpoints {
            checkpoints.inheritance = Some(inheritance);
        }
    }

    /// Goes on from what a run that died has left, if there is anything: another incarnation, its
    /// memory restored, `onRecover`. One that has failed while it was initialised gets it by its
    /// first recovery. If `onRecover` fails the component is in ERROR, and recovered without it.
    pub fn inherit(&mut self, loss: &Loss) {
        let checkpoints = self.checkpoints.as_mut();
        let Some(inheritance) = checkpoints.and_then(|it| it.inheritance.take()) else {
            return;
        };
        self.begin_incarnation(inheritance.incarnation.saturating_add(1));
        let gets_it = match self.state() {
            LifeCycleState::Ready => self.restore_inherited(&inheritance, loss),
            _failed => true,
        };
        if gets_it && let Some(checkpoints) = &mut self.checkpoints {
            checkpoints.inherit(inheritance.sequence, inheritance.memory);
        }
    }

    fn restore_inherited(&mut self, inheritance: &Inheritance, loss: &Loss) -> bool {
        let memory = self.services.critical();
        let fits = memory.filter(|memory| memory.size() == inheritance.memory.len());
        let restored = fits.is_some_and(|memory| memory.copy_from(&inheritance.memory));
        self.tell_inherited(inheritance, restored);
        restored && self.recover_inherited(loss)
    }

    fn recover_inherited(&mut self, loss: &Loss) -> bool {
        let result = self.call_back(Callback::Recover, "onRecover", loss);
        if let Err(OperationError::Failed(fault)) = &result {
            self.enter_state(LifeCycleState::Error);
            self.report_error_at_start(fault);
        }
        result.is_ok()
    }

    fn tell_inherited(&self, inheritance: &Inheritance, restored: bool) {
        let component = self.name.to_string();
        self.services.record(if restored {
            Event::CheckpointRestored {
                component,
                incarnation: self.services.incarnation(),
                sequence: inheritance.sequence,
                age_ms: u64::try_from(inheritance.age.as_millis()).unwrap_or(u64::MAX),
            }
        } else {
            let message = format!(
                "checkpoint {} is not restored: '{component}' registers no such memory when it is \
                 initialised",
                inheritance.sequence
            );
            Event::Notice { message }
        });
    }
}
