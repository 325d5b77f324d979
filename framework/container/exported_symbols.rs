/// The functions that the guard interposes. Every executable that loads components exports them, so
/// that component libraries bind to them; its build script includes this file.
const EXPORTED_SYMBOLS: [&str; 15] = [
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
];
