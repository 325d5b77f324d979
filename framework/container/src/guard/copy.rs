//! Copying to and from memory that a component names: a bad pointer is the component's fault and
//! must not be ours. The copy routine has a known address range; the trap handler sends a fault
//! inside it to an exit that answers 'no' (as a kernel copies from user space).

unsafe extern "C" {
    fn steadfast_guarded_copy(to: *mut u8, from: *const u8, length: usize) -> u32;
    fn steadfast_guarded_copy_fault();
}

/// Copies `length` bytes; false if either side is not accessible. Bytes before the bad address may
/// have been copied.
///
/// # Safety
/// The side that is ours must be valid for `length` bytes and not borrowed elsewhere; the other
/// side may be anything.
pub(super) unsafe fn guarded_copy(to: *mut u8, from: *const u8, length: usize) -> bool {
    // SAFETY: by this function's contract; faults on the foreign side come back as 0.
    unsafe { steadfast_guarded_copy(to, from, length) != 0 }
}

/// Where to continue if `instruction_pointer` is inside the copy routine.
pub(super) fn fault_exit(instruction_pointer: usize) -> Option<usize> {
    let begin = steadfast_guarded_copy as *const () as usize;
    let exit = steadfast_guarded_copy_fault as *const () as usize;
    (begin..exit).contains(&instruction_pointer).then_some(exit)
}

// A leaf without a frame, so that its exit can return from anywhere in it. 64 bytes a round: a
// string instruction has a start-up cost that small data would pay each time, and trusts the
// direction flag.
#[cfg(target_arch = "x86_64")]
std::arch::global_asm!(
    ".text",
    ".globl steadfast_guarded_copy",
    ".globl steadfast_guarded_copy_fault",
    ".p2align 5",
    "steadfast_guarded_copy:",
    "cmp rdx, 64",
    "jb 3f",
    "2:",
    "movups xmm0, [rsi]",
    "movups xmm1, [rsi + 16]",
    "movups xmm2, [rsi + 32]",
    "movups xmm3, [rsi + 48]",
    "movups [rdi], xmm0",
    "movups [rdi + 16], xmm1",
    "movups [rdi + 32], xmm2",
    "movups [rdi + 48], xmm3",
    "add rsi, 64",
    "add rdi, 64",
    "sub rdx, 64",
    "cmp rdx, 64",
    "jae 2b",
    "3:",
    "cmp rdx, 8",
    "jb 5f",
    "4:",
    "mov rax, [rsi]",
    "mov [rdi], rax",
    "add rsi, 8",
    "add rdi, 8",
    "sub rdx, 8",
    "cmp rdx, 8",
    "jae 4b",
    "5:",
    "test rdx, rdx",
    "jz 7f",
    "6:",
    "mov al, [rsi]",
    "mov [rdi], al",
    "inc rsi",
    "inc rdi",
    "dec rdx",
    "jnz 6b",
    "7:",
    "mov eax, 1",
    "ret",
    "steadfast_guarded_copy_fault:",
    "xor eax, eax",
    "ret",
);

#[cfg(target_arch = "aarch64")]
std::arch::global_asm!(
    ".text",
    ".globl steadfast_guarded_copy",
    ".globl steadfast_guarded_copy_fault",
    ".p2align 5",
    "steadfast_guarded_copy:",
    "cmp x2, #16",
    "b.lo 3f",
    "2:",
    "ldp x3, x4, [x1], #16",
    "stp x3, x4, [x0], #16",
    "sub x2, x2, #16",
    "cmp x2, #16",
    "b.hs 2b",
    "3:",
    "cbz x2, 5f",
    "4:",
    "ldrb w3, [x1], #1",
    "strb w3, [x0], #1",
    "subs x2, x2, #1",
    "b.ne 4b",
    "5:",
    "mov w0, #1",
    "ret",
    "steadfast_guarded_copy_fault:",
    "mov w0, #0",
    "ret",
);
