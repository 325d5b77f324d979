//! The end of a change: the old connections and components are given up, or the new ones are.

use system_model::life_cycle::Operation;

use super::local::LocalRobot;
use super::wiring::added;
use crate::lane::Lane;

impl LocalRobot {
    /// The new way of doing the task is good: what is not needed any more goes to sleep.
    pub(super) fn finish(&mut self, lane: &Lane) {
        let Some(change) = self.change.take() else {
            return;
        };
        let (present, wanted) = (self.hops(&change.before), self.hops(&change.wanted));
        let stays = self.members(&change.wanted);
        for hop in added(&present, &wanted) {
            let mut switches = change.switches.iter();
            let aside = switches.find(|it| (it.hop.link, it.hop.to) == (hop.link, hop.to));
            match aside.and_then(|switch| switch.aside.as_ref()) {
                Some(old) => self.release(&hop, old, lane),
                None => self.disconnect(&hop, lane),
            }
        }
        for component in self.members(&change.before) {
            if !stays.contains(&component) {
                self.put_to_sleep(component, lane);
            }
        }
    }

    /// Takes back all that was done of the change; what ran goes on.
    pub fn go_back(&mut self, lane: &Lane) {
        let count = self.change.as_ref().map_or(0, |it| it.switches.len());
        for index in 0..count {
            let is_done = self
                .change
                .as_ref()
                .is_some_and(|it| it.switches[index].is_done);
            if is_done && let Err(how) = self.exchange(index, lane) {
                self.notice(&how);
            }
        }
        let Some(change) = self.change.take() else {
            return;
        };
        for switch in &change.switches {
            if let Some(new) = &switch.aside {
                self.release(&switch.hop, new, lane);
            }
        }
        let new = added(&self.hops(&change.wanted), &self.hops(&change.before));
        for hop in new {
            let mut switches = change.switches.iter();
            if !switches.any(|it| it.hop == hop) {
                self.disconnect(&hop, lane);
            }
        }
        for (component, _) in change.started {
            self.put_to_sleep(component, lane);
        }
    }

    /// Stops a component that the task is done without.
    pub(super) fn put_to_sleep(&self, index: usize, lane: &Lane) {
        self.statuses[index].set_dormant(true);
        match self.enter(index, lane) {
            Ok(mut component) if component.is_active() => {
                // That it fails is on record, and it does not run any more.
                let _recorded = component.operate(Operation::Stop, lane.loss());
            }
            Ok(_) => {}
            Err(how) => self.notice(&how),
        }
    }
}
