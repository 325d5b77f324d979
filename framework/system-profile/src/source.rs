//! The decoded text of one file, and the way from a byte offset to the line and column of a person.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use system_model::specification::Place;

/// Every so many bytes the number of characters before them is remembered, so that a column costs
/// the same in a file of one enormous line.
const CHARACTER_INDEX_STEP: usize = 1024;

/// A longer line is not shown under its problem; it would fill the terminal.
const MAX_LINE_SHOWN: usize = 400;

/// The decoded text of one file.
pub struct Source {
    path: PathBuf,
    text: String,
    line_starts: Vec<usize>,
    characters_before: Vec<usize>,
}

impl Source {
    /// Takes the text of `path`.
    pub fn new(path: impl Into<PathBuf>, text: impl Into<String>) -> Self {
        let text = text.into();
        let mut line_starts = vec![0];
        let mut characters_before = Vec::with_capacity(text.len() / CHARACTER_INDEX_STEP + 1);
        let mut characters = 0;
        for (offset, byte) in text.bytes().enumerate() {
            if offset % CHARACTER_INDEX_STEP == 0 {
                characters_before.push(characters);
            }
            characters += usize::from(starts_a_character(byte));
            if byte == b'\n' {
                line_starts.push(offset + 1);
            }
        }
        Self {
            path: path.into(),
            text,
            line_starts,
            characters_before,
        }
    }

    /// The file, as it was named.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The line and column of a byte offset; an offset past the end is the end.
    pub fn place(&self, offset: usize) -> Place {
        let offset = offset.min(self.text.len());
        let line = self.line_starts.partition_point(|start| *start <= offset);
        let start = self.line_starts[line - 1];
        // Of a line of usual length it is cheaper to count the characters themselves.
        let before = match offset - start < CHARACTER_INDEX_STEP {
            true => characters(&self.text.as_bytes()[start..offset]),
            false => self.characters_up_to(offset) - self.characters_up_to(start),
        };
        let column = before + 1;
        Place {
            file: self.path.clone(),
            line: u32::try_from(line).unwrap_or(u32::MAX),
            column: u32::try_from(column).unwrap_or(u32::MAX),
        }
    }

    /// The bytes of `length` characters from `place` on, never past the end of the line.
    pub fn span(&self, place: &Place, length: usize) -> Range<usize> {
        let Some(line) = (place.line as usize).checked_sub(1) else {
            return 0..0;
        };
        let Some(&start) = self.line_starts.get(line) else {
            return self.text.len()..self.text.len();
        };
        let rest = self.text[start..].split('\n').next().unwrap_or_default();
        let byte_of = |character: usize| {
            let found = rest.char_indices().nth(character);
            start + found.map_or(rest.len(), |(offset, _)| offset)
        };
        let first = (place.column as usize).saturating_sub(1);
        byte_of(first)..byte_of(first.saturating_add(length))
    }

    /// Whether the line at `offset` and its neighbours can be shown on a terminal: not too long, and
    /// without control characters, which a terminal would obey.
    pub(crate) fn is_showable(&self, offset: usize) -> bool {
        let line = self
            .line_starts
            .partition_point(|start| *start <= offset.min(self.text.len()));
        let bound = |line: usize| self.line_starts.get(line).copied();
        let start = bound(line.saturating_sub(2)).unwrap_or(0);
        let end = bound(line + 1).unwrap_or(self.text.len());
        self.text[start..end].lines().all(|line| {
            line.len() <= MAX_LINE_SHOWN
                && !line.contains(|c: char| c.is_control() && c != '\t' && c != '\r')
        })
    }

    fn characters_up_to(&self, offset: usize) -> usize {
        let step = offset / CHARACTER_INDEX_STEP;
        let Some(before) = self.characters_before.get(step) else {
            return self.text.chars().count();
        };
        before + characters(&self.text.as_bytes()[step * CHARACTER_INDEX_STEP..offset])
    }
}

/// Only the name: a problem holds its source, and printing it must not print the whole file.
impl fmt::Debug for Source {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Source").field(&self.path).finish()
    }
}

fn characters(text: &[u8]) -> usize {
    text.iter()
        .filter(|byte| starts_a_character(**byte))
        .count()
}

fn starts_a_character(byte: u8) -> bool {
    byte & 0b1100_0000 != 0b1000_0000
}

impl SourceCode for Source {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        context_lines_before: usize,
        context_lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let contents = self
            .text
            .read_span(span, context_lines_before, context_lines_after)?;
        Ok(Box::new(MietteSpanContents::new_named(
            self.path.display().to_string(),
            contents.data(),
            *contents.span(),
            contents.line(),
            contents.column(),
            contents.line_count(),
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let source = Source::new("f.xml", "<a>\n한글<b/>\n");
        let offset = source.text().find("<b").unwrap();
        let place = source.place(offset);
        assert_eq!((place.line, place.column), (2, 3));
        assert_eq!(source.span(&place, 2), offset..offset + 2);
    }

    #[test]
    fn a_column_far_into_one_line_is_exact() {
        let text = format!("{}x", "글".repeat(5000));
        let source = Source::new("f.xml", text);
        let place = source.place(source.text().len() - 1);
        assert_eq!((place.line, place.column), (1, 5001));
        assert_eq!(&source.text()[source.span(&place, 1)], "x");
    }

    #[test]
    fn offsets_and_places_past_the_end_are_the_end() {
        let source = Source::new("f.xml", "ab");
        assert_eq!(source.place(99).column, 3);
        let beyond = Place {
            line: 9,
            column: 9,
            ..Place::default()
        };
        assert_eq!(source.span(&beyond, 4), 2..2);
    }

    #[test]
    fn a_terminal_is_shown_neither_long_lines_nor_control_characters() {
        assert!(Source::new("f.xml", "<a>\r\n\t<b/>\n").is_showable(3));
        assert!(!Source::new("f.xml", "<a>\n\u{1b}[2J").is_showable(0));
        assert!(!Source::new("f.xml", "x".repeat(MAX_LINE_SHOWN + 1)).is_showable(0));
    }

    #[test]
    fn an_empty_text_has_one_line() {
        let place = Source::new("f.xml", "").place(0);
        assert_eq!((place.line, place.column), (1, 1));
    }
}
