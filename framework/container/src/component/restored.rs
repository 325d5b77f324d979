//! What became of an attempt to restore a checkpoint. Put in words by who has time for it.

use std::fmt;

/// What a person should know of a restoration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Restored {
    /// No checkpoints are taken of the component.
    NotKept,
    /// None is old enough and whole.
    Nothing {
        /// So many had a wrong checksum.
        broken: usize,
    },
    /// The component has registered no memory.
    NoMemory,
    /// The component has registered memory of another size.
    Misfit {
        /// Number of the checkpoint.
        sequence: u64,
        /// Its size.
        bytes: usize,
        /// Size of the memory.
        registered: usize,
    },
    /// The memory is what it was.
    Done {
        /// Number of the checkpoint.
        sequence: u64,
        /// So many newer ones had a wrong checksum.
        broken: usize,
    },
}

impl fmt::Display for Restored {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let broken = match *self {
            Self::NotKept => return formatter.write_str("no checkpoints are taken"),
            Self::NoMemory => return formatter.write_str("no memory is registered to restore"),
            Self::Misfit {
                sequence,
                bytes,
                registered,
            } => {
                return write!(
                    formatter,
                    "checkpoint {sequence} not restored: it has {bytes} bytes, the registered \
                     memory {registered}"
                );
            }
            Self::Nothing { broken } => {
                formatter.write_str("no checkpoint to restore")?;
                broken
            }
            Self::Done { sequence, broken } => {
                write!(formatter, "checkpoint {sequence} restored")?;
                broken
            }
        };
        match broken {
            0 => Ok(()),
            broken => write!(formatter, " ({broken} newer with wrong checksum)"),
        }
    }
}
