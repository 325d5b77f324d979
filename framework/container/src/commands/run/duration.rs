//! Durations as people write them: `500ms`, `30s`, `2min`, `1h`.

use std::time::Duration;

/// Units, with their length in seconds.
const UNITS: [(&str, f64); 7] = [
    ("ns", 1e-9),
    ("us", 1e-6),
    ("ms", 1e-3),
    ("s", 1.0),
    ("min", 60.0),
    ("m", 60.0),
    ("h", 3600.0),
];

/// Reads a duration; what is wrong is said in words.
pub(in crate::commands) fn parse(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    let split = text
        .find(|letter: char| letter.is_ascii_alphabetic())
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let help = "write a number and a unit: 500ms, 30s, 2min, 1h";
    let number: f64 = number
        .trim()
        .parse()
        .map_err(|_error| format!("'{text}' is no duration; {help}"))?;
    let (_, seconds) = UNITS
        .iter()
        .find(|(name, _)| *name == unit)
        .ok_or_else(|| format!("'{unit}' is no unit of time; {help}"))?;
    Duration::try_from_secs_f64(number * seconds)
        .map_err(|error| format!("'{text}' is no duration: {error}; {help}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_of_people() {
        let cases = [
            ("500ms", Some(500)),
            ("30s", Some(30_000)),
            ("1.5s", Some(1_500)),
            (" 2min", Some(120_000)),
            ("1h", Some(3_600_000)),
            ("30", None),
            ("s", None),
            ("-1s", None),
            ("5 parsecs", None),
            ("1e300h", None),
        ];
        for (text, expected) in cases {
            let expected = expected.map(Duration::from_millis);
            assert_eq!(parse(text).ok(), expected, "{text}");
        }
    }
}
