//! The fault manager's event outputs: components hear of confirmed faults and of emergency stops.

use std::sync::Arc;

use system_model::specification::ManagerPort;

use super::Supervisor;
use super::supervisor::Core;
use crate::port::{MailSender, Sent};
use crate::wake::Wake;

/// The fault manager is never replaced while its container runs.
const INCARNATION: u32 = 1;

/// Who is connected to the event outputs.
#[derive(Default)]
pub struct ManagerOutputs(Vec<Listener>);

struct Listener {
    port: ManagerPort,
    /// Instance name.
    component: String,
    sender: MailSender,
    wake: Arc<Wake>,
}

impl ManagerOutputs {
    /// Connects a component of this name to an output: `sender` leads to its inbox, `wake` wakes
    /// its executor.
    pub fn connect(
        &mut self,
        port: ManagerPort,
        component: String,
        sender: MailSender,
        wake: Arc<Wake>,
    ) {
        self.0.push(Listener {
            port,
            component,
            sender,
            wake,
        });
    }

    /// Raises an event; the components whose queues are full and that do not get it. Never waits.
    pub(super) fn raise(&mut self, port: ManagerPort, now_ns: u64) -> Vec<&str> {
        let connected = self.0.iter_mut().filter(|one| one.port == port);
        let deaf = connected.filter_map(|one| {
            let sent = one.sender.send(now_ns, INCARNATION, |_nothing| true);
            one.wake.wake();
            (sent != Sent::Queued).then_some(one.component.as_str())
        });
        deaf.collect()
    }
}

impl Supervisor {
    /// These components hear what the fault manager raises.
    pub fn set_outputs(&self, outputs: ManagerOutputs) {
        self.lock().outputs = outputs;
    }

    /// Tells those who listen; one that is too busy to be told is on record.
    pub(super) fn raise(&self, core: &mut Core, port: ManagerPort) {
        let now_ns = self.environment().clock.now_ns();
        for deaf in core.outputs.raise(port, now_ns) {
            self.notice(&format!(
                "'{deaf}' takes no events of the fault manager: '{}' is lost to it",
                port.name()
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::port::mailbox;

    #[test]
    fn who_does_not_listen_is_named_and_holds_nobody_up() {
        let mut outputs = ManagerOutputs::default();
        let mut inboxes = Vec::new();
        for (port, name, capacity) in [
            (ManagerPort::Fault, "display", 2),
            (ManagerPort::Fault, "deaf", 1),
            (ManagerPort::EmergencyStop, "horn", 1),
        ] {
            let (sender, inbox) = mailbox(capacity, 0);
            outputs.connect(port, name.to_owned(), sender, Arc::default());
            inboxes.push(inbox);
        }
        assert!(outputs.raise(ManagerPort::Fault, 5).is_empty());
        assert_eq!(outputs.raise(ManagerPort::Fault, 6), ["deaf"]);
        let mut heard = |index: usize| {
            let inbox: &mut crate::port::MailReceiver = &mut inboxes[index];
            std::iter::from_fn(move || inbox.take())
                .map(|event| event.stamp_ns())
                .collect::<Vec<_>>()
        };
        assert_eq!(heard(0), [5, 6]);
        assert_eq!(heard(1), [5]);
        assert!(heard(2).is_empty());
    }
}
