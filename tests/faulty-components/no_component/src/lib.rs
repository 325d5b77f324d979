//! A library that exports no component.
#![allow(unsafe_code)] // exporting a symbol

/// Some function that a library may have.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> i32 {
    42
}
