//! What is wrong with a file, where, and what to do about it. All problems of a file are collected.

use std::cell::{Cell, RefCell};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, SourceCode};
use system_model::specification::Place;

use crate::source::Source;

/// So many problems of one file are listed, then only counted: past this a person mends the first
/// ones and asks again, and a hostile file must not fill the memory with complaints about itself.
pub const MAX_PROBLEMS_PER_FILE: usize = 100;

/// How much a problem matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The file cannot be used.
    Error,
    /// The file can be used, but probably does not mean what its author thinks.
    Warning,
    /// Nothing is wrong; there is something to know.
    Note,
}

impl Severity {
    /// The word in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

/// One problem at one place.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Error, warning or note.
    pub severity: Severity,
    /// Where the offending text begins; line 0 where a whole file is meant.
    pub place: Place,
    /// How many characters offend.
    pub length: usize,
    /// What is wrong.
    pub message: String,
    /// What to do next.
    pub help: Option<String>,
    source: Arc<Source>,
    span: Range<usize>,
}

impl Problem {
    /// A problem with a span of bytes of `source`.
    pub fn new(
        severity: Severity,
        source: &Arc<Source>,
        span: Range<usize>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Self {
        let start = source.text().floor_char_boundary(span.start);
        let span = start..source.text().ceil_char_boundary(span.end).max(start);
        Self {
            severity,
            place: source.place(start),
            length: source.text()[span.clone()].chars().count(),
            message: message.into(),
            help,
            source: Arc::clone(source),
            span,
        }
    }

    /// An error about a whole file, one that could not be opened for instance.
    pub fn of_whole_file(
        source: &Arc<Source>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Self {
        let mut problem = Self::new(Severity::Error, source, 0..0, message, help);
        (problem.place.line, problem.place.column) = (0, 0);
        problem
    }

    /// Whether the offending text can be shown under the message.
    pub fn has_snippet(&self) -> bool {
        self.place.line > 0 && self.source.is_showable(self.span.start)
    }

    fn says_the_same(&self, other: &Self) -> bool {
        self.place == other.place && self.message == other.message
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for Problem {}

impl Diagnostic for Problem {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
            Severity::Note => miette::Severity::Advice,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let help = self.help.as_ref()?;
        Some(Box::new(help))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.has_snippet()
            .then_some(self.source.as_ref() as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = LabeledSpan::new_with_span(None, self.span.clone());
        self.has_snippet()
            .then(|| Box::new(std::iter::once(label)) as Box<dyn Iterator<Item = LabeledSpan>>)
    }
}

/// The problems of one file while it is being read.
#[derive(Debug)]
pub struct ProblemLog {
    source: Arc<Source>,
    listed: RefCell<Vec<Problem>>,
    unlisted_errors: Cell<usize>,
    unlisted_warnings: Cell<usize>,
}

impl ProblemLog {
    /// An empty log for a file.
    pub fn new(source: Arc<Source>) -> Self {
        Self {
            source,
            listed: RefCell::default(),
            unlisted_errors: Cell::new(0),
            unlisted_warnings: Cell::new(0),
        }
    }

    /// The file that the log is about.
    pub fn source(&self) -> &Arc<Source> {
        &self.source
    }

    /// Adds a problem; one that is already there is not repeated. In a full list an error takes the
    /// place of the last warning.
    pub fn add(&self, problem: Problem) {
        let mut listed = self.listed.borrow_mut();
        if listed.iter().any(|other| other.says_the_same(&problem)) {
            return;
        }
        if listed.len() < MAX_PROBLEMS_PER_FILE {
            listed.push(problem);
            return;
        }
        let warning = listed
            .iter()
            .rposition(|other| other.severity > problem.severity);
        match warning {
            Some(position) => {
                self.count(Severity::Warning);
                listed.remove(position);
                listed.push(problem);
            }
            None => self.count(problem.severity),
        }
    }

    /// Counts a problem that is not listed.
    pub(crate) fn count(&self, severity: Severity) {
        let unlisted = match severity {
            Severity::Error => &self.unlisted_errors,
            Severity::Warning => &self.unlisted_warnings,
            // A full list has more to say than that.
            Severity::Note => return,
        };
        unlisted.set(unlisted.get() + 1);
    }

    /// Adds an error at a span of bytes.
    pub fn error(&self, span: Range<usize>, message: impl Into<String>, help: Option<String>) {
        self.add(Problem::new(
            Severity::Error,
            &self.source,
            span,
            message,
            help,
        ));
    }

    /// Adds a warning at a span of bytes.
    pub fn warning(&self, span: Range<usize>, message: impl Into<String>, help: Option<String>) {
        self.add(Problem::new(
            Severity::Warning,
            &self.source,
            span,
            message,
            help,
        ));
    }

    /// Whether a further problem would still be listed; if not, composing its message is not worth
    /// while.
    pub(crate) fn has_room_for(&self, severity: Severity) -> bool {
        let listed = self.listed.borrow();
        listed.len() < MAX_PROBLEMS_PER_FILE || listed.iter().any(|other| other.severity > severity)
    }

    /// Whether there is any error.
    pub fn has_errors(&self) -> bool {
        let listed = self.listed.borrow();
        let is_error = |problem: &Problem| problem.severity == Severity::Error;
        self.unlisted_errors.get() > 0 || listed.iter().any(is_error)
    }

    /// All problems, sorted by place; a last one counts those that were not listed.
    pub fn problems(&self) -> Vec<Problem> {
        let mut problems = self.listed.borrow().clone();
        problems.sort_by_key(|problem| (problem.place.line, problem.place.column));
        let (errors, warnings) = (self.unlisted_errors.get(), self.unlisted_warnings.get());
        if errors + warnings > 0 {
            let end = self.source.text().len();
            let severity = match errors {
                0 => Severity::Warning,
                _ => Severity::Error,
            };
            problems.push(Problem::new(
                severity,
                &self.source,
                end..end,
                format!("{errors} more errors and {warnings} more warnings are not listed"),
                Some("mend the ones above and check again".into()),
            ));
        }
        problems
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log() -> ProblemLog {
        ProblemLog::new(Arc::new(Source::new("f.xml", "abc\ndef".repeat(100))))
    }

    #[test]
    fn problems_are_sorted_by_place_and_not_repeated() {
        let log = log();
        log.warning(5..6, "later", None);
        log.error(1..2, "earlier", None);
        log.error(1..2, "earlier", None);
        let messages: Vec<_> = log.problems().into_iter().map(|p| p.message).collect();
        assert_eq!(messages, ["earlier", "later"]);
        assert!(log.has_errors());
    }

    #[test]
    fn past_the_limit_problems_are_counted() {
        let log = log();
        for number in 0..MAX_PROBLEMS_PER_FILE + 7 {
            log.warning(number..number + 1, "odd", None);
        }
        assert!(!log.has_errors());
        assert!(!log.has_room_for(Severity::Warning));
        for number in 0..MAX_PROBLEMS_PER_FILE + 1 {
            assert_eq!(
                log.has_room_for(Severity::Error),
                number < MAX_PROBLEMS_PER_FILE
            );
            log.error(number..number + 1, "worse", None);
        }
        assert!(log.has_errors());
        let last = log.problems().pop().unwrap();
        assert_eq!(
            last.message,
            "1 more errors and 107 more warnings are not listed"
        );
        assert_eq!(last.severity, Severity::Error);
    }
}
