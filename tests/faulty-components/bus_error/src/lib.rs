//! Reads a mapped page behind the end of its file.
#![allow(unsafe_code)] // the misbehaviour itself

use component_sdk::prelude::*;
use test_parts::{Faulty, FaultyPorts, Misbehaviour};

struct BusError;

impl Misbehaviour for BusError {
    fn misbehave(_ports: &FaultyPorts) -> Outcome {
        const LENGTH: usize = 4096;
        // SAFETY: the name is terminated.
        let file = unsafe { libc::memfd_create(c"empty".as_ptr(), libc::MFD_CLOEXEC) };
        let (protection, flags) = (libc::PROT_READ, libc::MAP_SHARED);
        // SAFETY: a new mapping at an address that the kernel chooses.
        let page = unsafe { libc::mmap(std::ptr::null_mut(), LENGTH, protection, flags, file, 0) };
        // SAFETY: the mapping keeps the file; the descriptor is ours.
        unsafe { libc::close(file) };
        if page == libc::MAP_FAILED {
            return Err(Failure::internal("the empty file was not mapped"));
        }
        // SAFETY: none; the file has no such page.
        let _never = unsafe { page.cast::<u8>().read_volatile() };
        Ok(())
    }
}

export_component!(Faulty<BusError>);
