//! Who goes before whom: the container's threads by the scheduler's policies and priorities.
//!
//! From the top: the watchdog and the spare threads, which stand in for everybody; the fault
//! manager's thread that looks after time; real-time executors as profiles say; everybody else;
//! last the thread that prepares standbys.
#![allow(unsafe_code)] // to be an ordinary thread again has no safe form that leaves niceness alone

use std::num::NonZeroU64;

use system_model::specification::SchedulingPolicy;
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// The kernel's real-time priorities.
const LEAST_REAL_TIME: u8 = 1;
const MOST_REAL_TIME: u8 = 99;

/// The politest thread there is.
const NICEST: i32 = 19;

/// Gives the calling thread what an executor's profile asks for.
///
/// # Errors
/// If the system refuses; then it stays as it was.
pub fn set(policy: SchedulingPolicy, priority: u8) -> Result<(), String> {
    let policy = match policy {
        SchedulingPolicy::Other => return be_ordinary(),
        SchedulingPolicy::Fifo => RealtimeThreadSchedulePolicy::Fifo,
        SchedulingPolicy::RoundRobin => RealtimeThreadSchedulePolicy::RoundRobin,
    };
    be_real_time(policy, priority)
}

/// Puts the calling thread above all executors, where that is permitted. Who needs it is slower
/// without, which is all that can be done about it.
pub fn outrank_components() {
    let _slower = be_real_time(RealtimeThreadSchedulePolicy::Fifo, MOST_REAL_TIME);
    wake_in_time();
}

/// Puts the calling thread just above real-time executors of this priority, where that is
/// permitted.
pub fn outrank(priority: u8) {
    let above = priority.saturating_add(1).min(MOST_REAL_TIME - 1);
    let _slower = be_real_time(RealtimeThreadSchedulePolicy::Fifo, above);
    wake_in_time();
}

/// Puts the calling thread behind all executors. Where all of these are to have real-time priority,
/// and that is permitted, any ordinary thread is; else it gives way to everybody, which is refused
/// nowhere. Who prepares standbys on a machine that is kept busy by others comes to nothing if it
/// gives way to these without need.
pub fn stay_behind(all_are_real_time: bool) {
    let real_time = RealtimeThreadSchedulePolicy::Fifo;
    let is_behind = all_are_real_time && be_real_time(real_time, LEAST_REAL_TIME).is_ok();
    let _as_it_was = be_ordinary();
    if !is_behind {
        let _as_it_was = rustix::process::setpriority_process(None, NICEST);
    }
}

/// Asks for wake-ups at the time that was asked for: by default the kernel may be 50 us late to
/// save energy. Refused nowhere that is known; a refusal would only make cycles less even.
pub fn wake_in_time() {
    let _less_even = rustix::thread::set_current_timer_slack(NonZeroU64::new(1));
}

/// Takes all rank from the calling thread; it is as nice as it was.
///
/// # Errors
/// If the system refuses; then it stays as it was.
pub fn be_ordinary() -> Result<(), String> {
    let none = libc::sched_param { sched_priority: 0 };
    // SAFETY: 0 is the calling thread, and the parameter is there for the time of the call.
    let result = unsafe { libc::sched_setscheduler(0, libc::SCHED_OTHER, &raw const none) };
    match result {
        0 => Ok(()),
        _ => Err(std::io::Error::last_os_error().to_string()),
    }
}

fn be_real_time(policy: RealtimeThreadSchedulePolicy, priority: u8) -> Result<(), String> {
    let priority = ThreadPriorityValue::try_from(priority.clamp(LEAST_REAL_TIME, MOST_REAL_TIME))
        .map_err(|reason| reason.to_owned())?;
    set_thread_priority_and_policy(
        thread_native_id(),
        ThreadPriority::Crossplatform(priority),
        ThreadSchedulePolicy::Realtime(policy),
    )
    .map_err(|error| format!("{error:?}"))
}
