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

    /// A robot has spoken of this term, as the one who decides if `decides`. A robot that decides
    /// and hears of a reign as late as its own begins a new one.
    pub fn heard(&mut self, decides: bool, term: u64) -> Option<Role> {
        if !self.decides() {
            self.term = self.term.max(term);
            return None;
        }
        if term < self.term || term == self.term && !decides {
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
        assert_eq!(second.heard(true, 5), None);
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
        assert_eq!(first.heard(true, 2), decides(3));
        assert_eq!(second.look(&["R1", "R2"]), follows("R1"));
        assert_eq!(second.heard(true, 3), None);
        assert_eq!((first.term(), second.term()), (3, 3));
        // What R2 says as a follower disturbs nobody.
        assert_eq!(first.heard(false, 3), None);
    }

    #[test]
    fn old_terms_change_nothing() {
        let mut first = Leadership::new("R1");
        assert_eq!(first.look(&["R1"]), decides(1));
        assert_eq!(first.heard(true, 9), decides(10));
        for term in [0, 1, 9] {
            assert_eq!(first.heard(true, term), None, "{term}");
        }
        assert_eq!(first.heard(true, 10), decides(11));
    }
}
