//! The median of three reports.
//!
//! The sensors fire one after the other, so that each echo stands in four reports: a median of
//! three takes out a value that stands in only one of them, and delays a true one by one report.
//! A sensor that does not answer reads 0 in every report and stays visible.

/// The last reports of one sensor.
#[derive(Debug, Clone, Copy, Default)]
pub struct OutlierFilter {
    earlier_m: Option<[f64; 2]>,
}

impl OutlierFilter {
    /// Takes the next range and returns the median of the last three; the first one as it is.
    pub fn filter(&mut self, range_m: f64) -> f64 {
        let [oldest_m, older_m] = self.earlier_m.unwrap_or([range_m; 2]);
        self.earlier_m = Some([older_m, range_m]);
        let (low_m, high_m) = (oldest_m.min(older_m), oldest_m.max(older_m));
        range_m.max(low_m).min(high_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filtered(ranges_m: &[f64]) -> Vec<f64> {
        let mut filter = OutlierFilter::default();
        ranges_m
            .iter()
            .map(|range_m| filter.filter(*range_m))
            .collect()
    }

    #[test]
    fn one_wrong_report_is_taken_out() {
        assert_eq!(filtered(&[1.0, 1.0, 0.03, 1.0]), [1.0; 4]);
        assert_eq!(filtered(&[1.0, 0.0, 1.0]), [1.0; 3]);
    }

    #[test]
    fn a_true_change_comes_one_report_later() {
        assert_eq!(filtered(&[2.0, 1.0, 1.0, 1.0]), [2.0, 2.0, 1.0, 1.0]);
    }

    #[test]
    fn a_sensor_that_does_not_answer_stays_visible() {
        assert_eq!(filtered(&[1.0, 0.0, 0.0, 0.0]), [1.0, 1.0, 0.0, 0.0]);
        assert_eq!(filtered(&[0.0]), [0.0]);
    }
}
