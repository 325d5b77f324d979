//! Misbehaviour that is injected into a component without its knowledge: on its own stack, where
//! it would call its callback. The guard sees what it would see of the component itself.
//!
//! What traps are a few instructions in a section of ours; the handlers take them for the
//! component's own code. They are reached from nowhere else than here.

use std::ptr;
use std::time::{Duration, Instant};

use component_abi::{Status, Text};

use super::foreign::ForeignText;
use super::host::{HostSide, Request};
use super::interpose;

/// What a component does when its next callback is due: instead of the callback, or before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Misbehaviour {
    /// Answers as the SDK does for a panic, with the text "injected panic".
    Panic,
    /// Reads through a null pointer.
    Segfault,
    /// Reads a mapped page behind the end of its file.
    BusError,
    /// Divides by zero. (Where the processor does not trap, SIGFPE is raised.)
    DivideByZero,
    /// Executes an instruction that does not exist.
    IllegalInstruction,
    /// Calls `abort`.
    Abort,
    /// Uses up its stack.
    StackOverflow,
    /// Calls `exit(1)`.
    Exit,
    /// Never returns.
    Hang,
    /// Computes for so long, then runs the callback.
    Slow(Duration),
    /// Allocates so many bytes and forgets them, then runs the callback.
    Leak(usize),
    /// Returns this status.
    ErrorReturn(u32),
}

/// Misbehaves, on the component's stack; the status to return, or nothing if the callback is to be
/// run after all.
#[cold]
pub(super) fn misbehave(side: &HostSide, misbehaviour: Misbehaviour) -> Option<Status> {
    side.misbehaved.set(Some(Instant::now()));
    match misbehaviour {
        Misbehaviour::Panic => Some(fail(side, "injected panic", Status::PANICKED)),
        Misbehaviour::ErrorReturn(status) => {
            Some(fail(side, "injected error return", Status(status)))
        }
        Misbehaviour::Slow(time) => {
            let start = Instant::now();
            while start.elapsed() < time {
                // SAFETY: waits a moment.
                unsafe { steadfast_inject_wait() };
            }
            None
        }
        Misbehaviour::Leak(bytes) => {
            leak(bytes);
            None
        }
        Misbehaviour::Abort => interpose::abort(),
        Misbehaviour::Exit => interpose::exit(1),
        Misbehaviour::Segfault => trap_in(read_null),
        Misbehaviour::BusError => {
            let page = page_without_backing();
            side.misbehaved.set(Some(Instant::now()));
            trap_in(|| {
                // SAFETY: as above.
                unsafe { steadfast_inject_read(page) };
            })
        }
        Misbehaviour::DivideByZero => {
            let thread = rustix::thread::gettid().as_raw_nonzero().get();
            trap_in(|| {
                // SAFETY: as above.
                unsafe { steadfast_inject_divide(std::process::id(), thread) };
            })
        }
        Misbehaviour::IllegalInstruction => trap_in(|| {
            // SAFETY: as above.
            unsafe { steadfast_inject_illegal() };
        }),
        Misbehaviour::StackOverflow => trap_in(|| {
            // SAFETY: as above; the stack pointer goes down to the guard area of this stack.
            unsafe { steadfast_inject_overflow() };
        }),
        Misbehaviour::Hang => trap_in(|| {
            // SAFETY: spins until the watchdog takes the component off.
            unsafe { steadfast_inject_hang() };
        }),
    }
}

/// Runs into a null pointer.
pub(super) fn read_null() {
    // SAFETY: traps inside the section, which the handler takes for the component's code.
    unsafe { steadfast_inject_read(ptr::null()) };
}

/// Whether an instruction is one of the section's. Called inside handlers.
pub(super) fn contains(instruction_pointer: usize) -> bool {
    let begin = steadfast_inject_read as *const () as usize;
    let end = steadfast_inject_end as *const () as usize;
    (begin..end).contains(&instruction_pointer)
}

/// Does what traps. Should it ever come back, the injection has failed, which is an error too.
fn trap_in(instruction: impl FnOnce()) -> Option<Status> {
    instruction();
    Some(Status::INTERNAL_FAULT)
}

/// Explains a failure as the SDK does, and returns it.
fn fail(side: &HostSide, message: &str, status: Status) -> Status {
    let text = |text: &str| {
        ForeignText::new(Text {
            data: text.as_ptr(),
            length: text.len(),
        })
    };
    side.ask(Request::Failed(text(message), text(""), 0, 0));
    status
}

/// Memory that is written to is memory that is used. If there is none, nothing is leaked.
fn leak(bytes: usize) {
    /// Not zero, so that no page stays a promise.
    const CONTENT: u8 = 0xa5;
    let mut memory = Vec::new();
    if memory.try_reserve_exact(bytes).is_ok() {
        memory.resize(bytes, CONTENT);
        std::mem::forget(memory);
    }
}

/// A page of an empty file; null, which traps as well, if there is no such page to be had.
fn page_without_backing() -> *const u8 {
    const LENGTH: usize = 4096;
    let Ok(file) = rustix::fs::memfd_create(c"empty", rustix::fs::MemfdFlags::CLOEXEC) else {
        return ptr::null();
    };
    let (protection, flags) = (rustix::mm::ProtFlags::READ, rustix::mm::MapFlags::SHARED);
    // SAFETY: a new mapping at an address that the kernel chooses; it keeps the file.
    let page = unsafe { rustix::mm::mmap(ptr::null_mut(), LENGTH, protection, flags, &file, 0) };
    page.map_or(ptr::null(), |page| page.cast_const().cast())
}

unsafe extern "C" {
    fn steadfast_inject_read(address: *const u8);
    fn steadfast_inject_divide(process: u32, thread: i32);
    fn steadfast_inject_illegal();
    fn steadfast_inject_overflow();
    fn steadfast_inject_hang();
    fn steadfast_inject_wait();
    fn steadfast_inject_end();
}

#[cfg(target_arch = "x86_64")]
std::arch::global_asm!(
    ".text",
    ".globl steadfast_inject_read",
    ".globl steadfast_inject_divide",
    ".globl steadfast_inject_illegal",
    ".globl steadfast_inject_overflow",
    ".globl steadfast_inject_hang",
    ".globl steadfast_inject_wait",
    ".globl steadfast_inject_end",
    ".p2align 4",
    "steadfast_inject_read:",
    "mov al, [rdi]",
    "ret",
    "steadfast_inject_divide:",
    "mov eax, 1",
    "xor edx, edx",
    "xor ecx, ecx",
    "div ecx",
    "ret",
    "steadfast_inject_illegal:",
    "ud2",
    "steadfast_inject_overflow:",
    "sub rsp, 4096",
    "mov byte ptr [rsp], 0",
    "jmp steadfast_inject_overflow",
    "steadfast_inject_hang:",
    "pause",
    "jmp steadfast_inject_hang",
    "steadfast_inject_wait:",
    "mov ecx, 100",
    "2:",
    "pause",
    "dec ecx",
    "jnz 2b",
    "ret",
    "steadfast_inject_end:",
    "ud2",
);

// An integer division by zero gives zero here: SIGFPE (8) is raised by tgkill (system call 131).
#[cfg(target_arch = "aarch64")]
std::arch::global_asm!(
    ".text",
    ".globl steadfast_inject_read",
    ".globl steadfast_inject_divide",
    ".globl steadfast_inject_illegal",
    ".globl steadfast_inject_overflow",
    ".globl steadfast_inject_hang",
    ".globl steadfast_inject_wait",
    ".globl steadfast_inject_end",
    ".p2align 4",
    "steadfast_inject_read:",
    "ldrb w0, [x0]",
    "ret",
    "steadfast_inject_divide:",
    "mov x2, #8",
    "mov x8, #131",
    "svc #0",
    "ret",
    "steadfast_inject_illegal:",
    "udf #0",
    "steadfast_inject_overflow:",
    "sub sp, sp, #4096",
    "str xzr, [sp]",
    "b steadfast_inject_overflow",
    "steadfast_inject_hang:",
    "yield",
    "b steadfast_inject_hang",
    "steadfast_inject_wait:",
    "mov w1, #100",
    "2:",
    "yield",
    "subs w1, w1, #1",
    "b.ne 2b",
    "ret",
    "steadfast_inject_end:",
    "udf #0",
);

#[cfg(test)]
mod tests;
