//! Where code lies in memory, and whose it is: by the instruction pointer a component's own code is told from the
//! C library's and from ours.

use std::ffi::{CStr, OsStr};
use std::os::unix::ffi::OsStrExt as _;
use std::path::PathBuf;

/// Segments of programs and libraries begin at multiples of this, whatever the kernel's pages are.
const PAGE_BYTES: usize = 64 * 1024;

/// Addresses of executable code, end exclusive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CodeRange {
    /// First address.
    pub start: usize,
    /// One past the last.
    pub end: usize,
}

impl CodeRange {
    /// Whether an address lies in it.
    #[inline]
    pub fn contains(self, address: usize) -> bool {
        (self.start..self.end).contains(&address)
    }

    /// Lets the calling process see all of it now, so that who runs it first need not wait for pages.
    pub(super) fn touch(self) {
        let start = self.start / PAGE_BYTES * PAGE_BYTES;
        let (start, length) = (start as *mut libc::c_void, self.end - start);
        let advice = rustix::mm::Advice::LinuxPopulateRead;
        // SAFETY: the range is code, which is only read.
        let _he_waits = unsafe { rustix::mm::madvise(start, length, advice) };
    }
}

/// A program or library that is loaded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LoadedObject {
    /// What must be added to an address of its file to have it in memory.
    pub base: usize,
    /// Its code in memory.
    pub code: CodeRange,
    /// Its file as the loader was given it; empty for the program itself. Of a component's copy it
    /// is the sealed memory that the copy was loaded from.
    pub file: PathBuf,
}

impl LoadedObject {
    /// The loaded object that an address is in, if that has code.
    pub fn around(address: usize) -> Option<Self> {
        let mut search = Search {
            address,
            found: None,
        };
        // SAFETY: the callback keeps to its contract and `search` outlives the call.
        unsafe { libc::dl_iterate_phdr(Some(visit), (&raw mut search).cast()) };
        search.found
    }

    /// Whether it is a library, and not the program itself.
    pub fn is_library(&self) -> bool {
        !self.file.as_os_str().is_empty()
    }
}

struct Search {
    address: usize,
    found: Option<LoadedObject>,
}

unsafe extern "C" fn visit(
    information: *mut libc::dl_phdr_info,
    _size: libc::size_t,
    data: *mut libc::c_void,
) -> libc::c_int {
    // SAFETY: the loader passes a valid record for the time of the call.
    let information = unsafe { &*information };
    // SAFETY: `data` is the search that was passed to `dl_iterate_phdr`.
    let search = unsafe { &mut *data.cast::<Search>() };
    let count = usize::from(information.dlpi_phnum);
    // SAFETY: the loader's table has `dlpi_phnum` entries.
    let segments = unsafe { std::slice::from_raw_parts(information.dlpi_phdr, count) };
    let range = |segment: &libc::Elf64_Phdr| {
        let start = information.dlpi_addr as usize + segment.p_vaddr as usize;
        CodeRange {
            start,
            end: start + segment.p_memsz as usize,
        }
    };
    let loaded = segments.iter().filter(|one| one.p_type == libc::PT_LOAD);
    let here = loaded
        .clone()
        .any(|one| range(one).contains(search.address));
    if !here {
        return 0;
    }
    let executable = loaded.filter(|one| one.p_flags & libc::PF_X != 0);
    let code = executable.map(range).reduce(|all, one| CodeRange {
        start: all.start.min(one.start),
        end: all.end.max(one.end),
    });
    search.found = code.map(|code| LoadedObject {
        base: information.dlpi_addr as usize,
        code,
        // SAFETY: the loader keeps a terminated name, or null.
        file: unsafe { file_name(information.dlpi_name) },
    });
    1
}

/// # Safety
/// `name` must be null or a terminated string.
unsafe fn file_name(name: *const libc::c_char) -> PathBuf {
    if name.is_null() {
        return PathBuf::new();
    }
    // SAFETY: by this function's contract.
    let name = unsafe { CStr::from_ptr(name) };
    PathBuf::from(OsStr::from_bytes(name.to_bytes()))
}
