//! Whose data are obeyed, where more than one robot may send: one fence for each input.
//!
//! Every datum from another robot says in which term it was sent, by whom, and in which of the
//! sender's lives. A later term is stronger; of one term the first name; of one robot its latest
//! life. What is weaker than the strongest that has come is refused, so after a partition no
//! actuator obeys two masters, whatever they think of themselves. Only when the one that is obeyed
//! has died another one of its term takes its place: no new reign begins if it was not the one who
//! decides.

use std::cmp::Ordering;

/// On whose behalf a datum comes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Claim {
    /// Term of the reign in which it was sent.
    pub term: u64,
    /// Who has sent it.
    pub robot: String,
    /// In which life.
    pub incarnation: u64,
}

/// A datum was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{} (term {}, life {}) is not obeyed: {} (term {}, life {}) is",
    offered.robot, offered.term, offered.incarnation, obeyed.robot, obeyed.term, obeyed.incarnation
)]
pub struct Refused {
    /// Who is obeyed.
    pub obeyed: Claim,
    /// Who is not.
    pub offered: Claim,
}

/// What an input has seen so far.
#[derive(Debug, Clone, Default)]
pub struct Fence {
    strongest: Option<Claim>,
    /// Whether the strongest has died since.
    is_vacant: bool,
}

impl Claim {
    fn strength(&self, other: &Self) -> Ordering {
        let terms = self.term.cmp(&other.term);
        let names = other.robot.cmp(&self.robot);
        terms
            .then(names)
            .then(self.incarnation.cmp(&other.incarnation))
    }
}

impl Fence {
    /// A robot has died. Returns whether its data were the last ones to pass.
    pub fn died(&mut self, robot: &str) -> bool {
        let obeyed = self.strongest.as_ref();
        let is_obeyed = obeyed.is_some_and(|claim| claim.robot == robot);
        self.is_vacant |= is_obeyed;
        is_obeyed
    }

    /// Lets a datum pass, or not. Allocates only when another one is obeyed than before.
    ///
    /// # Errors
    /// When a stronger one has come before.
    pub fn admit(&mut self, term: u64, robot: &str, incarnation: u64) -> Result<(), Refused> {
        if let Some(obeyed) = &self.strongest {
            let is_same = obeyed.robot == robot && obeyed.incarnation == incarnation;
            if is_same && obeyed.term == term {
                self.is_vacant = false;
                return Ok(());
            }
        }
        let offered = Claim {
            term,
            robot: robot.to_owned(),
            incarnation,
        };
        match &self.strongest {
            Some(obeyed) if is_weaker(&offered, obeyed, self.is_vacant) => Err(Refused {
                obeyed: obeyed.clone(),
                offered,
            }),
            _ => {
                self.strongest = Some(offered);
                self.is_vacant = false;
                Ok(())
            }
        }
    }
}

/// A robot's own earlier life is weaker in whatever term it speaks. Who is dead keeps nobody of its
/// own term away.
fn is_weaker(offered: &Claim, obeyed: &Claim, is_dead: bool) -> bool {
    let is_same = offered.robot == obeyed.robot;
    let is_earlier_life = is_same && offered.incarnation < obeyed.incarnation;
    let is_heir = is_dead && !is_same && offered.term == obeyed.term;
    is_earlier_life || !is_heir && offered.strength(obeyed) == Ordering::Less
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_weaker_of_two_masters_is_refused() {
        type Case<'a> = (&'a [(u64, &'a str, u64)], &'a [bool]);
        let cases: [Case<'_>; 6] = [
            (&[(1, "R1", 1), (1, "R1", 1)], &[true, true]),
            // The partition has healed: R1 reigns anew, R2 does not know yet.
            (
                &[(2, "R2", 1), (3, "R1", 1), (2, "R2", 1), (3, "R1", 1)],
                &[true, true, false, true],
            ),
            // R2 has learnt the term before it has learnt to be silent.
            (&[(3, "R1", 1), (3, "R2", 1)], &[true, false]),
            (
                &[(3, "R2", 1), (3, "R1", 1), (3, "R2", 1)],
                &[true, true, false],
            ),
            // R1 has died, R2 takes over; R1 comes back as it was.
            (
                &[(1, "R1", 1), (2, "R2", 1), (1, "R1", 1)],
                &[true, true, false],
            ),
            // An earlier life of R1, in a later term.
            (&[(1, "R1", 5), (2, "R1", 4)], &[true, false]),
        ];
        for (claims, expected) in cases {
            let mut fence = Fence::default();
            let admitted: Vec<bool> = claims
                .iter()
                .map(|(term, robot, life)| fence.admit(*term, robot, *life).is_ok())
                .collect();
            assert_eq!(admitted, expected, "{claims:?}");
        }
    }

    #[test]
    fn who_is_dead_keeps_nobody_of_its_term_away() {
        let mut fence = Fence::default();
        let admits = |fence: &mut Fence, term, robot| fence.admit(term, robot, 1).is_ok();
        assert!(admits(&mut fence, 2, "R1") && !admits(&mut fence, 2, "R2"));
        assert!(!fence.died("R2") && !admits(&mut fence, 2, "R2"));
        // Dead, and heard all the same: not dead.
        assert!(fence.died("R1") && admits(&mut fence, 2, "R1") && !admits(&mut fence, 2, "R2"));
        assert!(fence.died("R1") && !admits(&mut fence, 1, "R2") && admits(&mut fence, 2, "R3"));
        assert!(admits(&mut fence, 2, "R2") && !admits(&mut fence, 2, "R3"));
        // It was only out of hearing.
        assert!(admits(&mut fence, 2, "R1") && !admits(&mut fence, 2, "R2"));
    }

    #[test]
    fn a_refusal_names_both() {
        let mut fence = Fence::default();
        fence.admit(3, "R1", 7).expect("the first");
        let refused = fence.admit(2, "R2", 9).expect_err("a weaker one");
        assert_eq!(
            refused.to_string(),
            "R2 (term 2, life 9) is not obeyed: R1 (term 3, life 7) is"
        );
    }

    proptest! {
        /// Whatever comes in whatever order: once refused for a term, a robot is refused until its
        /// own claim gets stronger, and the term that is obeyed never falls.
        #[test]
        fn the_term_that_is_obeyed_never_falls(
            claims in proptest::collection::vec((0_u64..4, 0_u8..3, 0_u64..3), 0..60)
        ) {
            let mut fence = Fence::default();
            let mut highest = 0;
            for (term, robot, life) in claims {
                if fence.admit(term, &format!("R{robot}"), life).is_ok() {
                    prop_assert!(term >= highest);
                    highest = term;
                }
            }
        }
    }
}
