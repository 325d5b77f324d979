//! Text to words.

use super::parser::ScriptError;

/// One word of a script.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Word {
    Number(f64),
    Text(String),
    Name(String),
    Sign(&'static str),
}

/// Longer signs first, so that `<=` is not taken for `<`.
const SIGNS: [&str; 30] = [
    ":=", "+=", "-=", "*=", "/=", "==", "!=", "<=", ">=", "&&", "||", "..", "=", "<", ">", "+",
    "-", "*", "/", "!", "~", "&", "|", "^", "?", ":", ";", "(", ")", ",",
];

/// All words of a text, each with the byte at which it begins.
pub(super) fn words(text: &str) -> Result<Vec<(usize, Word)>, ScriptError> {
    let mut words = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let (word, length) = match first {
            _ if first.is_whitespace() => {
                at += first.len_utf8();
                continue;
            }
            '\'' => quoted(rest, at)?,
            '0'..='9' => number(rest, at)?,
            '.' if rest[1..].starts_with(|next: char| next.is_ascii_digit()) => number(rest, at)?,
            _ if begins_name(first) => name(rest),
            _ => sign(rest, at)?,
        };
        words.push((at, word));
        at += length;
    }
    Ok(words)
}

fn begins_name(character: char) -> bool {
    character.is_alphabetic() || matches!(character, '_' | '@')
}

fn name(rest: &str) -> (Word, usize) {
    let ends = |character: char| !(character.is_alphanumeric() || matches!(character, '_' | '@'));
    let length = rest.find(ends).unwrap_or(rest.len());
    (Word::Name(rest[..length].to_owned()), length)
}

fn quoted(rest: &str, at: usize) -> Result<(Word, usize), ScriptError> {
    match rest[1..].find('\'') {
        Some(length) => Ok((Word::Text(rest[1..=length].to_owned()), length + 2)),
        None => Err(ScriptError::new(at, "a text without its closing '")),
    }
}

fn number(rest: &str, at: usize) -> Result<(Word, usize), ScriptError> {
    let wrong = || ScriptError::new(at, "a number that cannot be read");
    if let Some(digits) = rest.strip_prefix("0x").or_else(|| rest.strip_prefix("0X")) {
        let length = digits.find(|next: char| !next.is_ascii_alphanumeric());
        let length = length.unwrap_or(digits.len());
        let value = u64::from_str_radix(&digits[..length], 16).map_err(|_| wrong())?;
        // Beyond 2^53 the nearest number that can be written.
        return Ok((Word::Number(value as f64), length + 2));
    }
    let mut length = 0;
    let mut previous = ' ';
    for (offset, next) in rest.char_indices() {
        let joins = rest[offset..].starts_with("..");
        let exponent_sign = matches!(next, '+' | '-') && matches!(previous, 'e' | 'E');
        if joins || !(next.is_ascii_alphanumeric() || next == '.' || exponent_sign) {
            break;
        }
        (length, previous) = (offset + next.len_utf8(), next);
    }
    let value: f64 = rest[..length].parse().map_err(|_| wrong())?;
    match value.is_finite() {
        true => Ok((Word::Number(value), length)),
        false => Err(wrong()),
    }
}

fn sign(rest: &str, at: usize) -> Result<(Word, usize), ScriptError> {
    let found = SIGNS.iter().find(|sign| rest.starts_with(*sign));
    match found {
        Some(sign) => Ok((Word::Sign(sign), sign.len())),
        None => {
            let sign = rest.chars().next().unwrap_or(' ');
            Err(ScriptError::new(at, format!("`{sign}` means nothing here")))
        }
    }
}
