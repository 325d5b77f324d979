//! What is wrong with a tree, where, and what to do about it.

use system_model::profile::Located;

/// One problem at one place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Whether the tree cannot be used; else it probably does not mean what its author thinks.
    pub is_error: bool,
    /// The offending text and its place.
    pub at: Located<String>,
    /// What is wrong.
    pub message: String,
    /// What to do next.
    pub help: String,
    /// Where a name is wrong: those that may stand there, for a reader to choose the nearest from.
    pub candidates: Vec<String>,
}

impl Finding {
    pub(crate) fn error(
        at: &Located<String>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self {
            is_error: true,
            at: at.clone(),
            message: message.into(),
            help: help.into(),
            candidates: Vec::new(),
        }
    }

    pub(crate) fn warning(
        at: &Located<String>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self {
            is_error: false,
            ..Self::error(at, message, help)
        }
    }

    pub(crate) fn among<'a>(mut self, candidates: impl IntoIterator<Item = &'a str>) -> Self {
        self.candidates = candidates.into_iter().map(str::to_owned).collect();
        self
    }
}
