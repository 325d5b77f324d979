//! Who is alive.
//!
//! A robot shows that it is alive by a token that its peers see vanish when the connection ends,
//! and by beats: a machine that hangs keeps its connection. Whoever is silent for longer than the
//! limit counts as dead, whatever its token says.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

/// More robots than a team has; a name in every beat must not take memory without end.
const PEERS_MAXIMUM: usize = 256;

/// The robots that one robot knows.
#[derive(Debug, Clone)]
pub struct Membership {
    own: String,
    own_incarnation: u64,
    silence_limit: Duration,
    peers: BTreeMap<String, Peer>,
}

#[derive(Debug, Clone, Copy)]
struct Peer {
    incarnation: u64,
    heard: Duration,
    is_alive: bool,
}

/// What has changed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Change {
    /// A robot is there, for the first time or again.
    Appeared {
        /// Its name.
        robot: String,
        /// Which of its lives this is.
        incarnation: u64,
    },
    /// A robot is dead, or as good as that: what it sends is not waited for.
    Died {
        /// Its name.
        robot: String,
        /// Which of its lives that was.
        incarnation: u64,
        /// How that is known.
        death: Death,
    },
    /// Another robot says that it has this one's name; it is not listened to.
    Namesake {
        /// Of the other one.
        incarnation: u64,
    },
}

/// How a death is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Death {
    /// Its token is gone: it has left, or its process has ended.
    Gone,
    /// Nothing was heard of it for so long.
    Silent(Duration),
    /// It has begun a new life without a word about the end of the last one.
    Restarted,
}

impl fmt::Display for Death {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gone => write!(formatter, "it has gone"),
            Self::Silent(time) => write!(formatter, "silent for {} ms", time.as_millis()),
            Self::Restarted => write!(formatter, "it was started again"),
        }
    }
}

impl Membership {
    /// A robot that knows nobody yet. Who is silent for longer than `silence_limit` is dead.
    pub fn new(own: &str, own_incarnation: u64, silence_limit: Duration) -> Self {
        Self {
            own: own.to_owned(),
            own_incarnation,
            silence_limit,
            peers: BTreeMap::new(),
        }
    }

    /// A sign of life of a robot.
    pub fn heard(&mut self, robot: &str, incarnation: u64, now: Duration) -> Vec<Change> {
        if robot == self.own {
            let is_another = incarnation != self.own_incarnation;
            return Vec::from_iter(is_another.then_some(Change::Namesake { incarnation }));
        }
        if self.peers.len() >= PEERS_MAXIMUM && !self.peers.contains_key(robot) {
            return Vec::new();
        }
        let before = self.peers.get(robot).copied();
        // What an earlier life has sent may arrive late.
        if before.is_some_and(|peer| incarnation < peer.incarnation) {
            return Vec::new();
        }
        let peer = Peer {
            incarnation,
            heard: now,
            is_alive: true,
        };
        self.peers.insert(robot.to_owned(), peer);
        let appeared = Change::Appeared {
            robot: robot.to_owned(),
            incarnation,
        };
        match before {
            Some(peer) if peer.is_alive && peer.incarnation == incarnation => Vec::new(),
            Some(peer) if peer.is_alive => {
                vec![died(robot, peer, Death::Restarted), appeared]
            }
            _ => vec![appeared],
        }
    }

    /// The token of one of a robot's lives is gone.
    pub fn withdrawn(&mut self, robot: &str, incarnation: u64) -> Option<Change> {
        let peer = self.peers.get_mut(robot)?;
        if !peer.is_alive || peer.incarnation != incarnation {
            return None;
        }
        peer.is_alive = false;
        Some(died(robot, *peer, Death::Gone))
    }

    /// Those who have been silent for too long by now.
    pub fn look(&mut self, now: Duration) -> Vec<Change> {
        let limit = self.silence_limit;
        let silent = self.peers.iter_mut().filter_map(|(robot, peer)| {
            let silence = now.saturating_sub(peer.heard);
            if !peer.is_alive || silence <= limit {
                return None;
            }
            peer.is_alive = false;
            Some(died(robot, *peer, Death::Silent(silence)))
        });
        silent.collect()
    }

    /// The names of all robots that are alive, this one among them, in order.
    pub fn alive(&self) -> Vec<&str> {
        let peers = self.peers.iter().filter(|(_, peer)| peer.is_alive);
        let mut alive: Vec<&str> = peers.map(|(robot, _)| robot.as_str()).collect();
        alive.push(&self.own);
        alive.sort_unstable();
        alive
    }

    /// Whether a robot is alive.
    pub fn is_alive(&self, robot: &str) -> bool {
        robot == self.own || self.peers.get(robot).is_some_and(|peer| peer.is_alive)
    }
}

fn died(robot: &str, peer: Peer, death: Death) -> Change {
    Change::Died {
        robot: robot.to_owned(),
        incarnation: peer.incarnation,
        death,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: Duration = Duration::from_millis(500);

    /// What happens, at a time in ms: a beat, a token that goes, nothing.
    enum Step {
        Beat(&'static str, u64),
        Gone(&'static str, u64),
        Look,
    }
    use Step::{Beat, Gone, Look};

    /// Changes in words.
    fn play(steps: &[(u64, Step)]) -> Vec<String> {
        let mut membership = Membership::new("R1", 7, LIMIT);
        let mut words = Vec::new();
        for (time_ms, step) in steps {
            let now = Duration::from_millis(*time_ms);
            let changes = match step {
                Beat(robot, incarnation) => membership.heard(robot, *incarnation, now),
                Gone(robot, incarnation) => {
                    Vec::from_iter(membership.withdrawn(robot, *incarnation))
                }
                Look => membership.look(now),
            };
            words.extend(changes.iter().map(|change| match change {
                Change::Appeared { robot, incarnation } => format!("{robot}.{incarnation} +"),
                Change::Died {
                    robot,
                    incarnation,
                    death,
                } => format!("{robot}.{incarnation} - {death}"),
                Change::Namesake { incarnation } => format!("namesake.{incarnation}"),
            }));
        }
        words
    }

    #[test]
    fn who_is_alive_follows_from_beats_tokens_and_time() {
        type Case<'a> = (&'a [(u64, Step)], &'a [&'a str]);
        let cases: [Case<'_>; 8] = [
            (&[(0, Beat("R2", 1)), (100, Beat("R2", 1))], &["R2.1 +"]),
            (
                &[(0, Beat("R2", 1)), (500, Look), (501, Look), (900, Look)],
                &["R2.1 +", "R2.1 - silent for 501 ms"],
            ),
            (
                &[(0, Beat("R2", 1)), (10, Gone("R2", 1)), (999, Look)],
                &["R2.1 +", "R2.1 - it has gone"],
            ),
            // A connection that was lost for a moment.
            (
                &[(0, Beat("R2", 1)), (10, Gone("R2", 1)), (20, Beat("R2", 1))],
                &["R2.1 +", "R2.1 - it has gone", "R2.1 +"],
            ),
            // A new life; the token and the last beat of the old one come late.
            (
                &[
                    (0, Beat("R2", 1)),
                    (10, Beat("R2", 2)),
                    (20, Gone("R2", 1)),
                    (30, Beat("R2", 1)),
                ],
                &["R2.1 +", "R2.1 - it was started again", "R2.2 +"],
            ),
            (&[(0, Gone("R2", 1)), (10, Look)], &[]),
            (&[(0, Beat("R1", 7))], &[]),
            (&[(0, Beat("R1", 8))], &["namesake.8"]),
        ];
        for (number, (steps, expected)) in cases.iter().enumerate() {
            assert_eq!(play(steps), *expected, "case {number}");
        }
    }

    #[test]
    fn the_living_are_listed_in_order_and_have_a_bound() {
        let mut membership = Membership::new("R5", 1, LIMIT);
        for number in (0..1000).rev() {
            membership.heard(&format!("S{number:03}"), 1, Duration::ZERO);
        }
        let alive = membership.alive();
        assert_eq!((alive.len(), alive[0]), (PEERS_MAXIMUM + 1, "R5"));
        assert!(alive.is_sorted() && membership.is_alive("S999") && !membership.is_alive("S000"));
    }
}
