//! Where in a component a trap or a hang was: the call chain on its stack, by the unwind tables and
//! the debug information of the very copy that was loaded.
//!
//! Reads and parses whole files: for a thread that has time, never for the one that met the fault.

mod names;
mod unwind;

use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::guard::{LoadedObject, Registers};
use crate::library::whole;

use names::Names;
use unwind::call_chain;

/// So many lines are given. What matters is innermost; the rest of an endless recursion is the
/// same again.
const MOST_LINES: usize = 32;

/// The functions of `library` that were being called at `registers`, innermost first, each as
/// "function at file:line" as far as the library tells; at most 32. Functions of other libraries
/// are left out. Without addresses, so that the same fault gives the same text. `stack` reads the
/// word at an address of the component's stack, `None` where there is none.
///
/// Garbage in registers, stack or library gives fewer lines or wrong ones, nothing worse.
pub fn symbolise(
    library: &LoadedObject,
    registers: &Registers,
    stack: impl Fn(usize) -> Option<usize>,
) -> Vec<String> {
    // Two parsers are given what a fault left behind. They promise not to panic; a report that is
    // missing a backtrace is better than a container that trusted them.
    let lines = catch_unwind(AssertUnwindSafe(|| lines(library, registers, stack)));
    lines.unwrap_or_default()
}

fn lines(
    library: &LoadedObject,
    registers: &Registers,
    stack: impl Fn(usize) -> Option<usize>,
) -> Vec<String> {
    let mut chain = call_chain(library, registers, stack);
    chain.retain(|address| library.code.contains(*address));
    if chain.is_empty() {
        return Vec::new();
    }
    let Ok(content) = std::fs::read(whole(&library.file)) else {
        return Vec::new();
    };
    let names = Names::of(&content);
    let mut lines = Vec::new();
    for address in chain {
        lines.extend(names.at((address - library.base) as u64));
        if lines.len() >= MOST_LINES {
            break;
        }
    }
    lines.truncate(MOST_LINES);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// This very test program, which has tables and names as a component has.
    fn own_program() -> LoadedObject {
        let mut object =
            LoadedObject::around(empty_stack as *const () as usize).expect("the test is loaded");
        object.file = std::env::current_exe().expect("a running test knows its file");
        object
    }

    fn empty_stack(_address: usize) -> Option<usize> {
        None
    }

    fn at(instruction_pointer: usize, stack_pointer: usize) -> Registers {
        Registers {
            instruction_pointer,
            stack_pointer,
            frame_pointer: stack_pointer,
            link: 0,
        }
    }

    #[test]
    fn a_function_has_its_name_and_place() {
        let start = empty_stack as *const () as usize;
        let lines = symbolise(&own_program(), &at(start, 0), empty_stack);
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert!(
            lines[0].starts_with("container::backtrace::tests::empty_stack at "),
            "{lines:?}"
        );
        assert!(lines[0].contains("src/backtrace.rs:"), "{lines:?}");
    }

    #[test]
    fn what_is_no_library_has_no_names() {
        let mut object = own_program();
        let start = object.code.start;
        for file in ["/dev/null", "/", "/nowhere", "/proc/self/status"] {
            object.file = file.into();
            let lines = symbolise(&object, &at(start, 0), empty_stack);
            assert!(
                lines.iter().all(|line| line == "unknown function"),
                "{file}: {lines:?}"
            );
        }
    }

    proptest! {
        // Every case parses the program's debug information.
        #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

        /// Words of the stack are anything, often addresses of code and of the stack itself.
        #[test]
        fn garbage_does_no_harm(
            words in prop::collection::vec((0u8..4, any::<usize>()), 1..600),
            start in any::<usize>(),
        ) {
            let object = own_program();
            let size = object.code.end - object.code.start;
            let base = 0x7000_0000_0000_usize;
            let stack: Vec<usize> = words
                .iter()
                .map(|(kind, word)| match kind {
                    0 | 1 => object.code.start + word % size,
                    2 => base + word % (8 * words.len()),
                    _ => *word,
                })
                .collect();
            let read = |address: usize| {
                let offset = address.checked_sub(base)?;
                stack.get(offset / 8).copied()
            };
            let registers = at(object.code.start + start % size, base);
            let first = symbolise(&object, &registers, read);
            prop_assert!(first.len() <= MOST_LINES);
        }
    }
}
