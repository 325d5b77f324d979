//! Tests that need the machine for themselves take turns.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Held by a test that drives a robot by the machine's clock, which loses its way when it comes late
/// too often, or that keeps the machine busy. Whoever holds it has deadlines, so the wait for it ends.
pub fn take_turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    // A test that failed has let go of the machine, too.
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}
