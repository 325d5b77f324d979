//! Where code lies in memory: by the instruction pointer a component's own code is told from the
//! C library's and from ours.

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

    /// The executable segments of the loaded object (program or library) that `address` is in.
    pub fn around(address: usize) -> Option<Self> {
        let mut search = Search {
            address,
            found: None,
        };
        // SAFETY: the callback keeps to its contract and `search` outlives the call.
        unsafe { libc::dl_iterate_phdr(Some(visit), (&raw mut search).cast()) };
        search.found
    }
}

struct Search {
    address: usize,
    found: Option<CodeRange>,
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
    for code in loaded
        .filter(|one| one.p_flags & libc::PF_X != 0)
        .map(range)
    {
        let found = search.found.get_or_insert(code);
        found.start = found.start.min(code.start);
        found.end = found.end.max(code.end);
    }
    1
}
