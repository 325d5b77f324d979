//! Names of projects: good for a library, a crate, an XML file and a folder at once.

/// A longer one is no name that anybody would type.
const LENGTH_MAXIMUM: usize = 64;

/// Words that Rust or C keep for themselves, and names that would hide what a project uses.
const TAKEN: [&str; 76] = [
    "abstract",
    "as",
    "async",
    "auto",
    "await",
    "become",
    "bool",
    "box",
    "break",
    "case",
    "char",
    "component_abi",
    "component_sdk",
    "const",
    "continue",
    "core",
    "crate",
    "default",
    "do",
    "double",
    "dyn",
    "else",
    "enum",
    "extern",
    "fault_manager",
    "final",
    "float",
    "fn",
    "for",
    "gen",
    "goto",
    "if",
    "impl",
    "in",
    "inline",
    "int",
    "interface",
    "let",
    "long",
    "loop",
    "macro",
    "main",
    "match",
    "mod",
    "move",
    "mut",
    "override",
    "priv",
    "proc_macro",
    "pub",
    "ref",
    "register",
    "restrict",
    "return",
    "self",
    "short",
    "signed",
    "sizeof",
    "static",
    "std",
    "struct",
    "super",
    "switch",
    "target",
    "test",
    "trait",
    "try",
    "type",
    "typedef",
    "typeof",
    "union",
    "unsafe",
    "unsigned",
    "use",
    "virtual",
    "while",
];

/// What is wrong with a name, and which one to take instead.
pub(super) fn check(name: &str) -> Result<(), String> {
    let suggested = suggestion(name);
    if suggested == name {
        return Ok(());
    }
    let wrong = if TAKEN.contains(&name) {
        "is taken: by a language, or by what projects use"
    } else {
        "is no name of a project: write small letters, digits and `_`, a letter first"
    };
    let shown: String = name.chars().take(LENGTH_MAXIMUM).collect();
    let shown = shown.escape_debug();
    Err(format!(
        "`{shown}` {wrong}\n  help: how about `{suggested}`?"
    ))
}

/// The nearest name that can be used; the name itself if that can.
fn suggestion(name: &str) -> String {
    let mut words = String::new();
    let mut after_small = false;
    for letter in name.chars() {
        if letter.is_ascii_alphanumeric() {
            if letter.is_ascii_uppercase() && after_small {
                words.push('_');
            }
            words.push(letter.to_ascii_lowercase());
        } else {
            words.push('_');
        }
        after_small = letter.is_ascii_lowercase() || letter.is_ascii_digit();
    }
    let parts: Vec<&str> = words.split('_').filter(|part| !part.is_empty()).collect();
    let mut found = parts.join("_");
    found.truncate(LENGTH_MAXIMUM);
    if !found.starts_with(|first: char| first.is_ascii_lowercase()) {
        found = format!("my_{found}").trim_end_matches('_').to_owned();
        if found == "my" {
            found = "my_component".into();
        }
    }
    if TAKEN.contains(&found.as_str()) {
        found = format!("my_{found}");
    }
    found.truncate(LENGTH_MAXIMUM);
    found.trim_end_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn good_names_are_taken_as_they_are() {
        for name in ["thermometer", "low_pass", "sonar2", "a"] {
            assert_eq!(check(name), Ok(()), "{name}");
        }
    }

    #[test]
    fn bad_names_are_refused_with_a_good_one() {
        for (name, better) in [
            ("LowPass", "low_pass"),
            ("low-pass", "low_pass"),
            ("low pass", "low_pass"),
            ("../escape", "escape"),
            ("/etc", "etc"),
            ("2nd", "my_2nd"),
            ("", "my_component"),
            ("한글", "my_component"),
            ("__", "my_component"),
            ("a__b", "a_b"),
            ("_a", "a"),
            ("a_", "a"),
            ("type", "my_type"),
            ("Test", "my_test"),
            ("fault_manager", "my_fault_manager"),
            ("SONAR", "sonar"),
            ("sonar2D", "sonar2_d"),
        ] {
            let told = check(name).expect_err(name);
            assert!(told.ends_with(&format!("how about `{better}`?")), "{told}");
            assert_eq!(check(better), Ok(()), "{better}");
        }
        let long = "a".repeat(LENGTH_MAXIMUM + 1);
        assert!(check(&long).is_err());
        assert_eq!(check(&suggestion(&long)), Ok(()));
    }

    #[test]
    fn taken_names_are_sorted() {
        assert!(TAKEN.is_sorted());
    }
}
