//! A process that dies says so at once: its main thread holds words on the list that the kernel
//! walks when a thread dies ("robust futexes"), long before the memory of the process is torn down
//! and its parent is told.
//!
//! The C library keeps such a list for every thread; the main thread of a host runs no component and
//! holds no lock that is on it, so it may have another one.
#![allow(unsafe_code)] // a list in the form of the kernel

use std::io;
use std::ptr;

use super::channel::{Channel, LIFE_OFFSET};

/// `struct robust_list_head`.
#[repr(C)]
struct Head {
    /// The first link, or the head itself: the links form a ring.
    next: *mut u64,
    /// From a link to its word.
    offset: libc::c_long,
    /// What is being put on the list just now.
    pending: *mut u64,
}

/// The words of the calling thread.
pub(super) struct SignsOfLife {
    head: *mut Head,
}

impl SignsOfLife {
    /// None yet. To be made by the main thread of a host, once; the list stays for as long as the
    /// process.
    ///
    /// # Errors
    /// If the kernel knows no such lists.
    pub(super) fn new() -> io::Result<Self> {
        let head = Box::into_raw(Box::new(Head {
            next: ptr::null_mut(),
            offset: LIFE_OFFSET as libc::c_long,
            pending: ptr::null_mut(),
        }));
        // SAFETY: just made, and nobody else has it.
        unsafe { (*head).next = head.cast() };
        // SAFETY: the head is in the kernel's form and is never freed.
        let result = unsafe { libc::syscall(libc::SYS_set_robust_list, head, size_of::<Head>()) };
        if result == 0 {
            Ok(Self { head })
        } else {
            Err(io::Error::last_os_error())
        }
    }

    /// From now on the kernel tells the other side of this channel when the calling thread dies.
    /// The channel must never be unmapped.
    pub(super) fn show(&mut self, channel: &'static Channel) {
        let link = channel.show_life();
        // SAFETY: the head is this thread's own; the kernel looks at it only when it dies.
        let first = unsafe { (*self.head).next };
        // SAFETY: the link is inside the channel's header, aligned, and nothing else uses it.
        unsafe { link.write(first.expose_provenance() as u64) };
        // SAFETY: as above.
        unsafe { (*self.head).next = link };
    }
}
