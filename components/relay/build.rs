//! Leaves debug information out: it is ten times as large as the rest, and whoever loads a library
//! copies all of it for each instance.

fn main() {
    println!("cargo::rustc-cdylib-link-arg=-Wl,--strip-debug");
    println!("cargo::rerun-if-changed=build.rs");
}
