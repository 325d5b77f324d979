//! Exit codes: each number means one thing, whichever command ends with it.

/// What was asked for is done.
pub const DONE: u8 = 0;
/// Refused: problems in a file, or somebody who can do it says no.
pub const REFUSED: u8 = 1;
/// A file cannot be read or written, or no application answers.
pub const FILE: u8 = 2;
/// A library cannot be used.
pub const LIBRARY: u8 = 3;
/// Ports or connections do not fit the libraries.
pub const CONNECTION: u8 = 4;
/// A component does not start.
pub const COMPONENT: u8 = 5;
/// The operating system refuses.
pub const SYSTEM: u8 = 6;
/// An order to a running application was tried and failed.
pub const FAILED: u8 = 8;
/// An order to a running application was not over in time.
pub const NOT_OVER: u8 = 9;
/// The command line is not understood; the number is that of `sysexits.h`.
pub const USAGE: u8 = 64;

/// All of them, in the words of the README.
#[cfg(test)]
pub const TABLE: [(u8, &str); 12] = [
    (DONE, "what was asked for is done"),
    (
        REFUSED,
        "refused: a file has problems, a running application says no, a task cannot be done, or a name or folder cannot be used",
    ),
    (
        FILE,
        "a file cannot be read or written, there is no terminal, or no running application answers",
    ),
    (
        LIBRARY,
        "a library is missing, no component, or for another container",
    ),
    (CONNECTION, "ports or connections do not fit the libraries"),
    (COMPONENT, "a component refused to start, or hung in it"),
    (
        SYSTEM,
        "the system refused threads, memory or an address to listen at",
    ),
    (
        container::outer_supervision::GIVEN_UP,
        "the container failed more often than `--restarts` allows",
    ),
    (
        FAILED,
        "an order to a running application was tried and failed",
    ),
    (
        NOT_OVER,
        "an order to a running application was not over in time",
    ),
    (USAGE, "the command line is not understood"),
    (130, "a second Ctrl-C ended the run at once"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_readme_has_the_table() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../README.md");
        let readme = std::fs::read_to_string(path).expect("the README");
        for (code, meaning) in TABLE {
            let row = format!("| {code} | {meaning} |");
            assert!(readme.contains(&row), "the README has no row {row}");
        }
    }
}
