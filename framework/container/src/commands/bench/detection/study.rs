//! Each decision rule over a range of thresholds: false alarms on drives without a fault, delays on
//! drives with one.

use std::io;
use std::time::Duration;

use fault_manager::detection::process_model::{ModelError, Monitor};
use system_model::process_model::ProcessModel;
use system_model::rules::{DecisionRule, Judgement, ProcessModelRule};

use super::series::{FaultyDrive, Recorder, Sample};
use super::workers::in_parallel;

/// Drives without a fault have other seeds than those with one.
const SANE_SEEDS: u64 = 1_000_000;
/// Ten minutes each.
const SANE_SAMPLES: usize = 30_000;
const SANE_DRIVES_PER_HOUR: u64 = 6;
/// How long a fault may remain, 4 s: what is not found by then is missed.
const FAULT_SAMPLES: usize = 200;
/// Alarms nearer to each other than this, 1 s, are one.
const QUIET_SAMPLES: usize = 50;
/// Thresholds of each rule: steps of 7 % over almost two decades.
const THRESHOLDS: usize = 64;
const THRESHOLD_STEP: f64 = 1.07;

/// How much is driven.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub(super) seeds: u32,
    pub(super) hours: u32,
    pub(super) in_step: bool,
}

/// The result.
#[derive(Debug)]
pub(super) struct Study {
    pub(super) extent: Extent,
    /// Delays to the first evidence, ascending; infinite if there was none.
    pub(super) floor_ms: Vec<f64>,
    /// Ticks missing so long after the fault, ascending.
    pub(super) missing_ticks_after_80_ms: Vec<i32>,
    pub(super) curves: Vec<Curve>,
}

/// One decision rule with its parameters.
#[derive(Debug)]
pub(super) struct Curve {
    pub(super) method: &'static str,
    /// What is written besides method and threshold.
    pub(super) parameters: String,
    /// Thresholds ascending.
    pub(super) points: Vec<Point>,
}

/// What one threshold leads to.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub(super) threshold: f64,
    pub(super) alarms_per_hour: f64,
    /// Ascending; infinite if the fault was missed.
    pub(super) delays_ms: Vec<f64>,
}

impl Point {
    pub(super) fn quantile_ms(&self, quantile: f64) -> f64 {
        quantile_of(&self.delays_ms, quantile)
    }
}

/// The value below which this share of some ascending values lies, by the nearest rank.
pub(super) fn quantile_of<T: Copy>(ascending: &[T], quantile: f64) -> T {
    let rank = (quantile * ascending.len() as f64).ceil() as usize;
    ascending[rank.clamp(1, ascending.len()) - 1]
}

impl Curve {
    /// The lowest threshold with at most one false alarm in 24 hours.
    pub(super) fn best(&self) -> Option<&Point> {
        let mut points = self.points.iter();
        points.find(|point| point.alarms_per_hour <= 1.0 / 24.0)
    }
}

/// Rules and parameters that are compared: method, window in ms, drift, first threshold.
const RULES: [(&str, u64, Option<f64>, f64); 9] = [
    ("window", 20, None, 0.001),
    ("window", 100, None, 0.001),
    ("window", 400, None, 0.0005),
    ("cusum", 20, Some(0.001), 0.001),
    ("cusum", 20, Some(0.002), 0.001),
    ("cusum", 20, Some(0.004), 0.0005),
    ("chi_square", 20, None, 2.0),
    ("chi_square", 60, None, 4.0),
    ("chi_square", 200, None, 10.0),
];

impl Study {
    /// Drives and looks.
    ///
    /// # Errors
    /// When the simulation does not run or the model cannot be used.
    pub(super) fn run(model: &ProcessModel, extent: Extent) -> io::Result<Self> {
        let recorder = Recorder::new(model, extent.in_step)?;
        let drives = u64::from(extent.hours) * SANE_DRIVES_PER_HOUR;
        let sane = in_parallel(drives, |number| {
            recorder.sane(SANE_SEEDS + number, SANE_SAMPLES)
        })?;
        let faulty = in_parallel(u64::from(extent.seeds), |seed| {
            recorder.faulty(seed, FAULT_SAMPLES)
        })?;
        let curves = in_parallel(RULES.len() as u64, |number| {
            let rule = RULES[number as usize];
            curve(model, rule, &sane, &faulty).map_err(io::Error::other)
        })?;
        let mut floor_ms: Vec<f64> = faulty
            .iter()
            .map(|drive| milliseconds(drive.first_evidence))
            .collect();
        floor_ms.sort_by(f64::total_cmp);
        let mut missing: Vec<i32> = faulty.iter().map(|drive| drive.missing_ticks[3]).collect();
        missing.sort_unstable();
        Ok(Self {
            extent,
            floor_ms,
            missing_ticks_after_80_ms: missing,
            curves,
        })
    }
}

fn curve(
    model: &ProcessModel,
    (method, window_ms, drift, first): (&'static str, u64, Option<f64>, f64),
    sane: &[Vec<Sample>],
    faulty: &[FaultyDrive],
) -> Result<Curve, ModelError> {
    let rule = ProcessModelRule {
        model: String::new(),
        window: Duration::from_millis(window_ms),
        // Never reached, so that the statistic is not bounded by it.
        threshold: f64::MAX,
        method: match method {
            "window" => DecisionRule::Window,
            "cusum" => DecisionRule::Cusum { drift },
            _ => DecisionRule::ChiSquare,
        },
        parameters: Vec::new(),
        judgement: Judgement::default(),
    };
    let steps = (0..THRESHOLDS).map(|step| first * THRESHOLD_STEP.powi(step as i32));
    let thresholds: Vec<f64> = steps.collect();
    let mut alarms = vec![0_u64; THRESHOLDS];
    let mut monitor = Monitor::new(model, &rule)?;
    for samples in sane {
        count_alarms(&statistics(&mut monitor, samples), &thresholds, &mut alarms);
    }
    let mut delays_ms = vec![Vec::new(); THRESHOLDS];
    for drive in faulty {
        let statistics = statistics(&mut monitor, &drive.samples);
        for (threshold, delays_ms) in thresholds.iter().zip(&mut delays_ms) {
            let mut after = statistics[drive.fault..].iter();
            let found = after.position(|statistic| statistic > threshold);
            delays_ms.push(milliseconds(found.map(|found| found + 1)));
        }
    }
    let hours = (sane.len() as u64 / SANE_DRIVES_PER_HOUR) as f64;
    let points = thresholds.into_iter().zip(alarms).zip(delays_ms);
    Ok(Curve {
        method,
        parameters: match drift {
            Some(drift) => format!("window={window_ms} drift={drift}"),
            None => format!("window={window_ms}"),
        },
        points: points
            .map(|((threshold, alarms), mut delays_ms)| {
                delays_ms.sort_by(f64::total_cmp);
                Point {
                    threshold,
                    alarms_per_hour: alarms as f64 / hours,
                    delays_ms,
                }
            })
            .collect(),
    })
}

/// What the decision rule makes of each sample.
fn statistics(monitor: &mut Monitor, samples: &[Sample]) -> Vec<f64> {
    monitor.reset();
    let period = monitor.model().period;
    let mut at = Duration::ZERO;
    let statistics = samples.iter().map(|sample| {
        at += period;
        let inputs = sample.inputs.map(f64::from);
        monitor.step(at, &inputs, &sample.speeds_m_per_s.map(f64::from));
        monitor.statistic()
    });
    statistics.collect()
}

/// Adds the alarms of a drive for each threshold.
fn count_alarms(statistics: &[f64], thresholds: &[f64], alarms: &mut [u64]) {
    let mut last = vec![None::<usize>; thresholds.len()];
    for (index, statistic) in statistics.iter().enumerate() {
        let exceeded = thresholds.partition_point(|threshold| threshold < statistic);
        for (last, alarms) in last.iter_mut().zip(&mut *alarms).take(exceeded) {
            if last.is_none_or(|last| index - last > QUIET_SAMPLES) {
                *alarms += 1;
            }
            *last = Some(index);
        }
    }
}

fn milliseconds(samples: Option<usize>) -> f64 {
    samples.map_or(f64::INFINITY, |samples| samples as f64 * 20.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alarms_near_each_other_are_one() {
        let mut statistics = vec![0.0; 300];
        for (index, value) in [(10, 5.0), (12, 1.5), (40, 5.0), (200, 1.5)] {
            statistics[index] = value;
        }
        let mut alarms = [0; 3];
        count_alarms(&statistics, &[1.0, 2.0, 5.0], &mut alarms);
        assert_eq!(alarms, [2, 1, 0]);
    }

    #[test]
    fn quantiles_are_values_that_were_there() {
        let values = [1.0, 2.0, 3.0, f64::INFINITY];
        let quantiles = [0.0, 0.5, 0.75, 1.0].map(|quantile| quantile_of(&values, quantile));
        assert_eq!(quantiles, [1.0, 2.0, 3.0, f64::INFINITY]);
    }
}
