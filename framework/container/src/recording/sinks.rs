//! Where messages go: into the file of everything, into the black box, or both.

use fault_manager::Verdict;
use recording::WriteError;

use super::black_box::BlackBox;
use super::record_file::{Entry, RecordFile};
use super::thread::RecordingSummary;

/// Where messages go. A file that cannot be written any further gets no more; the black box tries
/// again with the next fault.
#[derive(Debug)]
pub(super) struct Sinks {
    file: Option<RecordFile>,
    black_box: Option<BlackBox>,
    /// Why a file could not be written: the first reason counts.
    failure: Option<WriteError>,
    /// Whether somebody was told.
    told: bool,
}

impl Sinks {
    /// Into these.
    pub(super) fn new(file: Option<RecordFile>, black_box: Option<BlackBox>) -> Self {
        Self {
            file,
            black_box,
            failure: None,
            told: false,
        }
    }

    /// Writes a message.
    pub(super) fn write(&mut self, entry: &Entry<'_>) {
        if let Some(black_box) = &mut self.black_box {
            let taken = black_box.take(entry);
            self.note(taken);
        }
        self.with_file(|file| file.write(entry));
    }

    /// Lets the black box look at a verdict that was written.
    pub(super) fn judge(&mut self, now_ns: u64, verdict: &Verdict) {
        if let Some(black_box) = &mut self.black_box {
            let judged = black_box.judge(now_ns, verdict);
            self.note(judged);
        }
    }

    /// What was written so far can be read whatever happens to this process; in words, once, what
    /// could not be written.
    pub(super) fn flush(&mut self) -> Option<String> {
        self.with_file(RecordFile::flush);
        if let Some(black_box) = &mut self.black_box {
            let flushed = black_box.flush();
            self.note(flushed);
        }
        let failure = self.failure.as_ref().filter(|_| !self.told)?;
        self.told = true;
        Some(failure.to_string())
    }

    /// Ends all files.
    pub(super) fn finish(mut self) -> RecordingSummary {
        let mut summary = RecordingSummary::default();
        if let Some(file) = self.file.take() {
            summary.messages = file.writer().messages();
            summary.file = Some(file.writer().path().to_owned());
            self.note(file.finish());
        }
        if let Some(mut black_box) = self.black_box.take() {
            self.note(black_box.finish());
            summary.black_box = black_box.written().to_vec();
        }
        summary.failure = self.failure.map(|failure| failure.to_string());
        summary
    }

    fn with_file(&mut self, act: impl FnOnce(&mut RecordFile) -> Result<(), WriteError>) {
        if let Some(file) = &mut self.file
            && let Err(error) = act(file)
        {
            self.file = None;
            self.note(Err(error));
        }
    }

    fn note(&mut self, result: Result<(), WriteError>) {
        if let Err(error) = result {
            self.failure.get_or_insert(error);
        }
    }
}
