//! Self-adaptation in simulated time: it looks when it wants to, before what is executed at that time.

use super::Simulated;
use crate::adaptation::Adaptation;
use crate::component::mark_lost;
use crate::guard::loss::LostThread;
use crate::lane::Lane;

impl Simulated {
    /// Lets an adaptation look if it wants to before the next cycle, which is due at `next_ns`. None
    /// if nothing was to be done; false if the run ends before.
    pub(super) fn adapt_if_due(&mut self, next_ns: Option<u64>, lane: &Lane) -> Option<bool> {
        let (adaptation, due_ns) = self.next_adaptation()?;
        if next_ns.is_some_and(|next_ns| next_ns < due_ns) || self.is_over(next_ns) {
            return None;
        }
        if due_ns > self.environment.clock.now_ns() && !self.advance(due_ns) {
            return Some(false);
        }
        self.adapt(adaptation, lane);
        Some(true)
    }

    /// Whether the thread was lost while an adaptation looked; what follows of that has been done.
    pub(super) fn lost_in_adaptation(&mut self, lost: &LostThread) -> bool {
        let adapting = self.adapting.take();
        let Some(adaptation) = adapting.and_then(|index| self.adaptations.get_mut(index)) else {
            return false;
        };
        if !adaptation.after_loss() {
            mark_lost(&self.components, lost, false);
        }
        true
    }

    /// The adaptation that wants to look first, and when.
    fn next_adaptation(&self) -> Option<(usize, u64)> {
        let due = self.adaptations.iter().map(Adaptation::due_ns);
        due.enumerate().min_by_key(|(_, due_ns)| *due_ns)
    }

    /// What it runs of components is in the background: it keeps no executor busy.
    fn adapt(&mut self, index: usize, lane: &Lane) {
        self.adapting = Some(index);
        self.adaptations[index].look(lane);
        self.adapting = None;
        self.environment.busy.take_ns();
        self.serve(lane);
    }
}
