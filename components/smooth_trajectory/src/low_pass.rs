//! A first-order low-pass over samples that need not come evenly.

/// The filter. It begins at 0.
#[derive(Debug, Clone, Copy)]
pub struct LowPass {
    time_constant_s: f64,
    value: f64,
    last_ns: Option<u64>,
}

impl LowPass {
    /// A filter with this time constant; 0 lets everything through.
    pub fn new(time_constant_s: f64) -> Self {
        Self {
            time_constant_s,
            value: 0.0,
            last_ns: None,
        }
    }

    /// Takes a sample of this time and returns the filtered value. What is not newer than the last
    /// one changes nothing.
    pub fn follow(&mut self, time_ns: u64, sample: f64) -> f64 {
        let passed_ns = time_ns.saturating_sub(self.last_ns.unwrap_or(time_ns));
        let passed_s = passed_ns as f64 * 1e-9;
        let share = match self.time_constant_s > 0.0 {
            true => 1.0 - (-passed_s / self.time_constant_s).exp(),
            false => 1.0,
        };
        self.value += share * (sample - self.value);
        self.last_ns = Some(self.last_ns.unwrap_or(time_ns).max(time_ns));
        self.value
    }

    /// Begins anew.
    pub fn forget(&mut self) {
        *self = Self::new(self.time_constant_s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_followed_by_63_percent_in_a_time_constant() {
        let mut filter = LowPass::new(0.2);
        for (time_ms, expected) in [
            (0, 0.0),
            (100, 0.393),
            (200, 0.632),
            (200, 0.632),
            (2000, 1.0),
        ] {
            let value = filter.follow(time_ms * 1_000_000, 1.0);
            assert!((value - expected).abs() < 1e-3, "{time_ms} ms: {value}");
        }
        filter.forget();
        assert_eq!(filter.follow(3_000_000_000, 1.0), 0.0);
        assert_eq!(LowPass::new(0.0).follow(0, 0.5), 0.5);
    }
}
