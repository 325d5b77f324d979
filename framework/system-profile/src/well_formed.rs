//! The rules of well-formedness that the event reader leaves to its user.

use std::ops::Range;

use quick_xml::XmlVersion;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::BytesRef;
use quick_xml::events::attributes::Attribute;

use crate::suggest::quoted;

/// What to write instead of a bare `&`.
pub(crate) const REFERENCE_HELP: &str =
    "`&` itself is written &amp;, and only &lt; &gt; &amp; &quot; &apos; and &#…; are known";

/// The first place where a document is not well-formed.
#[derive(Debug)]
pub(crate) struct Malformed {
    pub(crate) span: Range<usize>,
    pub(crate) message: String,
    pub(crate) help: String,
}

impl Malformed {
    pub(crate) fn new(
        span: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self {
            span,
            message: message.into(),
            help: help.into(),
        }
    }
}

/// Whether `name` is a name in the sense of XML.
pub(crate) fn is_name(name: &str) -> bool {
    let starts = |character: char| {
        character.is_alphabetic() || matches!(character, '_' | ':') || !character.is_ascii()
    };
    let continues =
        |character: char| starts(character) || matches!(character, '-' | '.' | '0'..='9');
    name.starts_with(starts) && name.chars().all(continues)
}

/// The first character that XML 1.0 does not allow anywhere.
pub(crate) fn illegal_character(text: &str) -> Option<Malformed> {
    let (offset, character) = text
        .char_indices()
        .find(|(_, character)| !is_allowed(*character))?;
    Some(Malformed::new(
        offset..offset + character.len_utf8(),
        format!("the character U+{:04X} is not allowed", character as u32),
        "remove it; if there are many, this is no text file or it is damaged",
    ))
}

fn is_allowed(character: char) -> bool {
    match character {
        '\t' | '\n' | '\r' => true,
        '\u{FFFE}' | '\u{FFFF}' => false,
        _ => character >= ' ',
    }
}

/// `]]>` may not stand in text.
pub(crate) fn check_text(text: &str, span: Range<usize>) -> Result<(), Malformed> {
    match text[span.clone()].find("]]>") {
        Some(offset) => {
            let start = span.start + offset;
            Err(Malformed::new(
                start..start + 3,
                "`]]>` in a text",
                "write it ]]&gt;",
            ))
        }
        None => Ok(()),
    }
}

/// The value of an attribute with its references resolved. `<` may not stand in it; old profiles
/// have it in C++ type names.
pub(crate) fn attribute_value(
    attribute: &Attribute<'_>,
    span: Range<usize>,
) -> Result<String, Malformed> {
    if let Some(offset) = attribute.value.find('<') {
        let start = span.start + offset;
        return Err(Malformed::new(
            start..start + 1,
            "`<` in the value of an attribute",
            "write it &lt; (and > as &gt;)",
        ));
    }
    let value = attribute
        .normalized_value(XmlVersion::Implicit1_0)
        .map_err(|error| format!("this value cannot be read: {}", quoted(&error.to_string())))
        .and_then(|value| match value.chars().all(is_allowed) {
            true => Ok(value.into_owned()),
            false => Err("this value refers to a character that is not allowed".into()),
        });
    value.map_err(|message| Malformed::new(span, message, REFERENCE_HELP))
}

/// What is forgiven in the value of an attribute that begins at `start`.
pub(crate) fn forgivable(attribute: &Attribute<'_>, start: usize) -> Malformed {
    let offset = attribute.value.find(['&', '<']).unwrap_or(0);
    let sign = attribute.value[offset..].chars().next().unwrap_or('&');
    Malformed::new(
        start + offset..start + offset + sign.len_utf8(),
        format!("`{sign}` in the value of an attribute"),
        "BehaviorTree.CPP reads it, too, but other tools do not: write &amp; for & and &lt; for <",
    )
}

/// The value of an attribute in which `&` and `<` may stand for themselves: references that are
/// known are resolved, blanks of all kinds become blanks.
pub(crate) fn forgiven_value(attribute: &Attribute<'_>) -> String {
    let mut value = String::new();
    let mut rest: &str = &attribute.value;
    while let Some(start) = rest.find('&') {
        value.push_str(&rest[..start]);
        rest = &rest[start..];
        let reference = rest.find(';').map(|end| &rest[1..end]);
        let character = reference.and_then(|name| {
            let resolved = BytesRef::new(name).resolve_char_ref().ok().flatten();
            let named = || resolve_predefined_entity(name)?.chars().next();
            resolved.or_else(named).filter(|it| is_allowed(*it))
        });
        let length = match (character, reference) {
            (Some(character), Some(name)) => {
                value.push(character);
                name.len() + 2
            }
            _ => {
                value.push('&');
                1
            }
        };
        rest = &rest[length..];
    }
    value.push_str(rest);
    value.replace(['\t', '\n', '\r'], " ")
}

/// The character that a reference in a text stands for.
pub(crate) fn resolve(reference: &BytesRef<'_>, span: Range<usize>) -> Result<char, Malformed> {
    let named = || {
        let replacement = resolve_predefined_entity(reference)?;
        replacement.chars().next()
    };
    let resolved = match reference.resolve_char_ref() {
        Ok(Some(character)) => Some(character),
        Ok(None) => named(),
        Err(_) => None,
    };
    resolved
        .filter(|character| is_allowed(*character))
        .ok_or_else(|| {
            Malformed::new(
                span,
                format!("the reference &{}; is not known", quoted(reference)),
                REFERENCE_HELP,
            )
        })
}
