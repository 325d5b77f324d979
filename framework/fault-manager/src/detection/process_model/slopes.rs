//! How fast the outputs of a model move: what a shift in time makes of them.

use nalgebra::DVector;

/// Early by a period, the process moves as the model will in its next step; late by one, as it did in
/// the last. The measured output may itself be a smoothed one, which spreads a step over several
/// samples: these many are remembered.
const STEPS: usize = 4;

/// The last steps of each output from sample to sample.
#[derive(Debug, Clone)]
pub(super) struct Slopes {
    last: DVector<f64>,
    steps: [DVector<f64>; STEPS],
    /// Where the next step goes; none before the first output.
    next: Option<usize>,
}

impl Slopes {
    pub(super) fn new(outputs: usize) -> Self {
        Self {
            last: DVector::zeros(outputs),
            steps: std::array::from_fn(|_| DVector::zeros(outputs)),
            next: None,
        }
    }

    pub(super) fn reset(&mut self) {
        self.next = None;
        for step in &mut self.steps {
            step.fill(0.0);
        }
    }

    /// Takes the next outputs of the model.
    pub(super) fn follow(&mut self, outputs: &DVector<f64>) {
        if let Some(next) = self.next {
            let step = &mut self.steps[next];
            step.copy_from(outputs);
            *step -= &self.last;
        }
        self.next = Some(self.next.map_or(0, |next| (next + 1) % STEPS));
        self.last.copy_from(outputs);
    }

    /// The largest of the last steps of an output.
    pub(super) fn steepest(&self, output: usize) -> f64 {
        let steps = self.steps.iter().map(|step| step[output].abs());
        steps.fold(0.0, f64::max)
    }
}
