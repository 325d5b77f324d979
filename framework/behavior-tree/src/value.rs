//! What lies on a blackboard.

use std::fmt;
use std::sync::Arc;

/// A value of a blackboard, a port or a script. Copying one never allocates.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// `true` or `false`; in arithmetic 1 or 0.
    Boolean(bool),
    /// Any number; whole ones are exact up to 2^53.
    Number(f64),
    /// A text; also lists and structures, in the notation of whoever reads them.
    Text(Arc<str>),
}

impl Value {
    /// The value that a literal of a file stands for: `true`, `false`, a number, else its text.
    pub fn of_literal(text: &str) -> Self {
        match text.trim() {
            "true" => Self::Boolean(true),
            "false" => Self::Boolean(false),
            trimmed => match number(trimmed) {
                Some(number) => Self::Number(number),
                None => Self::Text(text.into()),
            },
        }
    }

    /// The value as a number, if it is one or a text that is one.
    pub fn as_number(&self) -> Option<f64> {
        match self {
            Self::Boolean(boolean) => Some(f64::from(u8::from(*boolean))),
            Self::Number(number) => Some(*number),
            Self::Text(text) => match text.trim() {
                "true" => Some(1.0),
                "false" => Some(0.0),
                text => number(text),
            },
        }
    }

    /// Whether the value counts as true: any number but 0. Other texts are neither true nor false.
    pub fn as_boolean(&self) -> Option<bool> {
        Some(self.as_number()? != 0.0)
    }

    /// Whether two values are the same, a number and its text taken for one another.
    pub fn equals(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Text(left), Self::Text(right)) => left == right,
            // As BehaviorTree.CPP does: 1.1 equals 1.0 + 0.1.
            _ => match (self.as_number(), other.as_number()) {
                (Some(left), Some(right)) => {
                    left == right || (left - right).abs() <= f64::from(f32::EPSILON)
                }
                _ => false,
            },
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Boolean(boolean) => boolean.fmt(formatter),
            Self::Number(number) => number.fmt(formatter),
            Self::Text(text) => text.fmt(formatter),
        }
    }
}

/// A finite number as files write it; words such as `inf` are texts.
fn number(text: &str) -> Option<f64> {
    let begins = text.starts_with(|first: char| first.is_ascii_digit() || "+-.".contains(first));
    let number: f64 = text.parse().ok().filter(|_| begins)?;
    number.is_finite().then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_what_they_look_like() {
        for (text, value) in [
            ("true", Value::Boolean(true)),
            (" false ", Value::Boolean(false)),
            ("42", Value::Number(42.0)),
            ("-0.5e1", Value::Number(-5.0)),
            ("1;2;3", Value::Text("1;2;3".into())),
            ("inf", Value::Text("inf".into())),
            ("", Value::Text("".into())),
        ] {
            assert_eq!(Value::of_literal(text), value, "{text}");
        }
    }

    #[test]
    fn a_number_equals_its_text_and_a_neighbour_by_rounding() {
        let (text, number) = (Value::Text("42".into()), Value::Number(42.0));
        assert!(text.equals(&number));
        assert!(Value::Text("true".into()).equals(&Value::Boolean(true)));
        assert!(Value::Number(1.0 + 0.1).equals(&Value::Number(1.1)));
        assert!(!Value::Text("red".into()).equals(&Value::Number(0.0)));
        assert!(!Value::Text("42".into()).equals(&Value::Text("42.0".into())));
        assert_eq!(Value::Text("red".into()).as_boolean(), None);
    }
}
