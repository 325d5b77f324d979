//! Events, awaited and raised.

use std::sync::Arc;
use std::time::Duration;

use behavior_tree::{Leaf, LeafContext, Status};

use super::milliseconds;
use crate::clock::nanoseconds;
use crate::mission::reach::Reach;
use crate::port::{MailReceiver, MailSender, Sent};
use crate::wake::Wake;

/// Waits for an event.
pub(in crate::mission) struct WaitForEvent {
    messages: MailReceiver,
    deadline: Duration,
}

impl WaitForEvent {
    pub(in crate::mission) fn new(messages: MailReceiver) -> Self {
        Self {
            messages,
            deadline: Duration::ZERO,
        }
    }
}

impl Leaf for WaitForEvent {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        if context.begins {
            self.messages.clear();
            let timeout = milliseconds(context, "timeout_ms")?;
            self.deadline = context.now.saturating_add(timeout);
            return Ok(Status::Running);
        }
        if let Some(message) = self.messages.take() {
            self.messages.give_back(message);
            return Ok(Status::Success);
        }
        Ok(match context.now < self.deadline {
            true => Status::Running,
            false => Status::Failure,
        })
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}

/// Raises an event; its content is all zero.
pub(in crate::mission) struct RaiseEvent {
    pub(in crate::mission) reach: Arc<Reach>,
    pub(in crate::mission) sender: MailSender,
    pub(in crate::mission) wake: Arc<Wake>,
}

impl Leaf for RaiseEvent {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        let now_ns = nanoseconds(context.now);
        let incarnation = self.reach.incarnation(self.reach.tree()).max(1);
        let sent = self.sender.send(now_ns, incarnation, |bytes| {
            bytes.fill(0);
            true
        });
        Ok(match sent {
            Sent::Queued => {
                self.wake.wake();
                Status::Success
            }
            Sent::Full | Sent::Unreadable => Status::Failure,
        })
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}
