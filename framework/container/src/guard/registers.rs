//! The interrupted registers of a signal context, by architecture.

use corosensei::trap::TrapHandlerRegs;

use super::copy::guarded_copy;

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
compile_error!("the guard knows the signal contexts of x86-64 and ARM64 only");

/// Where a thread was interrupted: what it takes to follow its calls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Registers {
    /// Instruction pointer.
    pub instruction_pointer: usize,
    /// Stack pointer.
    pub stack_pointer: usize,
    /// Frame pointer (`rbp`, `x29`).
    pub frame_pointer: usize,
    /// Link register (`x30`); 0 where there is none.
    pub link: usize,
}

/// The registers at the interruption.
#[cfg(target_arch = "x86_64")]
pub(super) fn interrupted(context: &libc::ucontext_t) -> Registers {
    let registers = &context.uc_mcontext.gregs;
    Registers {
        instruction_pointer: registers[libc::REG_RIP as usize] as usize,
        stack_pointer: registers[libc::REG_RSP as usize] as usize,
        frame_pointer: registers[libc::REG_RBP as usize] as usize,
        link: 0,
    }
}

/// Whether a thread that was interrupted at `instruction_pointer` was in a system call: behind the
/// instruction that makes one, or before it if the call is to be made again.
pub(super) fn is_in_system_call(instruction_pointer: usize) -> bool {
    /// `syscall`.
    #[cfg(target_arch = "x86_64")]
    const INSTRUCTION: [u8; 2] = [0x0f, 0x05];
    /// `svc #0`.
    #[cfg(target_arch = "aarch64")]
    const INSTRUCTION: [u8; 4] = [0x01, 0x00, 0x00, 0xd4];
    let behind = instruction_pointer.wrapping_sub(INSTRUCTION.len());
    [behind, instruction_pointer].into_iter().any(|address| {
        let mut found = [0u8; INSTRUCTION.len()];
        let from = address as *const u8;
        // SAFETY: `found` is ours; code that is not there or not readable gives a 'no'.
        let is_readable = unsafe { guarded_copy(found.as_mut_ptr(), from, found.len()) };
        is_readable && found == INSTRUCTION
    })
}

/// Continues at `instruction_pointer` with all else unchanged.
#[cfg(target_arch = "x86_64")]
pub(super) fn jump(context: &mut libc::ucontext_t, instruction_pointer: usize) {
    context.uc_mcontext.gregs[libc::REG_RIP as usize] = instruction_pointer as i64;
}

/// Continues in the trap function that `registers` names, with flags and floating-point control
/// as the ABI promises them: the component may have left them in any state.
#[cfg(target_arch = "x86_64")]
pub(super) fn redirect(context: &mut libc::ucontext_t, registers: &TrapHandlerRegs) {
    /// Direction, trap and alignment-check flags must be clear at a function's start.
    const CLEARED_FLAGS: i64 = 0x400 | 0x100 | 0x4_0000;
    /// All exceptions masked, round to nearest: the initial values of the ABI.
    const CONTROL_SSE: u32 = 0x1f80;
    const CONTROL_X87: u16 = 0x037f;
    let general = &mut context.uc_mcontext.gregs;
    general[libc::REG_RIP as usize] = registers.rip as i64;
    general[libc::REG_RSP as usize] = registers.rsp as i64;
    general[libc::REG_RBP as usize] = registers.rbp as i64;
    general[libc::REG_RDI as usize] = registers.rdi as i64;
    general[libc::REG_RSI as usize] = registers.rsi as i64;
    general[libc::REG_EFL as usize] &= !CLEARED_FLAGS;
    // SAFETY: the kernel points it into the signal frame, or leaves it null.
    if let Some(floating_point) = unsafe { context.uc_mcontext.fpregs.as_mut() } {
        floating_point.mxcsr = CONTROL_SSE;
        floating_point.cwd = CONTROL_X87;
    }
}

/// The registers at the interruption.
#[cfg(target_arch = "aarch64")]
pub(super) fn interrupted(context: &libc::ucontext_t) -> Registers {
    let registers = &context.uc_mcontext;
    Registers {
        instruction_pointer: registers.pc as usize,
        stack_pointer: registers.sp as usize,
        frame_pointer: registers.regs[29] as usize,
        link: registers.regs[30] as usize,
    }
}

/// Continues at `instruction_pointer` with all else unchanged.
#[cfg(target_arch = "aarch64")]
pub(super) fn jump(context: &mut libc::ucontext_t, instruction_pointer: usize) {
    context.uc_mcontext.pc = instruction_pointer as u64;
}

/// Continues in the trap function that `registers` names.
#[cfg(target_arch = "aarch64")]
pub(super) fn redirect(context: &mut libc::ucontext_t, registers: &TrapHandlerRegs) {
    context.uc_mcontext.pc = registers.pc;
    context.uc_mcontext.sp = registers.sp;
    context.uc_mcontext.regs[0] = registers.x0;
    context.uc_mcontext.regs[1] = registers.x1;
    context.uc_mcontext.regs[29] = registers.x29;
    context.uc_mcontext.regs[30] = registers.lr;
}
