//! What a LIFO input holds, newest on top.

use super::Datum;

/// Its buffers are made once.
pub(super) struct Pile {
    slots: Vec<Datum>,
    filled: usize,
    /// What was taken last.
    taken: Datum,
}

impl Pile {
    /// An empty one for `places` data like `empty`.
    pub(super) fn new(places: usize, empty: &Datum) -> Self {
        Self {
            taken: empty.clone(),
            slots: vec![empty.clone(); places],
            filled: 0,
        }
    }

    /// What was taken last.
    pub(super) fn taken(&self) -> &Datum {
        &self.taken
    }

    /// Puts a copy on top; true if the oldest had to go for it.
    pub(super) fn push(&mut self, datum: &Datum) -> bool {
        let full = self.filled == self.slots.len();
        if full {
            self.slots.rotate_left(1);
        } else {
            self.filled += 1;
        }
        let top = &mut self.slots[self.filled - 1];
        top.copy_from(datum);
        full
    }

    /// Takes the newest; whether there was one.
    pub(super) fn pop(&mut self) -> bool {
        let Some(top) = self.filled.checked_sub(1) else {
            return false;
        };
        self.filled = top;
        std::mem::swap(&mut self.taken, &mut self.slots[top]);
        true
    }
}
