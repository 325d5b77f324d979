//! A record of a quantity over a run of any length in bounded memory.

/// Keeps every n-th value. When it is full it forgets every other one and doubles n, so a long run
/// is kept whole, only coarser.
#[derive(Debug, Clone)]
pub(crate) struct History<T> {
    values: Vec<T>,
    capacity: usize,
    stride: u64,
    offered: u64,
}

impl<T> History<T> {
    pub(crate) fn new(capacity: usize) -> Self {
        Self {
            values: Vec::new(),
            capacity,
            stride: 1,
            offered: 0,
        }
    }

    pub(crate) fn offer(&mut self, value: T) {
        if self.offered.is_multiple_of(self.stride) {
            if self.values.len() == self.capacity {
                self.halve();
            }
            if self.offered.is_multiple_of(self.stride) {
                self.values.push(value);
            }
        }
        self.offered += 1;
    }

    pub(crate) fn values(&self) -> &[T] {
        &self.values
    }

    fn halve(&mut self) {
        let mut index = 0;
        self.values.retain(|_| {
            index += 1;
            index % 2 == 1
        });
        self.stride *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::History;

    #[test]
    fn a_full_history_gets_coarser_and_stays_even() {
        let mut history = History::new(8);
        for value in 0..20 {
            history.offer(value);
        }
        assert_eq!(history.values(), [0, 4, 8, 12, 16]);
    }
}
