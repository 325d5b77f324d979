//! Copies of library files in memory, one for each instance.
//!
//! A file is read once, whole, into sealed memory; a copy for the loader holds only the parts that
//! the loader maps. Names and places of functions, which are most of a library that was built with
//! debug information, are there once for all copies, and are those of the very bytes that were
//! loaded.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read as _};
use std::ops::Range;
use std::os::fd::AsRawFd as _;
use std::os::unix::fs::{FileExt as _, MetadataExt as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use object::{Object as _, ObjectSegment as _, ReadCache};
use rustix::fs::{MemfdFlags, SealFlags};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// The loader maps whole pages, of this size on every machine that we know of, or a multiple of it
/// to which the linker has aligned the parts.
const PAGE_BYTES: u64 = 4096;

/// All originals, and which of them each copy was made from, by the address of the copy. Nothing is
/// ever taken out: no library is unloaded.
static STORE: Mutex<Store> = Mutex::new(Store {
    handed_over: BTreeMap::new(),
    originals: Vec::new(),
    copies: BTreeMap::new(),
});

struct Store {
    /// By path: those that another process has read.
    handed_over: BTreeMap<PathBuf, Arc<Original>>,
    originals: Vec<Arc<Original>>,
    copies: BTreeMap<PathBuf, Arc<Original>>,
}

/// A library file as it was when it was read.
struct Original {
    identity: Identity,
    whole: File,
    size: u64,
    /// What the loader maps.
    mapped: Vec<Range<u64>>,
}

/// A file that is changed has another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Identity {
    device: u64,
    number: u64,
    size: u64,
    changed: (i64, i64),
}

impl Identity {
    fn of(file: &File) -> io::Result<Self> {
        let metadata = file.metadata()?;
        Ok(Self {
            device: metadata.dev(),
            number: metadata.ino(),
            size: metadata.size(),
            changed: (metadata.ctime(), metadata.ctime_nsec()),
        })
    }
}

/// A copy for the loader of the library at `path`, sealed, and the address by which the loader
/// finds it. It is used once: the loader compares names, so the copy must stay open for ever.
///
/// # Errors
/// If the file cannot be read or the machine has no room.
pub(super) fn copy(path: &Path) -> io::Result<(File, PathBuf)> {
    let original = original(path)?;
    let copy = memory_file(path)?;
    copy.set_len(original.size)?;
    for range in &original.mapped {
        let length = usize::try_from(range.end - range.start).unwrap_or(usize::MAX);
        let mut bytes = vec![0; length];
        original.whole.read_exact_at(&mut bytes, range.start)?;
        copy.write_all_at(&bytes, range.start)?;
    }
    seal(&copy)?;
    let address = address(&copy);
    store().copies.insert(address.clone(), original);
    Ok((copy, address))
}

/// The file that has all of a loaded one: of a copy the original, of any other file itself.
pub(crate) fn whole(file: &Path) -> PathBuf {
    match store().copies.get(file) {
        Some(original) => address(&original.whole),
        None => file.to_owned(),
    }
}

/// The whole library at `path` as it is now, sealed, for a process that shall load it, too.
///
/// # Errors
/// If the file cannot be read or the machine has no room.
pub(crate) fn sealed(path: &Path) -> io::Result<File> {
    original(path)?.whole.try_clone()
}

/// From now on the library at `path` is this one, which another process has read and sealed.
///
/// # Errors
/// If it cannot be read.
pub(crate) fn hand_over(path: &Path, whole: File) -> io::Result<()> {
    let original = Arc::new(Original {
        identity: Identity::of(&whole)?,
        size: whole.metadata()?.len(),
        mapped: mapped(&whole)?,
        whole,
    });
    store().handed_over.insert(path.to_owned(), original);
    Ok(())
}

/// Reads a file, if it was not read before or has changed since.
fn original(path: &Path) -> io::Result<Arc<Original>> {
    if let Some(original) = store().handed_over.get(path) {
        return Ok(Arc::clone(original));
    }
    let mut file = File::open(path)?;
    let identity = Identity::of(&file)?;
    let known = |one: &&Arc<Original>| one.identity == identity;
    if let Some(known) = store().originals.iter().find(known) {
        return Ok(Arc::clone(known));
    }
    let mut content = Vec::new();
    file.read_to_end(&mut content)?;
    let whole = memory_file(path)?;
    whole.write_all_at(&content, 0)?;
    seal(&whole)?;
    let original = Arc::new(Original {
        identity,
        size: content.len() as u64,
        mapped: mapped(&whole)?,
        whole,
    });
    store().originals.push(Arc::clone(&original));
    Ok(original)
}

/// The pages of a file that the loader maps, and the first one; of what is no library, all: the
/// loader says best what it is.
///
/// # Errors
/// If the file's size cannot be told.
fn mapped(file: &File) -> io::Result<Vec<Range<u64>>> {
    let size = file.metadata()?.len();
    let content = ReadCache::new(file);
    let Ok(library) = object::File::parse(&content) else {
        return Ok(std::iter::once(0..size).collect());
    };
    let segments = library.segments().map(|segment| segment.file_range());
    let header = std::iter::once((0, PAGE_BYTES));
    let ranges = header.chain(segments).map(|(start, length)| {
        let end = start.saturating_add(length).min(size);
        let end = end.next_multiple_of(PAGE_BYTES).min(size);
        (start / PAGE_BYTES * PAGE_BYTES).min(end)..end
    });
    Ok(ranges.collect())
}

fn memory_file(path: &Path) -> io::Result<File> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let flags = MemfdFlags::CLOEXEC | MemfdFlags::ALLOW_SEALING;
    let file = File::from(rustix::fs::memfd_create(name.as_ref(), flags)?);
    leave_room_for_files(&file);
    Ok(file)
}

/// Every copy stays open. By custom a process may open 1024 files unless it asks for more, which
/// hundreds of components need; half of them are left for other purposes.
fn leave_room_for_files(newest: &File) {
    let limit = getrlimit(Resource::Nofile);
    let number = u64::try_from(newest.as_raw_fd()).unwrap_or_default();
    if limit.current.is_some_and(|current| number >= current / 2) {
        // Refused only where it is the highest already; then the next file may be refused as well.
        let _highest = setrlimit(
            Resource::Nofile,
            Rlimit {
                current: limit.maximum,
                maximum: limit.maximum,
            },
        );
    }
}

fn seal(file: &File) -> io::Result<()> {
    let seals = SealFlags::SEAL | SealFlags::SHRINK | SealFlags::GROW | SealFlags::WRITE;
    Ok(rustix::fs::fcntl_add_seals(file, seals)?)
}

fn address(file: &File) -> PathBuf {
    PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()))
}

fn store() -> MutexGuard<'static, Store> {
    STORE.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// This test program is mapped as a library is.
    fn own_program() -> Vec<u8> {
        let file = std::env::current_exe().expect("a running test knows its file");
        std::fs::read(file).expect("and can read it")
    }

    #[test]
    fn a_copy_has_what_is_mapped_and_the_original_has_all() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("library.so");
        let content = own_program();
        std::fs::write(&path, &content).expect("a file");
        let (copied, address) = copy(&path).expect("a copy");
        assert_eq!(copied.metadata().expect("open").len(), content.len() as u64);
        let ranges = mapped(&copied).expect("readable");
        for range in ranges {
            let expected = &content[range.start as usize..range.end as usize];
            let mut bytes = vec![0; expected.len()];
            copied.read_exact_at(&mut bytes, range.start).expect("read");
            assert!(bytes == expected, "{range:?} differs");
        }
        let original = std::fs::read(whole(&address)).expect("the original");
        assert!(original == content, "the original has all");
        assert!(copied.write_all_at(&[0], 0).is_err(), "it is sealed");
        let elsewhere = Path::new("/somewhere/handed_over.so");
        hand_over(elsewhere, sealed(&path).expect("sealed")).expect("handed over");
        let (_copied, address) = copy(elsewhere).expect("a copy of what was handed over");
        assert!(std::fs::read(whole(&address)).expect("whole") == content);
        let other = Path::new("/somewhere/else.so");
        assert_eq!(whole(other), other);
    }

    #[test]
    fn a_file_that_was_changed_is_read_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("library.so");
        let mut copies = Vec::new();
        for content in ["first", "first", "second one"] {
            if std::fs::read_to_string(&path).ok().as_deref() != Some(content) {
                std::fs::write(&path, content).expect("a file");
            }
            let (_copied, address) = copy(&path).expect("a copy");
            copies.push((whole(&address), content));
        }
        for (original, content) in &copies {
            let kept = std::fs::read_to_string(original).expect("the original");
            assert_eq!(kept, *content);
        }
        assert_eq!(copies[0].0, copies[1].0, "it is read once");
    }

    #[test]
    fn names_and_places_are_not_copied() {
        let path = std::env::current_exe().expect("a running test knows its file");
        let file = File::open(path).expect("and can open it");
        let ranges = mapped(&file).expect("and read it");
        let copied: u64 = ranges.iter().map(|it| it.end - it.start).sum();
        let size = file.metadata().expect("it is there").len();
        assert!(copied < size / 2, "{copied} bytes");
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("text");
        std::fs::write(&path, "no library").expect("a file");
        let all = mapped(&File::open(path).expect("open")).expect("readable");
        assert_eq!(all, std::iter::once(0..10).collect::<Vec<_>>());
    }
}
