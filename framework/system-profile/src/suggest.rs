//! 'Did you mean': the nearest of the names that may stand in a place.

/// Longer words are no misspellings of ours, and comparing them is not free.
const MAX_WORD_LENGTH: usize = 64;

/// A text in a message is cut after so many characters.
const MAX_QUOTED_LENGTH: usize = 60;

/// The candidate nearest to `word`, if one is near enough to be a slip of the pen.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = word.chars().count();
    if length > MAX_WORD_LENGTH {
        return None;
    }
    let tolerated = (length / 3).clamp(1, 3);
    let folded = word.to_lowercase();
    candidates
        .into_iter()
        .filter(|candidate| !candidate.is_empty() && candidate.len() <= MAX_WORD_LENGTH)
        .map(|candidate| {
            let distance = strsim::damerau_levenshtein(&folded, &candidate.to_lowercase());
            (distance, candidate)
        })
        .filter(|(distance, _)| *distance <= tolerated)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// The help line for a wrong word: the nearest candidate, then all of them, introduced by `intro`.
pub fn help<'a>(
    word: &str,
    intro: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<String> {
    let candidates: Vec<&str> = candidates.into_iter().collect();
    if candidates.is_empty() {
        return None;
    }
    let all = shorten(&candidates.join(", "), 300);
    Some(match nearest(word, candidates.iter().copied()) {
        Some(near) => format!("did you mean `{near}`? {intro}: {all}"),
        None => format!("{intro}: {all}"),
    })
}

/// A text as it is quoted in a message: one line, not too long, nothing that a terminal obeys.
pub fn quoted(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let line = line.replace(char::is_control, "\u{FFFD}");
    shorten(&line, MAX_QUOTED_LENGTH)
}

fn shorten(text: &str, length: usize) -> String {
    match text.char_indices().nth(length) {
        Some((cut, _)) => format!("{}…", &text[..cut]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_wins() {
        let names = ["range_min", "range_max", "name"];
        assert_eq!(nearest("rang_min", names), Some("range_min"));
        assert_eq!(nearest("nmae", names), Some("name"));
        assert_eq!(nearest("Name", names), Some("name"));
        assert_eq!(nearest("colour", names), None);
        assert_eq!(nearest(&"n".repeat(1000), names), None);
    }

    #[test]
    fn help_lists_what_may_stand_there() {
        assert_eq!(
            help("inputt", "it may be", ["input", "output"]).unwrap(),
            "did you mean `input`? it may be: input, output"
        );
        assert_eq!(help("x", "it may be", []), None);
    }

    #[test]
    fn quotes_are_short_and_of_one_line() {
        assert_eq!(quoted("a\n  b"), "a b");
        assert_eq!(quoted("a\u{1b}[2J"), "a\u{FFFD}[2J");
        assert_eq!(quoted(&"글".repeat(100)).chars().count(), 61);
    }
}
