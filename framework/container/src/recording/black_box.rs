//! The black box: the last seconds in memory, written down around every fault.
//!
//! A fault opens a file, which begins some seconds before the fault was confirmed and ends some
//! seconds after it. A fault that comes while a file is open keeps it open for longer; one that
//! comes later opens another, which begins before it all the same.

mod folder;
mod memory;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use fault_manager::{FaultState, Verdict};
use recording::WriteError;

use super::options::BlackBoxOptions;
use super::record_file::{Entry, RecordFile, RecordedPort, Source};
use crate::clock::nanoseconds;
use folder::Folder;
use memory::Memory;

/// Each file may have such a part of what all may have together, so that there is always room for
/// the next one and the one before is still there. A burst that goes on goes on in another file.
const FILES_IN_FOLDER: u64 = 8;

/// Faults by which it is known that their files were opened. More than the fault manager keeps on
/// record at once; of older ones nothing new is said.
const KNOWN_FAULTS: usize = 4096;

/// The black box.
#[derive(Debug)]
pub(super) struct BlackBox {
    options: BlackBoxOptions,
    folder: Folder,
    memory: Memory,
    ports: Arc<[RecordedPort]>,
    about: Vec<(&'static str, String)>,
    known: BTreeSet<u64>,
    open: Option<Open>,
    written: Vec<PathBuf>,
}

/// The file of a fault.
#[derive(Debug)]
struct Open {
    file: RecordFile,
    until_ns: u64,
    /// What it is named after.
    title: String,
}

impl BlackBox {
    /// One that has seen nothing.
    ///
    /// # Errors
    /// If its folder cannot be made or read.
    pub(super) fn new(
        options: BlackBoxOptions,
        ports: Arc<[RecordedPort]>,
        about: Vec<(&'static str, String)>,
    ) -> Result<Self, WriteError> {
        Ok(Self {
            folder: Folder::open(&options.folder)?,
            memory: Memory::new(options.before, options.memory_bytes),
            options,
            ports,
            about,
            known: BTreeSet::new(),
            open: None,
            written: Vec::new(),
        })
    }

    /// Takes a message.
    ///
    /// # Errors
    /// If a file cannot be written; it is given up, and the next fault opens another one.
    pub(super) fn take(&mut self, entry: &Entry<'_>) -> Result<(), WriteError> {
        self.memory.keep(entry);
        let Some(open) = &mut self.open else {
            return Ok(());
        };
        if entry.log_ns > open.until_ns {
            return self.close();
        }
        self.write(entry)
    }

    /// Looks at a verdict that has just been taken: a fault that is confirmed opens a file, or keeps
    /// it open.
    ///
    /// # Errors
    /// If the file cannot be made or written.
    pub(super) fn judge(&mut self, now_ns: u64, verdict: &Verdict) -> Result<(), WriteError> {
        if verdict.state != FaultState::Confirmed || !self.known.insert(verdict.id.0) {
            return Ok(());
        }
        if self.known.len() > KNOWN_FAULTS {
            self.known.pop_first();
        }
        let until_ns = now_ns.saturating_add(nanoseconds(self.options.after));
        if let Some(open) = &mut self.open {
            open.until_ns = open.until_ns.max(until_ns);
            return Ok(());
        }
        let title = format!("{}-{}", verdict.component, verdict.kind);
        self.begin(title, until_ns)?;
        let begins_ns = now_ns.saturating_sub(nanoseconds(self.options.before));
        let memory = std::mem::take(&mut self.memory);
        let written = memory
            .since(begins_ns)
            .try_for_each(|entry| self.write(&entry));
        self.memory = memory;
        written
    }

    /// What was written so far can be read whatever happens to this process.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn flush(&mut self) -> Result<(), WriteError> {
        self.open.as_mut().map_or(Ok(()), |open| open.file.flush())
    }

    /// The end of the run.
    ///
    /// # Errors
    /// If the file cannot be written to its end.
    pub(super) fn finish(&mut self) -> Result<(), WriteError> {
        self.close()
    }

    /// The files that were begun, in order; older ones may have been removed since.
    pub(super) fn written(&self) -> &[PathBuf] {
        &self.written
    }

    fn begin(&mut self, title: String, until_ns: u64) -> Result<(), WriteError> {
        let others = self.options.folder_bytes - self.most_bytes();
        let path = self.folder.next(&title, others)?;
        let file = RecordFile::create(&path, &self.about, Arc::clone(&self.ports))?;
        self.written.push(path);
        self.open = Some(Open {
            file,
            until_ns,
            title,
        });
        Ok(())
    }

    fn most_bytes(&self) -> u64 {
        self.options.folder_bytes / FILES_IN_FOLDER
    }

    fn write(&mut self, entry: &Entry<'_>) -> Result<(), WriteError> {
        let most_bytes = self.most_bytes();
        let Some(open) = &mut self.open else {
            return Ok(());
        };
        if let Err(error) = open.file.write(entry) {
            self.open = None;
            return Err(error);
        }
        if open.file.writer().bytes() > most_bytes {
            let (title, until_ns) = (open.title.clone(), open.until_ns);
            self.close()?;
            self.begin(title, until_ns)?;
        }
        Ok(())
    }

    fn close(&mut self) -> Result<(), WriteError> {
        self.open.take().map_or(Ok(()), |open| open.file.finish())
    }
}

/// A message of which a copy is kept.
#[derive(Debug, Clone)]
struct Kept {
    source: Source,
    log_ns: u64,
    publish_ns: u64,
    content: Box<[u8]>,
}

#[cfg(test)]
mod tests;
