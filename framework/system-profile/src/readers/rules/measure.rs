//! Numbers and times of rules, each within its bounds.

use std::time::Duration;

use system_model::profile::Located;

use crate::node::Node;
use crate::suggest::quoted;
use crate::value::Value;

/// A longer time is a mistake of unit.
const MAX_DURATION: Duration = Duration::from_secs(7 * 24 * 60 * 60);

/// Units in seconds, longer names before those that they end with.
const UNITS: [(&str, f64); 7] = [
    ("ns", 1e-9),
    ("us", 1e-6),
    ("µs", 1e-6),
    ("ms", 1e-3),
    ("min", 60.0),
    ("s", 1.0),
    ("h", 3600.0),
];

const MILLISECOND_S: f64 = 1e-3;

const DURATION_HELP: &str =
    "write a number of milliseconds, or a number with its unit: 60, 10s, 500us, 2min";

/// A setting of a rule: an attribute, or a child of the same name.
pub(super) fn setting<'a>(node: &Node<'a>, name: &'static str) -> Option<Value<'a>> {
    setting_of(node, &[name])
}

/// As [`setting`], for several names of the same meaning.
pub(super) fn setting_of<'a>(node: &Node<'a>, names: &[&'static str]) -> Option<Value<'a>> {
    let attributes = names.iter().filter_map(|name| node.attribute(name));
    let attributes: Vec<_> = attributes.collect();
    let child = node.child_of(names).map(|child| {
        let value = child.text();
        child.finish();
        value
    });
    let mut written = attributes.into_iter().chain(child);
    let first = written.next()?;
    for other in written {
        other.warning(
            format!("{} says again what {} says", other.owner(), first.owner()),
            Some("only the first one is read; remove one of them".into()),
        );
    }
    if first.is_empty() {
        first.warning(
            format!("{} is empty", first.owner()),
            Some("it is not read; write a value, or remove it".into()),
        );
        return None;
    }
    Some(first)
}

/// A setting that must be there.
pub(super) fn required<'a>(node: &Node<'a>, name: &'static str) -> Option<Value<'a>> {
    let found = setting(node, name);
    if found.is_none() {
        let rule = quoted(node.name());
        node.error(
            format!("<{rule}> has no {name}"),
            Some(format!("write <{rule} {name}=\"…\">")),
        );
    }
    found
}

/// The text of a setting.
pub(super) fn text(node: &Node<'_>, name: &'static str) -> Option<String> {
    setting(node, name).map(|value| value.as_str().to_owned())
}

/// A time: a number of milliseconds, or a number with its unit.
pub(in crate::readers) fn duration(value: &Value<'_>) -> Option<Duration> {
    let text = value.as_str();
    let unit = UNITS.iter().find(|(unit, _)| text.ends_with(unit));
    let (number, seconds) = match unit {
        Some((unit, seconds)) => (text[..text.len() - unit.len()].trim_end(), *seconds),
        None => (text, MILLISECOND_S),
    };
    let number = number
        .parse::<f64>()
        .ok()
        .filter(|number| number.is_finite());
    let Some(number) = number else {
        report(value, "is no time", DURATION_HELP);
        return None;
    };
    let duration = Duration::try_from_secs_f64(number * seconds).ok();
    let duration = duration.filter(|duration| *duration <= MAX_DURATION);
    if duration.is_none() {
        report(value, "is no time from 0 to a week", DURATION_HELP);
    }
    duration
}

/// A time that is longer than nothing.
pub(in crate::readers) fn positive_duration(value: &Value<'_>) -> Option<Duration> {
    let duration = duration(value)?;
    if duration.is_zero() {
        report(value, "is no time at all", DURATION_HELP);
        return None;
    }
    Some(duration)
}

/// A number larger than 0.
pub(in crate::readers) fn positive(value: &Value<'_>) -> Option<f64> {
    let number: f64 = value.number()?;
    if number > 0.0 {
        return Some(number);
    }
    report(value, "is not larger than 0", "write a number such as 0.5");
    None
}

/// A whole number of at least `least`.
pub(in crate::readers) fn count(value: &Value<'_>, least: u32) -> Option<u32> {
    let number: u32 = value.number()?;
    if number >= least {
        return Some(number);
    }
    let help = format!("write {least} or more");
    report(value, "is too few", &help);
    None
}

fn report(value: &Value<'_>, what: &str, help: &str) {
    let message = format!("`{}` in {} {what}", quoted(value.as_str()), value.owner());
    value.error(message, Some(help.to_owned()));
}

/// A rule and the place of its element.
pub(super) fn located<T>(node: &Node<'_>, value: T) -> Located<T> {
    Located {
        value,
        place: node.place(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;

    fn read(text: &str) -> (Option<Duration>, usize) {
        let file = format!("<f d='{text}'/>");
        let document = Document::from_bytes("f.xml", file.as_bytes());
        let node = document.root(&["f"]).unwrap();
        let read = node.attribute("d").and_then(|value| duration(&value));
        (read, document.problems().len())
    }

    #[test]
    fn times_have_units() {
        for (text, nanoseconds) in [
            ("60", 60_000_000),
            ("0", 0),
            ("0.5", 500_000),
            ("50ns", 50),
            ("10us", 10_000),
            ("10 µs", 10_000),
            ("20ms", 20_000_000),
            ("10s", 10_000_000_000),
            ("2min", 120_000_000_000),
            ("1h", 3_600_000_000_000),
        ] {
            let expected = (Some(Duration::from_nanos(nanoseconds)), 0);
            assert_eq!(read(text), expected, "{text}");
        }
    }

    #[test]
    fn what_is_no_time_is_refused() {
        for text in [
            "-1", "-5ms", "NaN", "inf", "NaNs", "s", "10 weeks", "1e300", "200h", "1,5", "한",
        ] {
            assert_eq!(read(text), (None, 1), "{text}");
        }
    }
}
