//! The thread that knows who is alive, says that this robot is, and tells of faults.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use crossbeam::channel::Receiver as Channel;
use fault_manager::FaultState;
use robot_network::message::{Beat, FaultNotice};
use robot_network::{Change, Heard, Leadership, Membership, Node, Role};

use super::inputs::Listening;
use super::shared::{Shared, TeamView};
use crate::event_log::Event;

/// Beats within the limit of silence: one that is lost, or late by a busy machine, is no death.
const BEATS_IN_LIMIT: u32 = 5;

/// What the thread holds.
pub(super) struct Team {
    node: Arc<Node>,
    inputs: Listening,
    verdicts: Channel<(u64, Event)>,
    shared: Arc<Shared>,
    membership: Membership,
    leadership: Leadership,
    beat_period: Duration,
    /// Who decides is asked only once the others have had time to be heard.
    settled_at: Duration,
}

impl Team {
    pub(super) fn new(
        node: Arc<Node>,
        inputs: Listening,
        verdicts: Channel<(u64, Event)>,
        shared: Arc<Shared>,
        silence_limit: Duration,
    ) -> Self {
        Self {
            node,
            inputs,
            verdicts,
            membership: Membership::new(&shared.robot, shared.incarnation, silence_limit),
            leadership: Leadership::new(&shared.robot),
            beat_period: silence_limit / BEATS_IN_LIMIT,
            settled_at: shared.now() + silence_limit,
            shared,
        }
    }

    /// Goes on until it is to stop.
    pub(super) fn run(mut self) {
        let mut beat_at = Duration::ZERO;
        while !self.shared.stopping.load(Ordering::Acquire) {
            let now = self.shared.now();
            if now >= beat_at {
                self.beat();
                beat_at = now + self.beat_period;
            }
            let limit = beat_at.saturating_sub(now);
            if let Some(heard) = self.node.heard(limit) {
                self.hear(heard);
            }
            let changes = self.membership.look(self.shared.now());
            self.follow(changes);
            self.look_who_decides();
            self.show_team();
            self.tell_of_faults();
        }
    }

    fn beat(&self) {
        // A session that takes nothing has ended: the others see that this robot has gone.
        let _ended = self.node.beat(&Beat {
            incarnation: self.shared.incarnation,
            term: self.leadership.term(),
            decider: self.leadership.decider().map(str::to_owned),
        });
    }

    fn hear(&mut self, heard: Heard) {
        let now = self.shared.now();
        match heard {
            Heard::Alive { robot, incarnation } => {
                let changes = self.membership.heard(&robot, incarnation, now);
                self.follow(changes);
            }
            Heard::Gone { robot, incarnation } => {
                let change = self.membership.withdrawn(&robot, incarnation);
                self.follow(change.into_iter().collect());
            }
            Heard::Beat { robot, beat } => {
                let changes = self.membership.heard(&robot, beat.incarnation, now);
                self.follow(changes);
                if robot != self.shared.robot {
                    let decider = beat.decider.as_deref();
                    let role = self.leadership.heard(&robot, decider, beat.term);
                    self.take_role(role);
                }
            }
            Heard::Fault { robot, notice } => {
                let message = format!("{}: {}", notice.component, notice.kind);
                self.shared.record(&robot, "fault", message);
            }
            Heard::Unintelligible { key, reason } => {
                self.shared.record(&key, "unintelligible", reason);
            }
        }
    }

    fn follow(&self, changes: Vec<Change>) {
        for change in changes {
            match change {
                Change::Appeared { robot, incarnation } => {
                    self.shared
                        .record(&robot, "appeared", format!("life {incarnation}"));
                }
                Change::Died { robot, death, .. } => {
                    self.inputs.died(&robot);
                    self.shared.gates.died(&robot);
                    self.shared.record(&robot, "died", death.to_string());
                }
                Change::Namesake { incarnation } => {
                    let message = format!(
                        "another robot has this name (life {incarnation}); give each a name of \
                         its own: <network name=\"…\">"
                    );
                    self.shared.record(&self.shared.robot, "namesake", message);
                }
            }
        }
    }

    fn look_who_decides(&mut self) {
        if self.shared.now() >= self.settled_at {
            let role = self.leadership.look(&self.membership.alive());
            self.take_role(role);
        }
    }

    /// Tells the tasks that this robot does with others.
    fn show_team(&self) {
        let alive = self.membership.alive();
        self.shared.set_team(TeamView {
            decider: self.leadership.decider().map(str::to_owned),
            alive: alive.into_iter().map(str::to_owned).collect(),
        });
    }

    fn take_role(&mut self, role: Option<Role>) {
        self.shared
            .term
            .store(self.leadership.term(), Ordering::Relaxed);
        let decider = match role {
            None => return,
            Some(Role::Decides { .. }) => {
                // The others are to know before the next beat is due.
                self.beat();
                self.shared.robot.clone()
            }
            Some(Role::Follows { decider }) => decider,
        };
        let message = format!("term {}", self.leadership.term());
        self.shared.record(&decider, "decides", message);
    }

    fn tell_of_faults(&self) {
        while let Ok((t_ns, event)) = self.verdicts.try_recv() {
            let Event::Verdict(verdict) = event else {
                continue;
            };
            if verdict.state == FaultState::Confirmed && verdict.actions.is_empty() {
                let _ended = self.node.say_fault(&FaultNotice {
                    component: verdict.component.clone(),
                    kind: verdict.kind.to_string(),
                    t_ns,
                });
            }
        }
    }
}
