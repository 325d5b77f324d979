//! Loading: a private copy in memory for every instance, so that statics, thread-locals and locks
//! of a dead copy stay dead. Never unloaded: Rust code with thread-locals cannot be.
#![allow(unsafe_code)] // the loader, and the descriptor of a foreign library

use std::mem;
use std::path::{Path, PathBuf};

use component_abi::{
    ABI_MAGIC, ABI_MAJOR, ABI_MINOR, ENTRY_SYMBOL, Header, LAYOUT_HASH, LibraryDescriptor,
};
use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};

use super::LibraryError;
use super::copy::copy;
use super::description::{ComponentDescription, describe};
use crate::guard::{CodeRange, LoadedObject};

/// One loaded copy of a component library.
#[derive(Debug, Clone)]
pub struct LoadedLibrary {
    /// What it says of itself.
    pub description: ComponentDescription,
    /// Where its code is.
    pub code: CodeRange,
    /// The file that it is a copy of.
    pub path: PathBuf,
}

impl LoadedLibrary {
    /// Loads a fresh copy of the library at `path`.
    ///
    /// # Errors
    /// If the file is unreadable, no library, no component, or for another container.
    pub fn load(path: &Path) -> Result<Self, LibraryError> {
        let library = open_copy(path)?;
        // SAFETY: only the address is taken; what it points to is checked below.
        let symbol = unsafe { library.get::<*const LibraryDescriptor>(ENTRY_SYMBOL.as_bytes()) };
        let Ok(symbol) = symbol else {
            return Err(LibraryError::NoComponent {
                path: path.to_owned(),
                symbol: ENTRY_SYMBOL,
            });
        };
        let descriptor: *const LibraryDescriptor = symbol.as_raw_ptr().cast_const().cast();
        // Never unloaded: see the module text.
        mem::forget(library);
        // SAFETY: a header is the first field of every version of the descriptor; the probe has
        // read it before, in a process of its own, if the container probes.
        let header = unsafe { descriptor.cast::<Header>().read() };
        check_header(&header, path)?;
        // SAFETY: the header says that this is a whole descriptor of our version; the copy is
        // never unloaded.
        let descriptor: &'static LibraryDescriptor = unsafe { &*descriptor };
        let description = describe(descriptor).map_err(|reason| LibraryError::Descriptor {
            path: path.to_owned(),
            reason,
        })?;
        let object =
            LoadedObject::around(std::ptr::from_ref(descriptor).addr()).ok_or_else(|| {
                LibraryError::Descriptor {
                    path: path.to_owned(),
                    reason: "it has no executable segment".to_owned(),
                }
            })?;
        Ok(Self {
            description,
            code: object.code,
            path: path.to_owned(),
        })
    }
}

/// Loads a copy of the file from sealed memory. The memory file stays open: the loader compares
/// names, and a number used again would give the old library.
fn open_copy(path: &Path) -> Result<Library, LibraryError> {
    let copied = copy(path).map_err(|error| LibraryError::Unreadable {
        path: path.to_owned(),
        error,
    });
    let (memory, address) = copied?;
    // SAFETY: runs the library's constructors; the probe has run them before in a process of its
    // own, if the container probes.
    let library = unsafe { Library::open(Some(&address), RTLD_NOW | RTLD_LOCAL) };
    let library = library.map_err(|error| LibraryError::NotALibrary {
        path: path.to_owned(),
        reason: loader_words(&error, &address.to_string_lossy()),
    })?;
    mem::forget(memory);
    Ok(library)
}

fn loader_words(error: &libloading::Error, address: &str) -> String {
    let mut text = error.to_string();
    if let libloading::Error::DlOpen { source } = error {
        text = source.to_string();
    }
    text.replace(&format!("{address}: "), "")
}

fn check_header(header: &Header, path: &Path) -> Result<(), LibraryError> {
    if header.magic != ABI_MAGIC {
        return Err(LibraryError::NoComponent {
            path: path.to_owned(),
            symbol: ENTRY_SYMBOL,
        });
    }
    let ours = format!("{ABI_MAJOR}.{ABI_MINOR}");
    // A library may be older than the container within one major version, not newer.
    let fits = header.major == ABI_MAJOR && ABI_MINOR.checked_sub(header.minor).is_some();
    let whole = header.size >= size_of::<LibraryDescriptor>() as u64;
    if !fits {
        return Err(LibraryError::Version {
            path: path.to_owned(),
            theirs: format!("{}.{}", header.major, header.minor),
            ours,
        });
    }
    if !whole || header.layout_hash != LAYOUT_HASH {
        return Err(LibraryError::Version {
            path: path.to_owned(),
            theirs: format!(
                "{}.{} with other table layouts (size {}, hash {:#x})",
                header.major, header.minor, header.size, header.layout_hash
            ),
            ours: format!(
                "{ours} (size {}, hash {LAYOUT_HASH:#x})",
                size_of::<LibraryDescriptor>()
            ),
        });
    }
    Ok(())
}
