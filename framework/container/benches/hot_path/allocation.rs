//! A small piece of memory, got and given back: from the C library itself, through the functions that
//! stand before it, and in a callback of a component, not counted and counted.

use std::cell::Cell;
use std::hint::black_box;
use std::time::{Duration, Instant};

use component_abi::{Callbacks, HostContext, HostTable, Instance, Status};
use container::guard::loss::Loss;
use container::guard::{CallLimit, Callback, CodeRange, Guarded, HostServices, Request};
use criterion::Criterion;
use libc::{c_void, size_t};

/// A small datum: what the allocator hands out from its thread's own store, its fastest way.
const BYTES: size_t = 64;

unsafe extern "C" {
    fn __libc_malloc(size: size_t) -> *mut c_void;
    fn __libc_free(memory: *mut c_void);
}

thread_local! {
    /// How often the next callback allocates.
    static TIMES: Cell<u64> = const { Cell::new(0) };
}

const ALLOCATING: Callbacks = Callbacks {
    create: Some(create),
    on_execute: Some(on_execute),
    ..Callbacks::NONE
};

unsafe extern "C" fn create(_: *const HostTable, _: *mut HostContext) -> *mut Instance {
    std::ptr::dangling_mut()
}

unsafe extern "C" fn on_execute(_: *mut Instance) -> Status {
    for _ in 0..TIMES.get() {
        through_interposed();
    }
    Status::SUCCESS
}

fn through_interposed() {
    // SAFETY: any size may be asked for.
    let memory = black_box(unsafe { libc::malloc(black_box(BYTES)) });
    // SAFETY: got above.
    unsafe { libc::free(memory) };
}

fn directly() {
    // SAFETY: any size may be asked for.
    let memory = black_box(unsafe { __libc_malloc(black_box(BYTES)) });
    // SAFETY: got above.
    unsafe { __libc_free(memory) };
}

struct NoServices;

impl HostServices for NoServices {
    fn answer(&mut self, _request: &Request) -> u64 {
        0
    }
}

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("allocation");
    group.bench_function("library", |bencher| bencher.iter(directly));
    group.bench_function("interposed", |bencher| bencher.iter(through_interposed));
    group.bench_function("in_component", |bencher| {
        bencher.iter_custom(|count| in_component(count, false));
    });
    group.bench_function("in_component_counted", |bencher| {
        bencher.iter_custom(|count| in_component(count, true));
    });
    group.finish();
}

/// All of them in one callback, so that the call itself does not count.
fn in_component(count: u64, counted: bool) -> Duration {
    let code = CodeRange { start: 0, end: 0 };
    let mut guarded = Guarded::new(ALLOCATING, code, 0).expect("a stack");
    if counted {
        guarded.count_allocations();
    }
    let loss = Loss::default();
    guarded.call(Callback::Create, CallLimit::NONE, &loss, &mut NoServices);
    TIMES.set(count);
    let start = Instant::now();
    guarded.call(Callback::Execute, CallLimit::NONE, &loss, &mut NoServices);
    let time = start.elapsed();
    assert_eq!(guarded.allocated_bytes(), 0, "all was given back");
    time
}
