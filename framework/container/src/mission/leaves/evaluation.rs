//! Evaluators of Modules: what a port says, as a cost; below 1 is acceptable. They measure beside the
//! executor, so they are RUNNING for as long as nobody halts them.

use std::time::Duration;

use behavior_tree::{Leaf, LeafContext, Status, Value};

use super::data::Watched;
use super::{milliseconds, number};

/// The age of the newest datum, or of the newest whose field had the target value, as a share of what
/// is tolerated; before the first one, the time since the node began.
pub(in crate::mission) struct Age {
    watched: Watched,
    /// When the newest that counts was sent, or the node began.
    since: Duration,
}

impl Age {
    pub(in crate::mission) fn new(watched: Watched) -> Self {
        Self {
            watched,
            since: Duration::ZERO,
        }
    }
}

impl Leaf for Age {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        if context.begins {
            self.since = context.now;
        }
        self.watched.look();
        let target = context.input("target").and_then(Value::as_number);
        if let Some((stamp_ns, value)) = self.watched.newest()
            && target.is_none_or(|target| value == target)
        {
            self.since = self.since.max(Duration::from_nanos(stamp_ns));
        }
        let tolerated = milliseconds(context, "max_age_ms")?;
        let age = context.now.saturating_sub(self.since);
        let cost = age.as_secs_f64() / tolerated.as_secs_f64();
        context.output("cost", Value::Number(cost))?;
        Ok(Status::Running)
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}

/// How far a field is from its target, as a share of what is tolerated; a field that nobody has sent is
/// as far as can be.
pub(in crate::mission) struct Deviation(pub(in crate::mission) Watched);

impl Leaf for Deviation {
    fn tick(&mut self, context: &mut LeafContext<'_>) -> Result<Status, String> {
        self.0.look();
        let (target, tolerance) = (number(context, "target")?, number(context, "tolerance")?);
        let value = self.0.newest().map(|(_, value)| value);
        let cost = value.map_or(f64::MAX, |value| (value - target).abs() / tolerance);
        // 0 of 0 is no number; it is as good as can be.
        let cost = if cost.is_nan() {
            0.0
        } else {
            cost.min(f64::MAX)
        };
        context.output("cost", Value::Number(cost))?;
        Ok(Status::Running)
    }

    fn halt(&mut self, _context: &mut LeafContext<'_>) {}
}
