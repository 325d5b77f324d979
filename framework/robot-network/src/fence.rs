//! Whose data are obeyed, where more than one robot may send: one fence for each input.
//!
//! Every datum from another robot says in which term it was sent, by whom, and in which of the
//! sender's lives. A later term is stronger; of one term the first name; of one robot its latest
//! life. What is weaker than the strongest that has come is refused, so after a partition no
//! actuator obeys two masters, whatever they think of themselves.

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
    /// Whether the data of this robot were the last ones to pass.
    pub fn obeys(&self, robot: &str) -> bool {
        let obeyed = self.strongest.as_ref();
        obeyed.is_some_and(|claim| claim.robot == robot)
    }

    /// Lets a datum pass, or not. Allocates only when another one is obeyed than before.
    ///
    /// # Errors
    /// When a stronger one has come before.
    pub fn admit(&mut self, term: u64, robot: &str, incarnation: u64) -> Result<(), Refused> {
        if let Some(obeyed) = &self.strongest {
            let is_same = obeyed.robot == robot && obeyed.incarnation == incarnation;
            if is_same && obeyed.term == term {
                return Ok(());
            }
        }
        let offered = Claim {
            term,
            robot: robot.to_owned(),
            incarnation,
        };
        match &self.strongest {
            Some(obeyed) if is_weaker(&offered, obeyed) => Err(Refused {
                obeyed: obeyed.clone(),
                offered,
            }),
            _ => {
                self.strongest = Some(offered);
                Ok(())
            }
        }
    }
}

/// A robot's own earlier life is weaker in whatever term it speaks.
fn is_weaker(offered: &Claim, obeyed: &Claim) -> bool {
    let is_earlier_life = offered.robot == obeyed.robot && offered.incarnation < obeyed.incarnation;
    is_earlier_life || offered.strength(obeyed) == Ordering::Less
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
