//! What a robot's control process asks of the system: a real-time priority, and memory that stays.

use rustix::mm::{MlockAllFlags, mlockall};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// Of the executor of the component under test, and of whoever measures the floor.
pub(super) const PRIORITY: u8 = 60;

/// Gives the calling thread this real-time priority (`SCHED_FIFO`), if that is permitted.
pub(super) fn ask_for_real_time(priority: u8) -> bool {
    let fifo = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    ThreadPriorityValue::try_from(priority).is_ok_and(|value| {
        let priority = ThreadPriority::Crossplatform(value);
        set_thread_priority_and_policy(thread_native_id(), priority, fifo).is_ok()
    })
}

/// Keeps all memory of this process in place once it has been touched, if that is permitted.
/// (Memory that was never touched stays a promise: each component's stack is a megabyte of it.)
pub(super) fn lock_memory() -> bool {
    let flags = MlockAllFlags::CURRENT | MlockAllFlags::FUTURE | MlockAllFlags::ONFAULT;
    mlockall(flags).is_ok()
}
