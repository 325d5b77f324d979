//! What one file holds, as bytes and back: whose memory it is, from when, and the memory. Nothing of
//! a file is believed before its checksum was right.
//!
//! All numbers are little-endian:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `STEADFST` |
//! | 4 | version of the format |
//! | 8 | length of the whole file |
//! | 8, 8, 4, 8 | number of the writing, number of the checkpoint, incarnation, nanoseconds since 1970 |
//! | 4 + n, three times | application, component, file name of the library, as UTF-8 |
//! | 4 | CRC-32C of the library |
//! | 8 + n | memory |
//! | 4 | CRC-32C (RFC 3720) of everything before it |

mod fields;

use std::time::Duration;

use crc32c::crc32c;
use fields::{Fields, put_bytes, put_text};

const MAGIC: [u8; 8] = *b"STEADFST";

/// To be raised whenever the layout changes: an older container refuses the file, in words.
const VERSION: u32 = 1;

/// Magic, version and length: what is looked at before the checksum.
const HEADER_BYTES: usize = 20;

/// CRC-32C, for which processors have an instruction.
const CHECKSUM_BYTES: usize = 4;

/// Largest memory that is kept: a map of 40 m by 40 m, one byte for each square centimetre. Ten of
/// these in a second are as much as a flash card can write.
pub const LARGEST_MEMORY: usize = 16 << 20;

/// By how much a file may seem to come from the future: as far as a time service moves the clock of
/// a machine that had been without one for a day.
pub const CLOCK_TOLERANCE: Duration = Duration::from_secs(10);

/// The very library: a checkpoint of another build may have another layout.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LibraryIdentity {
    /// File name.
    pub name: String,
    /// CRC-32C of its content.
    pub checksum: u32,
}

impl LibraryIdentity {
    /// Of a library with this file name and content.
    pub fn of(name: String, content: &[u8]) -> Self {
        Self {
            name,
            checksum: crc32c(content),
        }
    }
}

/// Whose memory it is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// Name of the application.
    pub application: String,
    /// Name of the component in it.
    pub component: String,
    /// The library that had registered the memory.
    pub library: LibraryIdentity,
}

/// What one file holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Record {
    /// Whose memory it is.
    pub origin: Origin,
    /// Counts the writings of this component's files, over all runs; the newest file has the highest.
    pub written: u64,
    /// Number of the checkpoint.
    pub sequence: u64,
    /// Incarnation that it was taken of.
    pub incarnation: u32,
    /// When it was taken, since the beginning of 1970 by the machine's clock.
    pub taken: Duration,
    /// The memory.
    pub memory: Vec<u8>,
}

/// Why a file is not restored.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// It cannot be read.
    #[error("it cannot be read: {0}")]
    Unreadable(String),
    /// No magic.
    #[error("it is no checkpoint")]
    NoCheckpoint,
    /// Of another version of the format.
    #[error("it has version {theirs} of the format, this container reads version {VERSION}")]
    Version {
        /// The file's.
        theirs: u32,
    },
    /// Some of it is missing, or there is more than was written.
    #[error("it is torn: {has} bytes of {written}")]
    Torn {
        /// Bytes that there are.
        has: u64,
        /// Bytes that there were to be, as far as can be known.
        written: u64,
    },
    /// What it says is not what was written.
    #[error("its checksum is wrong")]
    Checksum,
    /// It was written so.
    #[error("its checksum is right, but its fields do not fit its length")]
    Malformed,
    /// Of another application, component or library.
    #[error("it is foreign: of {what} '{theirs}', not '{ours}'")]
    Foreign {
        /// `application`, `component` or `library`.
        what: &'static str,
        /// The file's.
        theirs: String,
        /// What was expected.
        ours: String,
    },
    /// Of a library of the same name with another content.
    #[error("it is foreign: of another build of library '{0}'")]
    OtherBuild(String),
    /// The component registers more or less memory now.
    #[error("it is foreign: it has {theirs} bytes, the registered memory {ours}")]
    Size {
        /// The file's.
        theirs: usize,
        /// What is registered.
        ours: usize,
    },
    /// Too old.
    #[error("it is stale: {age:.1?} old, at most {max_age:?} is allowed")]
    Stale {
        /// How old it is.
        age: Duration,
        /// What the rule allows.
        max_age: Duration,
    },
    /// Its age cannot be known.
    #[error("it is of {ahead:.1?} from now: the machine's clock was set back")]
    Future {
        /// By how much.
        ahead: Duration,
    },
}

impl Record {
    /// One without memory, which was never written.
    pub fn new(origin: Origin) -> Self {
        Self {
            origin,
            written: 0,
            sequence: 0,
            incarnation: 0,
            taken: Duration::ZERO,
            memory: Vec::new(),
        }
    }

    /// Writes it to `bytes`, in place of what was in there.
    pub fn encode(&self, bytes: &mut Vec<u8>) {
        bytes.clear();
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend([0; 8]);
        bytes.extend(self.written.to_le_bytes());
        bytes.extend(self.sequence.to_le_bytes());
        bytes.extend(self.incarnation.to_le_bytes());
        let taken_ns = u64::try_from(self.taken.as_nanos()).unwrap_or(u64::MAX);
        bytes.extend(taken_ns.to_le_bytes());
        put_text(bytes, &self.origin.application);
        put_text(bytes, &self.origin.component);
        put_text(bytes, &self.origin.library.name);
        bytes.extend(self.origin.library.checksum.to_le_bytes());
        put_bytes(bytes, &self.memory);
        let length = (bytes.len() + CHECKSUM_BYTES) as u64;
        bytes[12..HEADER_BYTES].copy_from_slice(&length.to_le_bytes());
        bytes.extend(crc32c(bytes).to_le_bytes());
    }

    /// Reads the content of a file.
    ///
    /// # Errors
    /// If it is not the whole of what was written by this version of the container.
    pub fn decode(bytes: &[u8]) -> Result<Self, Refusal> {
        let torn = |written: u64| Refusal::Torn {
            has: bytes.len() as u64,
            written,
        };
        let shared = bytes.len().min(MAGIC.len());
        if bytes[..shared] != MAGIC[..shared] {
            return Err(Refusal::NoCheckpoint);
        }
        let mut header = Fields::new(bytes.get(MAGIC.len()..).unwrap_or_default());
        let version = header.u32().ok_or(torn(HEADER_BYTES as u64))?;
        if version != VERSION {
            return Err(Refusal::Version { theirs: version });
        }
        let written = header.u64().ok_or(torn(HEADER_BYTES as u64))?;
        if written != bytes.len() as u64 {
            return Err(torn(written));
        }
        let end = bytes.len().checked_sub(CHECKSUM_BYTES);
        let (content, checksum) = bytes.split_at(end.ok_or(Refusal::Malformed)?);
        if checksum != crc32c(content).to_le_bytes() {
            return Err(Refusal::Checksum);
        }
        let body = content.get(HEADER_BYTES..).ok_or(Refusal::Malformed)?;
        Self::read(&mut Fields::new(body)).ok_or(Refusal::Malformed)
    }

    fn read(fields: &mut Fields<'_>) -> Option<Self> {
        let (written, sequence) = (fields.u64()?, fields.u64()?);
        let (incarnation, taken_ns) = (fields.u32()?, fields.u64()?);
        let (application, component) = (fields.text()?, fields.text()?);
        let library = LibraryIdentity {
            name: fields.text()?,
            checksum: fields.u32()?,
        };
        let memory = fields.bytes()?.to_vec();
        fields.is_empty().then_some(Self {
            origin: Origin {
                application,
                component,
                library,
            },
            written,
            sequence,
            incarnation,
            taken: Duration::from_nanos(taken_ns),
            memory,
        })
    }

    /// How old it is at `now` (since the beginning of 1970), if it may be restored to a component
    /// that is `expected`, has registered `size` bytes (none: not known yet), and goes on from
    /// nothing older than `max_age`.
    ///
    /// # Errors
    /// Why it may not.
    pub fn age_if_fit(
        &self,
        expected: &Origin,
        size: Option<usize>,
        now: Duration,
        max_age: Duration,
    ) -> Result<Duration, Refusal> {
        let (theirs, ours) = (&self.origin, expected);
        for (what, theirs, ours) in [
            ("application", &theirs.application, &ours.application),
            ("component", &theirs.component, &ours.component),
            ("library", &theirs.library.name, &ours.library.name),
        ] {
            if theirs != ours {
                return Err(Refusal::Foreign {
                    what,
                    theirs: theirs.clone(),
                    ours: ours.clone(),
                });
            }
        }
        if theirs.library.checksum != ours.library.checksum {
            return Err(Refusal::OtherBuild(ours.library.name.clone()));
        }
        if let Some(ours) = size.filter(|size| *size != self.memory.len()) {
            let theirs = self.memory.len();
            return Err(Refusal::Size { theirs, ours });
        }
        let ahead = self.taken.saturating_sub(now);
        if ahead > CLOCK_TOLERANCE {
            return Err(Refusal::Future { ahead });
        }
        let age = now.saturating_sub(self.taken);
        if age > max_age {
            return Err(Refusal::Stale { age, max_age });
        }
        Ok(age)
    }
}

#[cfg(test)]
mod tests;
