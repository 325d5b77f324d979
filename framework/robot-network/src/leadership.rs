//! Who decides: of all robots alive the one whose name comes first.
//!
//! No vote is needed, for everybody who sees the same robots alive names the same one. Where they do
//! not see the same, in a partition, each part has a decider. So that no part obeys another one's
//! when they meet again, each beginning of a reign has a term, higher than any that its decider has
//! heard of; in doubt the higher term counts, and of two equal ones the first name.

/// What one robot thinks of who decides.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Leadership {
    own: String,
    decider: Option<String>,
    term: u64,
}

/// Who decides from now on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Role {
    /// This robot, in this term.
    Decides {
        /// The term.
        term: u64,
    },
    /// Another one.
    Follows {
        /// Its name.
        decider: String,
    },
}

impl Leadership {
    /// A robot that has not looked yet.
    pub fn new(own: &str) -> Self {
        Self {
            own: own.to_owned(),
            decider: None,
            term: 0,
        }
    }

    /// Looks who decides, now that these are alive (this robot among them); none if nothing has
    /// changed.
    pub fn look(&mut self, alive: &[&str]) -> Option<Role> {
        let first = alive.iter().copied().min().unwrap_or(&self.own);
        if self.decider.as_deref() == Some(first) {
            return None;
        }
        self.decider = Some(first.to_owned());
        Some(self.role())
    }

    /// A robot has spoken of this term, in which `decider` decides for it. A robot that decides and
    /// hears of a reign as late as its own begins a new one, unless that is the reign of somebody
    /// with a better right: where two that do not hear each other are both heard by a third, their
    /// terms would outbid each other without end, and the third would obey them in turn.
    pub fn heard(&mut self, robot: &str, decider: Option<&str>, term: u64) -> Option<Role> {
        if !self.decides() {
            self.term = self.term.max(term);
            return None;
        }
        let has_better_right = decider.is_some_and(|decider| decider < self.own.as_str());
        let is_later = term > self.term || term == self.term && decider == Some(robot);
        if has_better_right || !is_later {
            return None;
        }
        self.term = term;
        Some(self.role())
    }

    fn role(&mut self) -> Role {
        match &self.decider {
            Some(decider) if *decider != self.own => Role::Follows {
                decider: decider.clone(),
            },
            _ => {
                self.term += 1;
                Role::Decides { term: self.term }
            }
        }
    }

    /// Who decides; none before the first look.
    pub fn decider(&self) -> Option<&str> {
        self.decider.as_deref()
    }

    /// Whether this robot decides.
    pub fn decides(&self) -> bool {
        self.decider.as_deref() == Some(&self.own)
    }

    /// The latest term that this robot knows.
    pub fn term(&self) -> u64 {
        self.term
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn follows(decider: &str) -> Option<Role> {
        Some(Role::Follows {
            decider: decider.to_owned(),
        })
    }

    fn decides(term: u64) -> Option<Role> {
        Some(Role::Decides { term })
    }

    #[test]
    fn the_first_name_alive_decides() {
        let mut second = Leadership::new("R2");
        assert_eq!(second.look(&["R2"]), decides(1));
        assert_eq!(second.look(&["R2", "R3"]), None);
        assert_eq!(second.look(&["R1", "R2", "R3"]), follows("R1"));
        assert_eq!(second.heard("R1", Some("R1"), 5), None);
        assert_eq!((second.term(), second.decides()), (5, false));
        // R1 dies: a reign later than any that R1 has held.
        assert_eq!(second.look(&["R2", "R3"]), decides(6));
    }

    #[test]
    fn after_a_partition_one_of_two_deciders_goes_on_in_a_term_that_is_new_to_both() {
        let (mut first, mut second) = (Leadership::new("R1"), Leadership::new("R2"));
        assert_eq!(first.look(&["R1"]), decides(1));
        assert_eq!(second.look(&["R2"]), decides(1));
        for (alive, reign) in [(&["R2", "R3"][..], None), (&["R1", "R2"], follows("R1"))] {
            assert_eq!(second.look(alive), reign);
        }
        assert_eq!(second.look(&["R2"]), decides(2));
        // They meet: R1 hears of the second reign of R2.
        assert_eq!(first.look(&["R1", "R2"]), None);
        assert_eq!(first.heard("R2", Some("R2"), 2), decides(3));
        assert_eq!(second.look(&["R1", "R2"]), follows("R1"));
        assert_eq!(second.heard("R1", Some("R1"), 3), None);
        assert_eq!((first.term(), second.term()), (3, 3));
        // What R2 says as a follower disturbs nobody.
        assert_eq!(first.heard("R2", Some("R1"), 3), None);
    }

    #[test]
    fn old_terms_change_nothing() {
        let mut first = Leadership::new("R1");
        assert_eq!(first.look(&["R1"]), decides(1));
        assert_eq!(first.heard("R2", Some("R2"), 9), decides(10));
        for term in [0, 1, 9] {
            assert_eq!(first.heard("R2", Some("R2"), term), None, "{term}");
        }
        assert_eq!(first.heard("R2", Some("R2"), 10), decides(11));
    }

    #[test]
    fn a_decider_that_one_of_better_right_cannot_hear_does_not_outbid_him() {
        let (mut first, mut second) = (Leadership::new("R1"), Leadership::new("R2"));
        assert_eq!(second.look(&["R2", "R3"]), decides(1));
        assert_eq!(first.look(&["R1", "R3"]), decides(1));
        // R3 hears both. It has followed R2 so far, and follows R1 from now on.
        assert_eq!(first.heard("R3", Some("R2"), 1), None);
        assert_eq!(first.heard("R3", Some("R1"), 2), decides(3));
        for term in [3, 4] {
            assert_eq!(second.heard("R3", Some("R1"), term), None, "{term}");
        }
        assert_eq!((second.decides(), second.term()), (true, 1));
        // R1 dies: for R3 R2 decides again, in a term that R3 still has to hear of.
        assert_eq!(second.heard("R3", Some("R2"), 3), decides(4));
    }
}
