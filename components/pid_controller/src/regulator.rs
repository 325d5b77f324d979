//! The controller itself: proportional, integral and derivative part, bounded.

/// Between two samples that are farther apart nothing is integrated: half a second is five pictures.
const GAP_MAXIMUM_S: f64 = 0.5;

/// How the output follows from the error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// Output for an error.
    pub proportional_per_s: f64,
    /// Output for the integral of the error over time.
    pub integral_per_s2: f64,
    /// Output for the rate at which the error changes.
    pub derivative: f64,
    /// The output is not larger, either way.
    pub output_maximum: f64,
}

impl Default for Gains {
    /// For a camera of ten pictures a second and wheels that need 0.12 s to follow: half the gain at
    /// which the turn begins to swing.
    fn default() -> Self {
        Self {
            proportional_per_s: 2.0,
            integral_per_s2: 0.8,
            derivative: 0.05,
            output_maximum: 1.5,
        }
    }
}

impl Gains {
    /// Whether a controller can have them.
    pub fn are_possible(&self) -> bool {
        [
            self.proportional_per_s,
            self.integral_per_s2,
            self.derivative,
            self.output_maximum,
        ]
        .iter()
        .all(|gain| *gain >= 0.0 && gain.is_finite())
    }
}

/// The controller.
#[derive(Debug, Clone, Copy)]
pub struct Regulator {
    gains: Gains,
    integral: f64,
    /// Time and error of the last sample.
    last: Option<(u64, f64)>,
}

impl Regulator {
    /// A controller that has seen nothing yet.
    pub fn new(gains: Gains) -> Self {
        Self {
            gains,
            integral: 0.0,
            last: None,
        }
    }

    /// The output for an error at this time. While the output is at its bound the integral does not
    /// grow, so that it need not be unwound later.
    pub fn regulate(&mut self, time_ns: u64, error: f64) -> f64 {
        let gains = self.gains;
        let passed_s = self.last.map_or(0.0, |(last_ns, _error)| {
            time_ns.saturating_sub(last_ns) as f64 * 1e-9
        });
        let mut rate = 0.0;
        let mut integral = self.integral;
        if passed_s > 0.0 && passed_s <= GAP_MAXIMUM_S {
            integral += error * passed_s;
            rate = self
                .last
                .map_or(0.0, |(_time, last)| (error - last) / passed_s);
        }
        self.last = Some((time_ns, error));
        let output = gains.proportional_per_s * error
            + gains.integral_per_s2 * integral
            + gains.derivative * rate;
        let bounded = output.clamp(-gains.output_maximum, gains.output_maximum);
        if bounded == output {
            self.integral = integral;
        }
        bounded
    }

    /// Begins anew.
    pub fn forget(&mut self) {
        *self = Self::new(self.gains);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAINS: Gains = Gains {
        proportional_per_s: 2.0,
        integral_per_s2: 1.0,
        derivative: 0.1,
        output_maximum: 3.0,
    };

    /// Outputs for errors, a tenth of a second apart.
    fn outputs(errors: &[f64]) -> Vec<f64> {
        let mut regulator = Regulator::new(GAINS);
        let times = (0..).map(|tenth: u64| tenth * 100_000_000);
        let samples = times.zip(errors);
        samples
            .map(|(time_ns, error)| regulator.regulate(time_ns, *error))
            .collect()
    }

    #[test]
    fn every_part_does_its_share() {
        let cases: [(&[f64], &[f64]); 4] = [
            (&[0.0, 0.0], &[0.0, 0.0]),
            // 2 x 0.5; then 0.05 are summed up.
            (&[0.5, 0.5, 0.5], &[1.0, 1.05, 1.1]),
            // The error falls by 1 a second.
            (&[0.5, 0.4], &[1.0, 0.8 + 0.04 - 0.1]),
            (&[-9.0], &[-3.0]),
        ];
        for (errors, expected) in cases {
            for (output, expected) in outputs(errors).iter().zip(expected) {
                assert!(
                    (output - expected).abs() < 1e-9,
                    "{errors:?}: {output}, not {expected}"
                );
            }
        }
    }

    #[test]
    fn the_integral_does_not_wind_up() {
        let mut errors = vec![5.0; 100];
        errors.push(0.0);
        errors.push(0.0);
        let last = outputs(&errors)[101];
        assert!(last.abs() < 1e-9, "{last}");
    }

    #[test]
    fn a_gap_or_a_time_that_goes_back_is_not_integrated() {
        let mut regulator = Regulator::new(GAINS);
        for time_ns in [5_000_000_000, 9_000_000_000, 1_000_000_000] {
            assert_eq!(regulator.regulate(time_ns, 0.5), 1.0, "{time_ns}");
        }
    }

    #[test]
    fn gains_are_numbers_from_0_on() {
        let negative = Gains {
            derivative: -1.0,
            ..GAINS
        };
        let none = Gains {
            integral_per_s2: f64::NAN,
            ..GAINS
        };
        assert!(GAINS.are_possible() && !negative.are_possible() && !none.are_possible());
    }
}
