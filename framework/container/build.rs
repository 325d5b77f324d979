//! Exports the functions that the guard interposes, so that component libraries bind to them.

include!("exported_symbols.rs");

fn main() {
    for symbol in EXPORTED_SYMBOLS {
        println!("cargo::rustc-link-arg=-Wl,--export-dynamic-symbol={symbol}");
    }
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=exported_symbols.rs");
}
