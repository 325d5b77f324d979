//! Looking for the target: once around on the spot, then a stretch onwards to see the arena from
//! another place.

use component_sdk::PortData;

/// A turn on the spot; the field of view of 65 degrees passes each point for almost a second.
const TURN_NS: u64 = 5_600_000_000;
/// The stretch after a turn in vain.
const STRETCH_NS: u64 = 3_000_000_000;

/// When the search began; 0 while the target is known.
#[derive(PortData, Debug, Clone, Copy, Default)]
#[repr(C)]
pub struct Search {
    began_at: u64,
}

/// What to do now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchPhase {
    /// Turn on the spot.
    Turn,
    /// Drive on.
    Stretch,
}

impl Search {
    /// Begins if it has not begun, and says what to do.
    pub fn phase(&mut self, time_ns: u64) -> SearchPhase {
        if self.began_at == 0 {
            self.began_at = time_ns.max(1);
        }
        let elapsed_ns = time_ns.saturating_sub(self.began_at);
        if elapsed_ns % (TURN_NS + STRETCH_NS) < TURN_NS {
            SearchPhase::Turn
        } else {
            SearchPhase::Stretch
        }
    }

    /// The target is known again.
    pub fn end(&mut self) {
        self.began_at = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_and_stretches_take_turns() {
        let mut search = Search::default();
        let begin_ns = 7_000_000_000;
        let at = |search: &mut Search, after_ns| search.phase(begin_ns + after_ns);
        assert_eq!(at(&mut search, 0), SearchPhase::Turn);
        assert_eq!(at(&mut search, TURN_NS), SearchPhase::Stretch);
        assert_eq!(at(&mut search, TURN_NS + STRETCH_NS), SearchPhase::Turn);
        assert_eq!(at(&mut search, TURN_NS), SearchPhase::Stretch);
        search.end();
        assert_eq!(at(&mut search, TURN_NS), SearchPhase::Turn);
    }
}
