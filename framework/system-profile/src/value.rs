//! A text that becomes typed once, with a problem at its place if it cannot.

use std::ops::Range;
use std::str::FromStr;

use system_model::profile::Located;
use system_model::specification::Place;

use crate::problem::ProblemLog;
use crate::suggest::{self, quoted};

/// The text of an element or the value of an attribute, without blanks at its ends.
#[derive(Debug, Clone)]
pub struct Value<'a> {
    text: &'a str,
    span: Range<usize>,
    log: &'a ProblemLog,
    owner: String,
}

/// A number that [`Value::number`] can read.
pub trait Number: FromStr {
    /// What to call it in a message.
    const KIND: &'static str;
    /// Whether it can be reckoned with.
    fn is_usable(&self) -> bool;
}

macro_rules! numbers {
    ($($type:ty: $kind:literal, $usable:expr;)*) => {$(
        impl Number for $type {
            const KIND: &'static str = $kind;
            fn is_usable(&self) -> bool {
                let usable: fn(&Self) -> bool = $usable;
                usable(self)
            }
        }
    )*};
}

numbers! {
    f64: "a finite number such as 0.5", |number| number.is_finite();
    f32: "a finite number such as 0.5", |number| number.is_finite();
    u8: "a whole number from 0 to 255", |_| true;
    u16: "a whole number from 0 to 65535", |_| true;
    u32: "a whole number, not negative", |_| true;
    u64: "a whole number, not negative", |_| true;
    usize: "a whole number, not negative", |_| true;
    i32: "a whole number", |_| true;
    i64: "a whole number", |_| true;
}

impl<'a> Value<'a> {
    pub(crate) fn new(
        text: &'a str,
        span: Range<usize>,
        log: &'a ProblemLog,
        owner: String,
    ) -> Self {
        Self {
            text,
            span,
            log,
            owner,
        }
    }

    /// The text.
    pub fn as_str(&self) -> &'a str {
        self.text
    }

    /// What holds the text, as it is called in messages.
    pub(crate) fn owner(&self) -> &str {
        &self.owner
    }

    /// Whether there is no text.
    pub fn is_empty(&self) -> bool {
        self.text.is_empty()
    }

    /// Where the text begins.
    pub fn place(&self) -> Place {
        self.log.source().place(self.span.start)
    }

    /// The text with its place.
    pub fn located(&self) -> Located<String> {
        Located {
            value: self.text.to_owned(),
            place: self.place(),
        }
    }

    /// The text as a number; anything else is an error.
    pub fn number<T: Number>(&self) -> Option<T> {
        let number = self.text.parse::<T>().ok().filter(Number::is_usable);
        if number.is_none() {
            self.error(
                format!("`{}` in {} is no number", quoted(self.text), self.owner),
                Some(format!("write {}", T::KIND)),
            );
        }
        number
    }

    /// The whole number that the old engine's `atoi` would have read, with a warning if the text is
    /// not just that number.
    pub fn lenient_integer(&self) -> i64 {
        if let Ok(number) = self.text.parse() {
            return number;
        }
        let unsigned = self.text.trim_start_matches(['+', '-']);
        let digits = unsigned.len()
            - unsigned
                .trim_start_matches(|c: char| c.is_ascii_digit())
                .len();
        let signs = self.text.len() - unsigned.len();
        let number = match (signs, digits) {
            (0 | 1, 1..) => {
                let too_large = if self.text.starts_with('-') {
                    i64::MIN
                } else {
                    i64::MAX
                };
                self.text[..signs + digits].parse().unwrap_or(too_large)
            }
            _ => 0,
        };
        self.warning(
            format!(
                "`{}` in {} is read as {number}",
                quoted(self.text),
                self.owner
            ),
            Some(format!("write a whole number, without a unit: {number}")),
        );
        number
    }

    /// What the text stands for among `choices`; anything else is an error that lists them.
    pub fn choice<T: Clone>(&self, choices: &[(&str, T)]) -> Option<T> {
        let chosen = choices.iter().find(|(word, _)| *word == self.text);
        if chosen.is_none() {
            self.error(
                format!(
                    "`{}` in {} is not understood",
                    quoted(self.text),
                    self.owner
                ),
                suggest::help(
                    self.text,
                    "it may be",
                    choices.iter().map(|(word, _)| *word),
                ),
            );
        }
        chosen.map(|(_, meaning)| meaning.clone())
    }

    /// `on`, `true` or `1`; `off`, `false` or `0`.
    pub fn boolean(&self) -> Option<bool> {
        self.choice(&[
            ("true", true),
            ("false", false),
            ("on", true),
            ("off", false),
            ("1", true),
            ("0", false),
        ])
    }

    /// Reports an error with this text.
    pub fn error(&self, message: impl Into<String>, help: Option<String>) {
        self.log.error(self.span.clone(), message, help);
    }

    /// Reports a warning about this text.
    pub fn warning(&self, message: impl Into<String>, help: Option<String>) {
        self.log.warning(self.span.clone(), message, help);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::source::Source;

    fn with<T>(text: &str, read: impl Fn(Value<'_>) -> T) -> (T, Vec<String>) {
        let log = ProblemLog::new(Arc::new(Source::new("f.xml", text)));
        let result = read(Value::new(text, 0..text.len(), &log, "<period>".into()));
        let messages = log.problems().into_iter().map(|p| p.message).collect();
        (result, messages)
    }

    #[test]
    fn integers_are_read_as_the_old_engine_did() {
        for (text, number, warnings) in [
            ("20", 20, 0),
            ("-3", -3, 0),
            ("+7", 7, 0),
            ("20ms", 20, 1),
            ("2.5", 2, 1),
            ("abc", 0, 1),
            ("--3", 0, 1),
            ("-", 0, 1),
            ("99999999999999999999", i64::MAX, 1),
            ("-99999999999999999999x", i64::MIN, 1),
        ] {
            let (read, problems) = with(text, |value| value.lenient_integer());
            assert_eq!((read, problems.len()), (number, warnings), "{text}");
        }
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(with("0.5", |value| value.number::<f64>()).0, Some(0.5));
        for text in ["inf", "NaN", "1e999", "", "0,5", "1 m"] {
            let (read, problems) = with(text, |value| value.number::<f64>());
            assert_eq!((read, problems.len()), (None, 1), "{text}");
        }
        assert_eq!(with("-1", |value| value.number::<u32>()).0, None);
    }

    #[test]
    fn words_are_understood_or_listed() {
        assert_eq!(with("on", |value| value.boolean()).0, Some(true));
        let (read, problems) = with("ture", |value| value.boolean());
        assert_eq!(read, None);
        assert_eq!(problems, ["`ture` in <period> is not understood"]);
    }
}
