//! Times and numbers as a person reads them.

use serde_json::Value;

/// Nanoseconds of the run's clock, in seconds.
pub(super) fn seconds(t_ns: u64) -> f64 {
    // 2^53 ns are 104 days.
    t_ns as f64 / 1e9
}

/// Such a time in words: `3.120 s`.
pub(super) fn at(t_ns: u64) -> String {
    format!("{:.3} s", seconds(t_ns))
}

/// How long something took, with three digits at most: `12 µs`, `1.5 ms`, `20 ms`, `3.1 s`.
pub(super) fn took(us: u64) -> String {
    let value = us as f64;
    match us {
        0..1_000 => format!("{us} µs"),
        1_000..10_000 => format!("{:.1} ms", value / 1e3),
        10_000..1_000_000 => format!("{:.0} ms", value / 1e3),
        1_000_000..10_000_000 => format!("{:.2} s", value / 1e6),
        _ => format!("{:.1} s", value / 1e6),
    }
}

/// A number with four digits that count, without zeros behind them.
pub(super) fn number(value: f64) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if !(-5.0..7.0).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    // Between -2 and 9 by the line above.
    let decimals = (3.0 - magnitude).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A number of a file, which may be written as text where JSON has none.
pub(super) fn read(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => number.as_f64(),
        Value::String(text) => text.parse().ok(),
        _ => None,
    }
}

/// `1 fault`, `2 faults`.
pub(super) fn count(number: usize, what: &str) -> String {
    match number {
        1 => format!("1 {what}"),
        _ => format!("{number} {what}s"),
    }
}

/// `a`, `a and b`, `a, b and c`.
pub(super) fn list(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [one] => one.clone(),
        [before @ .., last] => format!("{} and {last}", before.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn times_have_three_digits() {
        for (us, expected) in [
            (0, "0 µs"),
            (999, "999 µs"),
            (1_500, "1.5 ms"),
            (20_000, "20 ms"),
            (3_120_000, "3.12 s"),
            (61_000_000, "61.0 s"),
        ] {
            assert_eq!(took(us), expected);
        }
        assert_eq!(at(3_120_000_000), "3.120 s");
    }

    #[test]
    fn numbers_have_four_digits() {
        for (value, expected) in [
            (0.0, "0"),
            (0.03, "0.03"),
            (-0.083_718_619, "-0.08372"),
            (2.227_999_999_999, "2.228"),
            (100.0, "100"),
            (123_456.7, "123457"),
            (1e9, "1.000e9"),
            (1e-7, "1.000e-7"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(number(value), expected);
        }
    }

    #[test]
    fn a_number_may_be_written_as_text() {
        assert_eq!(read(&json!(2.5)), Some(2.5));
        assert!(read(&json!("NaN")).is_some_and(f64::is_nan));
        assert_eq!(read(&json!("inf")), Some(f64::INFINITY));
        assert_eq!(read(&json!("far")), None);
        assert_eq!(read(&json!(null)), None);
    }

    #[test]
    fn parts_of_a_sentence() {
        let parts = ["a", "b", "c"].map(str::to_owned);
        assert_eq!(list(&parts), "a, b and c");
        assert_eq!(list(&parts[..2]), "a and b");
        assert_eq!(list(&parts[..1]), "a");
        assert_eq!(
            (count(1, "fault"), count(2, "fault")),
            ("1 fault".into(), "2 faults".into())
        );
    }
}
