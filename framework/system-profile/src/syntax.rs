//! The event reader's syntax errors in the words of this crate, each with what to do about it.

use quick_xml::Error;
use quick_xml::errors::{IllFormedError, SyntaxError};
use quick_xml::events::attributes::AttrError;

use crate::suggest::quoted;
use crate::tree::Element;
use crate::well_formed::{Malformed, REFERENCE_HELP};

const TOO_SHORT: &str = "the file ends too early: is it whole?";

/// What the reader found at `at`, while `open` was the innermost open element.
pub(crate) fn offence(text: &str, error: &Error, at: usize, open: Option<&Element>) -> Malformed {
    let (message, help) = match error {
        Error::Syntax(error) => syntax(*error),
        Error::IllFormed(error) => ill_formed(text, error, open),
        other => (
            quoted(&other.to_string()),
            "correct the file, or export it again from its tool".to_owned(),
        ),
    };
    let rest = text.get(at..).unwrap_or_default();
    let length = match rest.find('>') {
        Some(end) if rest.starts_with("</") => end + 1,
        _ => rest.chars().next().map_or(0, char::len_utf8),
    };
    Malformed::new(at..at + length, message, help)
}

fn syntax(error: SyntaxError) -> (String, String) {
    let (message, help) = match error {
        SyntaxError::InvalidBangMarkup => (
            "`<!` that begins neither a comment nor a DOCTYPE",
            "a comment is written <!-- … -->",
        ),
        SyntaxError::UnclosedPI | SyntaxError::UnclosedXmlDecl => {
            ("`<?` without its `?>`", TOO_SHORT)
        }
        SyntaxError::UnclosedComment => ("a comment without its `-->`", TOO_SHORT),
        SyntaxError::UnclosedDoctype => ("a DOCTYPE without its `>`", TOO_SHORT),
        SyntaxError::UnclosedCData => ("a CDATA section without its `]]>`", TOO_SHORT),
        SyntaxError::UnclosedTag => ("a tag without its `>`", TOO_SHORT),
        SyntaxError::UnclosedSingleQuotedAttributeValue
        | SyntaxError::UnclosedDoubleQuotedAttributeValue => (
            "a tag with an attribute value that is never closed",
            "close the value with the quote that it begins with",
        ),
    };
    (message.to_owned(), help.to_owned())
}

fn ill_formed(text: &str, error: &IllFormedError, open: Option<&Element>) -> (String, String) {
    let (message, help) = match error {
        IllFormedError::MismatchedEndTag { expected, found } => {
            let line = open.map_or(1, |open| line_of(text, open.name_span.start));
            return (
                format!(
                    "</{}> where </{}> was expected",
                    quoted(found),
                    quoted(expected)
                ),
                format!("<{}> was opened in line {line}", quoted(expected)),
            );
        }
        IllFormedError::UnmatchedEndTag(name) => {
            return (
                format!("</{}> closes nothing", quoted(name)),
                "remove it, or write its start tag".to_owned(),
            );
        }
        IllFormedError::UnclosedReference => ("a bare `&`", REFERENCE_HELP),
        IllFormedError::DoubleHyphenInComment => (
            "`--` in a comment",
            "write a single `-`; only the end of a comment has two",
        ),
        IllFormedError::MissingDoctypeName => ("a DOCTYPE without a name", "remove it"),
        _ => (
            "an XML declaration that cannot be read",
            "write <?xml version=\"1.0\" encoding=\"utf-8\"?>",
        ),
    };
    (message.to_owned(), help.to_owned())
}

fn line_of(text: &str, offset: usize) -> usize {
    let before = text.as_bytes().get(..offset).unwrap_or_default();
    1 + before.iter().filter(|byte| **byte == b'\n').count()
}

/// What is wrong with the attributes of the tag whose name begins at `tag_start`.
pub(crate) fn attribute_offence(error: &AttrError, tag_start: usize) -> Malformed {
    let (offset, message) = match error {
        AttrError::ExpectedEq(at) => (at, "an attribute without `=`"),
        AttrError::ExpectedValue(at) => (at, "an attribute without a value"),
        AttrError::UnquotedValue(at) => (at, "an attribute value without quotes"),
        AttrError::ExpectedQuote(at, _) => (at, "an attribute value without a closing quote"),
        AttrError::Duplicated(at, _) => (at, "an attribute that the element already has"),
    };
    let at = tag_start + offset;
    Malformed::new(
        at..at + 1,
        message,
        "attributes are written name=\"value\", each name once",
    )
}
