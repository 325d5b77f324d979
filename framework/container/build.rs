//! Exports the functions that the guard interposes, so that component libraries bind to them.

fn main() {
    for symbol in [
        "abort",
        "exit",
        "quick_exit",
        "_exit",
        "sigaction",
        "signal",
        "sigprocmask",
        "pthread_sigmask",
        "malloc",
        "calloc",
        "realloc",
        "free",
        "posix_memalign",
        "aligned_alloc",
        "memalign",
    ] {
        println!("cargo::rustc-link-arg=-Wl,--export-dynamic-symbol={symbol}");
    }
    println!("cargo::rerun-if-changed=build.rs");
}
