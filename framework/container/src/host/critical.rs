//! Critical memory in a host: the pages that hold it are exchanged for shared ones with the same
//! content, at the same address. The component does not notice; the container sees every change
//! without a copy, and still has it when the host is dead.
//!
//! Whole pages are shared, so what lies beside the critical memory is visible to the container too.
#![allow(unsafe_code)] // exchanges pages under a component

use std::io;

use rustix::mm::{MapFlags, ProtFlags};

use super::channel::Channel;
use super::layout::{Area, PAGE};

/// The critical part of one instance's channel.
#[derive(Debug)]
pub(super) struct CriticalMemory {
    area: Area,
    used: usize,
    shared: Vec<Shared>,
}

/// Pages of the component that are shared.
#[derive(Debug, Clone, Copy)]
struct Shared {
    start: usize,
    size: usize,
    /// Their place in the critical part.
    place: usize,
}

impl CriticalMemory {
    /// Nothing is shared yet.
    pub(super) fn new(area: Area) -> Self {
        Self {
            area,
            used: 0,
            shared: Vec::new(),
        }
    }

    /// Shares the pages that hold this memory of the component; the memory's place in the critical
    /// part.
    ///
    /// # Errors
    /// If it is not readable (`EFAULT`), or there is no room for it.
    pub(super) fn share(
        &mut self,
        channel: &Channel,
        address: usize,
        size: usize,
    ) -> io::Result<usize> {
        let start = address / PAGE * PAGE;
        let end = address
            .checked_add(size)
            .and_then(|end| end.checked_next_multiple_of(PAGE))
            .ok_or(rustix::io::Errno::FAULT)?;
        let wanted = end - start;
        let known = self
            .shared
            .iter()
            .find(|shared| shared.start <= start && end <= shared.start + shared.size);
        if let Some(known) = known {
            return Ok(known.place + (address - known.start));
        }
        if wanted > self.area.size - self.used {
            return Err(rustix::io::Errno::NOMEM.into());
        }
        let place = self.used;
        exchange(channel, start, wanted, self.area.offset + place)?;
        self.used += wanted;
        self.shared.push(Shared {
            start,
            size: wanted,
            place,
        });
        Ok(place + (address - start))
    }
}

/// Puts the pages of the channel at `offset` where the component's are, with their content.
fn exchange(channel: &Channel, start: usize, size: usize, offset: usize) -> io::Result<()> {
    let mut copied = 0;
    while copied < size {
        let from = std::ptr::with_exposed_provenance::<u8>(start + copied);
        // SAFETY: the kernel reads, and refuses what is not readable.
        let more = unsafe {
            libc::pwrite(
                std::os::fd::AsRawFd::as_raw_fd(&channel.memory()),
                from.cast(),
                size - copied,
                libc::off_t::try_from(offset + copied).unwrap_or(libc::off_t::MAX),
            )
        };
        match usize::try_from(more) {
            Ok(more) if more > 0 => copied += more,
            _ => return Err(io::Error::last_os_error()),
        }
    }
    // SAFETY: exchanges pages that the component owns for such with the same content, while it
    // waits for the answer to its request.
    unsafe {
        rustix::mm::mmap(
            std::ptr::with_exposed_provenance_mut(start),
            size,
            ProtFlags::READ | ProtFlags::WRITE,
            MapFlags::SHARED | MapFlags::FIXED,
            channel.memory(),
            offset as u64,
        )
    }?;
    Ok(())
}
