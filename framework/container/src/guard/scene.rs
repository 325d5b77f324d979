//! What a fault left behind in an instance that is never called again.

use super::Trap;
use super::code::{CodeRange, LoadedObject};
use super::registers::Registers;
use super::stack::StackMemory;
use crate::backtrace::symbolise;

/// Where a component was when it was taken off. Its stack stays as it was then.
#[derive(Debug, Clone, Copy)]
pub struct Scene {
    pub(super) code: CodeRange,
    pub(super) stack: StackMemory,
    pub(super) registers: Registers,
}

impl Scene {
    pub(super) fn new(code: CodeRange, stack: StackMemory, trap: &Trap) -> Self {
        Self {
            code,
            stack,
            registers: trap.registers,
        }
    }

    /// The functions of the component that were being called, innermost first: see
    /// [`symbolise`]. For a thread that has time: it reads and parses the library's file.
    pub fn backtrace(&self) -> Vec<String> {
        let Some(library) = LoadedObject::around(self.code.start) else {
            return Vec::new();
        };
        symbolise(&library, &self.registers, |address| {
            self.stack.read(address)
        })
    }
}
