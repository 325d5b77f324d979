//! What a component is given to read along with a call, so that it need not ask: the newest datum
//! of each input that it read in its last cycle and that has no queue.

use super::layout::{Layout, PortArea};

/// What lies in a port's place for the component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Offer {
    /// The component must ask.
    Nothing,
    /// A datum.
    Datum,
    /// The answer that there is none.
    NoDatum,
    /// There was a datum or the answer that there is none, and the component has read it.
    Taken,
}

impl Offer {
    /// As a word.
    pub(super) fn word(self) -> u64 {
        match self {
            Self::Nothing => 0,
            Self::Datum => 1,
            Self::NoDatum => 2,
            Self::Taken => 3,
        }
    }

    /// From a word; what makes no sense is nothing.
    pub(super) fn from_word(word: u64) -> Self {
        match word {
            1 => Self::Datum,
            2 => Self::NoDatum,
            3 => Self::Taken,
            _ => Self::Nothing,
        }
    }
}

/// An input of one instance.
#[derive(Debug)]
pub(super) struct Input {
    /// Its port number.
    pub(super) port: u32,
    /// Whether the component read it in its last cycle.
    pub(super) is_read: bool,
    /// Whether a datum lies in its place that was offered and not taken.
    pub(super) is_kept: bool,
}

/// The inputs of a layout; the component has read none yet.
pub(super) fn inputs(layout: &Layout) -> Vec<Input> {
    let numbered = (0..).zip(&layout.ports);
    let inputs = numbered.filter(|(_, port)| matches!(port, PortArea::Input(_)));
    inputs
        .map(|(port, _)| Input {
            port,
            is_read: false,
            is_kept: false,
        })
        .collect()
}

impl Input {
    /// The callback is over, and the offer is as it is now.
    pub(super) fn look_back(&mut self, offer: Offer) {
        match offer {
            // It asked, or it did not: that is known by the questions.
            Offer::Nothing => {}
            Offer::Datum | Offer::NoDatum => self.is_read = false,
            Offer::Taken => {
                self.is_read = true;
                self.is_kept = false;
            }
        }
    }
}
