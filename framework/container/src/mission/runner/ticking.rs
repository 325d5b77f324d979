//! One tick, whatever its leaves do: a panic, an error and a loop without end are answers like others.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use behavior_tree::{NodeId, Status, TickError};
use system_model::fault::FaultKind;
use system_model::mission::DeclaredTree;

use super::Runner;

/// How often a tree may ask to be ticked again at once within one tick: a loop whose child completes
/// at once does so after each cycle. One that does it for ever is a fault; so many cycles take a
/// millisecond.
const MOST_ROUNDS: u32 = 1_000;

/// How a tick ended that did not end well.
pub(super) struct Mishap {
    pub(super) kind: FaultKind,
    pub(super) message: String,
}

impl Runner {
    /// A tick, and further ones for as long as the tree asks for them at once.
    pub(super) fn rounds(&mut self, now: Duration, began: Instant) -> Result<Status, Mishap> {
        for _ in 0..MOST_ROUNDS {
            let tree = &mut self.tree;
            let mut nobody = |_: NodeId, _: Status, _: Status| {};
            let ticked = catch_unwind(AssertUnwindSafe(|| tree.tick(now, &mut nobody)));
            match ticked {
                Err(panic) => {
                    self.tree.abandon();
                    return Err(Mishap {
                        kind: FaultKind::Panic,
                        message: words(panic.as_ref()),
                    });
                }
                Ok(Err(TickError { path, message })) => {
                    return Err(Mishap {
                        kind: FaultKind::TreeError,
                        message: format!("{path}: {message}"),
                    });
                }
                Ok(Ok(status)) if status != Status::Running || !self.tree.is_woken() => {
                    return Ok(status);
                }
                Ok(Ok(_)) => {}
            }
            let took = began.elapsed();
            if !self.environment.clock.is_simulated() && took > self.declared.tick_deadline {
                return Err(overrun(took, &self.declared));
            }
        }
        Err(Mishap {
            kind: FaultKind::TickOverrun,
            message: format!("one tick went through its loops {MOST_ROUNDS} times"),
        })
    }
}

/// A tick that took too long.
pub(super) fn overrun(took: Duration, declared: &DeclaredTree) -> Mishap {
    let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
    Mishap {
        kind: FaultKind::TickOverrun,
        message: format!(
            "a tick took {:.1} ms, and may take {} ms",
            milliseconds(took),
            milliseconds(declared.tick_deadline)
        ),
    }
}

/// What a panic says.
pub(super) fn words(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "a panic without words".to_owned())
}
