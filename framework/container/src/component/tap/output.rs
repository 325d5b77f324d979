//! A tap on an output.

use super::{Circumstances, Watch};
use crate::injection::Passage;
use crate::port::Datum;
use crate::recording::PortRecorder;
use crate::supervision::Sampler;

/// What stands between a component and one of its outputs.
pub struct OutputTap {
    /// The datum on its way.
    pub scratch: Datum,
    /// Checks.
    pub watch: Option<Watch>,
    /// Process models that want to know.
    pub samplers: Vec<Sampler>,
    /// Who puts it down.
    pub recorder: Option<PortRecorder>,
}

impl OutputTap {
    /// Another incarnation writes from now on.
    pub fn begin_anew(&mut self) {
        if let Some(watch) = &mut self.watch {
            watch.begin_anew();
        }
    }

    /// For data of `size` bytes.
    pub fn new(size: usize) -> Self {
        Self {
            scratch: Datum::empty(size),
            watch: None,
            samplers: Vec::new(),
            recorder: None,
        }
    }

    /// How often the datum on its way goes on: once, unless a fault is injected.
    pub fn distort(&mut self, at: Circumstances<'_>) -> usize {
        if at.injections.is_none() {
            return 1;
        }
        match at.distort(&mut self.scratch) {
            Passage::Deliver => 1,
            Passage::DeliverTwice => 2,
            Passage::Withhold => 0,
        }
    }

    /// Puts the next delayed datum on its way, if there is one.
    pub fn resume(&mut self, at: Circumstances<'_>) -> bool {
        let Some(delayed) = at.due() else {
            return false;
        };
        self.scratch.copy_from(&delayed);
        true
    }

    /// Looks at the datum on its way; whether it is good. A bad one goes on all the same: who reads
    /// it may have rules of its own.
    #[inline]
    pub fn look(&mut self, at: Circumstances<'_>) -> bool {
        for sampler in &self.samplers {
            sampler.sample(at.now_ns, self.scratch.bytes());
        }
        if let Some(recorder) = &mut self.recorder {
            let written_ns = self.scratch.stamp_ns();
            recorder.record(at.seen_ns, written_ns, self.scratch.bytes());
        }
        let Some(watch) = &mut self.watch else {
            return true;
        };
        !watch.look(at.now_ns, self.scratch.bytes(), at)
    }
}
