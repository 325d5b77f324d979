//! A host's thread works for an executor of the container and has its policy and priority.
#![allow(unsafe_code)] // the scheduler's calls have no safe form for threads of another process

use std::mem::MaybeUninit;

/// Policy and priority of a thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Scheduling {
    policy: i32,
    priority: i32,
}

impl Scheduling {
    /// What every process begins with.
    pub(super) const NORMAL: Self = Self {
        policy: libc::SCHED_OTHER,
        priority: 0,
    };

    /// That of the calling thread.
    pub(super) fn of_this_thread() -> Self {
        // SAFETY: 0 is the calling thread.
        let policy = unsafe { libc::sched_getscheduler(0) };
        let mut parameters = MaybeUninit::<libc::sched_param>::zeroed();
        // SAFETY: as above; there is room for the answer.
        let failed = unsafe { libc::sched_getparam(0, parameters.as_mut_ptr()) };
        if policy < 0 || failed != 0 {
            return Self::NORMAL;
        }
        // SAFETY: filled by the kernel, and all zero is a value too.
        let priority = unsafe { parameters.assume_init() }.sched_priority;
        Self { policy, priority }
    }

    /// Gives it to a thread of a host. If the system refuses, that thread stays as it is.
    pub(super) fn give_to(self, thread: i32) {
        let parameters = libc::sched_param {
            sched_priority: self.priority,
        };
        // SAFETY: the parameters are there; a thread that is gone is refused.
        let _refused =
            unsafe { libc::sched_setscheduler(thread, self.policy, &raw const parameters) };
    }
}
