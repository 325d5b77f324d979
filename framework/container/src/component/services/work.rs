//! What a component has in work: data and messages that it took in this cycle. When it dies they
//! are given to its successor, and set aside when that dies too.

use super::Services;
use crate::component::port_end::PortEnd;
use crate::event_log::Event;
use crate::port::{Leftover, Receiver};

impl Services {
    /// A cycle begins.
    #[inline]
    pub(in crate::component) fn begin_cycle(&mut self, now_ns: u64) {
        self.cycle_ns = now_ns;
        self.in_work = 0;
        self.contaminated = false;
    }

    /// The cycle's data have been worked on, and what came of them is sent: whoever dies later takes
    /// none of them along, and its successor would do it twice.
    #[inline]
    pub(in crate::component) fn work_done(&mut self) {
        self.in_work = 0;
    }

    /// When the cycle began, in nanoseconds of the container's clock.
    #[inline]
    pub(in crate::component) fn cycle_ns(&self) -> u64 {
        self.cycle_ns
    }

    /// Whether an output of this cycle failed its check.
    #[inline]
    pub(in crate::component) fn is_contaminated(&self) -> bool {
        self.contaminated
    }

    pub(in crate::component) fn inboxes(&self) -> usize {
        self.inboxes.len()
    }

    /// Takes the next message into work: port, method, content and its size. The content stays
    /// where it is until [`Self::message_done`].
    pub(in crate::component) fn take_message(
        &mut self,
        inbox: usize,
    ) -> Option<(u32, Option<u32>, *const u8, usize)> {
        let inbox = self.inboxes.get_mut(inbox)?;
        if !inbox.take() {
            return None;
        }
        let content = inbox.in_work.as_ref()?.bytes();
        Some((inbox.port, inbox.method, content.as_ptr(), content.len()))
    }

    /// Whether an incarnation died with the message in work that this inbox has.
    pub(in crate::component) fn has_leftover(&self, inbox: usize) -> bool {
        self.inboxes
            .get(inbox)
            .is_some_and(|inbox| inbox.deaths > 0)
    }

    pub(in crate::component) fn message_done(&mut self, inbox: usize) {
        if let Some(inbox) = self.inboxes.get_mut(inbox) {
            inbox.done();
        }
    }

    /// Forgets all data and events that have arrived (onStop).
    pub(in crate::component) fn clear_inputs(&mut self) {
        for port in &mut self.ports {
            if let PortEnd::DataInput(input) = port
                && let Some(receiver) = &mut input.source
            {
                receiver.clear();
            }
        }
        for inbox in &mut self.inboxes {
            inbox.clear();
        }
    }

    /// The component failed. What it had in work goes to its successor, once; after a failure that
    /// it survives (`runs`) it is done with.
    pub(in crate::component) fn leave_work(&mut self, runs: bool) {
        let in_work = std::mem::take(&mut self.in_work);
        if runs {
            return;
        }
        let mut aside = Vec::new();
        for (index, port) in self.ports.iter_mut().enumerate() {
            let taken = u32::try_from(index).is_ok_and(|index| in_work & super::bit(index) != 0);
            if let PortEnd::DataInput(input) = port
                && taken
                && let Some(Leftover::SetAside { stamp_ns }) =
                    input.source.as_mut().map(Receiver::leave)
            {
                aside.push((index, stamp_ns));
            }
        }
        for inbox in &mut self.inboxes {
            if let Some(Leftover::SetAside { stamp_ns }) = inbox.leave() {
                aside.push((inbox.port as usize, stamp_ns));
            }
        }
        for (port, stamp_ns) in aside {
            self.record(Event::DatumSetAside {
                component: self.name.to_string(),
                port: self.port_name(port),
                stamp_ns,
            });
        }
    }
}
