//! What is charged to a component, and what is not.

use std::cell::Cell;
use std::hint::black_box;
use std::ptr;
use std::time::Duration;

use component_abi::{Callbacks, HostContext, HostTable, Instance, Status};
use libc::c_void;

use crate::guard::loss::Loss;
use crate::guard::{
    CallLimit, Callback, CodeRange, Ending, Guarded, HostServices, Misbehaviour, Request,
};

const KIB: usize = 1024;

/// What the allocator may set aside beyond what was asked for: its head of each piece, and a page
/// where a piece is mapped by itself.
const ROOM: u64 = 8 * 1024;

/// The next callback does this, with what it has kept.
type Step = fn(*mut c_void) -> *mut c_void;

thread_local! {
    static STEP: Cell<Step> = const { Cell::new(|kept| kept) };
    static KEPT: Cell<*mut c_void> = const { Cell::new(ptr::null_mut()) };
    static HOST: Cell<(*const HostTable, *mut HostContext)> =
        const { Cell::new((ptr::null(), ptr::null_mut())) };
}

const CALLBACKS: Callbacks = Callbacks {
    create: Some(create),
    on_execute: Some(on_execute),
    ..Callbacks::NONE
};

unsafe extern "C" fn create(table: *const HostTable, context: *mut HostContext) -> *mut Instance {
    HOST.set((table, context));
    ptr::dangling_mut()
}

unsafe extern "C" fn on_execute(_: *mut Instance) -> Status {
    let step = STEP.get();
    KEPT.set(black_box(step(KEPT.get())));
    Status::SUCCESS
}

/// Allocates whatever it is asked, on whichever stack, and forgets it.
struct Forgetful;

impl HostServices for Forgetful {
    fn answer(&mut self, _request: &Request) -> u64 {
        std::mem::forget(black_box(vec![1_u8; 64 * KIB]));
        0
    }
}

fn execute(guarded: &mut Guarded, step: Step) -> u64 {
    STEP.set(step);
    let limit = CallLimit::from(Duration::from_secs(1));
    let ending = guarded.call(Callback::Execute, limit, &Loss::default(), &mut Forgetful);
    assert_eq!(ending, Ending::Returned(Status::SUCCESS));
    guarded.allocated_bytes()
}

fn component() -> Guarded {
    Guarded::prepare_thread().expect("a stack for the handler");
    let code = CodeRange { start: 0, end: 0 };
    let mut guarded = Guarded::new(CALLBACKS, code, 0).expect("a stack");
    let limit = CallLimit::from(Duration::from_secs(1));
    guarded.call(Callback::Create, limit, &Loss::default(), &mut Forgetful);
    KEPT.set(ptr::null_mut());
    guarded
}

fn free(kept: *mut c_void) -> *mut c_void {
    // SAFETY: kept by an earlier step, or null.
    unsafe { super::free(kept) };
    ptr::null_mut()
}

fn align(_: *mut c_void) -> *mut c_void {
    let mut place = ptr::null_mut();
    // SAFETY: the place is ours.
    let result = unsafe { super::posix_memalign(&raw mut place, 256, 100 * KIB) };
    assert_eq!((result, place.addr() % 256), (0, 0));
    place
}

fn grow(kept: *mut c_void) -> *mut c_void {
    // SAFETY: kept by an earlier step, or null.
    unsafe { super::realloc(kept, 300 * KIB) }
}

fn shrink_to_nothing(kept: *mut c_void) -> *mut c_void {
    // SAFETY: kept by an earlier step.
    unsafe { super::realloc(kept, 0) }
}

#[test]
fn what_is_allocated_counts_until_it_is_freed() {
    let steps: [(&str, Step, usize); 12] = [
        ("malloc", |_| super::malloc(100 * KIB), 100),
        ("realloc", grow, 300),
        ("free", free, 0),
        ("calloc", |_| super::calloc(50, 2 * KIB), 100),
        ("realloc to nothing", shrink_to_nothing, 0),
        ("realloc of nothing", grow, 300),
        ("free", free, 0),
        ("posix_memalign", align, 100),
        ("free", free, 0),
        (
            "aligned_alloc",
            |_| super::aligned_alloc(64, 100 * KIB),
            100,
        ),
        (
            "a Rust allocator, forgotten",
            |kept| {
                std::mem::forget(black_box(vec![1_u8; 200 * KIB]));
                kept
            },
            300,
        ),
        (
            "free null",
            |kept| {
                free(ptr::null_mut());
                kept
            },
            300,
        ),
    ];
    let mut guarded = component();
    guarded.count_allocations();
    for (what, step, expected) in steps {
        let bytes = execute(&mut guarded, step);
        let expected = (expected * KIB) as u64;
        assert!(
            (expected..=expected + ROOM).contains(&bytes),
            "{what}: {bytes}"
        );
    }
    guarded.forget_allocations();
    assert_eq!(guarded.allocated_bytes(), 0);
    assert_eq!(
        execute(&mut guarded, free),
        0,
        "freed more than was allocated"
    );
}

#[test]
fn an_injected_leak_counts() {
    let mut guarded = component();
    guarded.count_allocations();
    guarded.inject(Some(Misbehaviour::Leak(1 << 20)));
    let bytes = execute(&mut guarded, |kept| kept);
    assert!((1 << 20..=(1 << 20) + ROOM).contains(&bytes), "{bytes}");
}

/// The container's own allocations on behalf of a component are not its, and what one allocates
/// outside callbacks is nobody's.
#[test]
fn only_the_component_is_charged() {
    let ask: Step = |kept| {
        let (table, context) = HOST.get();
        // SAFETY: the table that `create` was given is static.
        let table = unsafe { &*table };
        // SAFETY: the context of this component, on its stack: answered here.
        unsafe { (table.now_ns)(context) };
        // SAFETY: as above, withdrawing what was never registered: answered by the container.
        unsafe { (table.critical)(context, ptr::null_mut(), 0) };
        kept
    };
    let mut guarded = component();
    guarded.count_allocations();
    assert_eq!(execute(&mut guarded, ask), 0);
    free(super::malloc(100 * KIB));
    assert_eq!(guarded.allocated_bytes(), 0);
    let mut uncounted = component();
    assert_eq!(execute(&mut uncounted, |_| super::malloc(100 * KIB)), 0);
    assert_eq!(execute(&mut uncounted, free), 0);
}
