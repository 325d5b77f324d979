//! System calls that reach beyond the process: refused to components in a host, because a component
//! that has lost its mind must not harm others by them. They fail with `EPERM`.
//!
//! A list of what is refused, not of what is allowed: a driver may need anything to talk to its
//! device.

use std::collections::BTreeMap;
use std::io;

use seccompiler::{
    BpfProgram, SeccompAction, SeccompCmpArgLen, SeccompCmpOp, SeccompCondition, SeccompFilter,
    SeccompRule, apply_filter_all_threads,
};

/// Refused whatever the arguments are.
const REFUSED: [libc::c_long; 27] = [
    // Other processes' memory, files and execution.
    libc::SYS_ptrace,
    libc::SYS_process_vm_readv,
    libc::SYS_process_vm_writev,
    libc::SYS_pidfd_getfd,
    libc::SYS_pidfd_send_signal,
    libc::SYS_process_madvise,
    libc::SYS_kcmp,
    // The machine.
    libc::SYS_reboot,
    libc::SYS_kexec_load,
    libc::SYS_init_module,
    libc::SYS_finit_module,
    libc::SYS_delete_module,
    libc::SYS_swapon,
    libc::SYS_swapoff,
    libc::SYS_sethostname,
    libc::SYS_settimeofday,
    libc::SYS_clock_settime,
    libc::SYS_clock_adjtime,
    libc::SYS_bpf,
    libc::SYS_acct,
    // File systems and name spaces.
    libc::SYS_mount,
    libc::SYS_umount2,
    libc::SYS_pivot_root,
    libc::SYS_chroot,
    libc::SYS_setns,
    libc::SYS_unshare,
    libc::SYS_quotactl,
];

/// Signals: only to the process itself, which is the first argument.
const SIGNALS: [libc::c_long; 5] = [
    libc::SYS_kill,
    libc::SYS_tkill,
    libc::SYS_tgkill,
    libc::SYS_rt_sigqueueinfo,
    libc::SYS_rt_tgsigqueueinfo,
];

/// Refuses them to all threads of this process, from now on.
///
/// # Errors
/// If the kernel has no such filters, or may not be asked for one.
pub(super) fn refuse_system_calls() -> io::Result<()> {
    apply_filter_all_threads(&program()?).map_err(io::Error::other)
}

fn program() -> io::Result<BpfProgram> {
    let mut rules: BTreeMap<i64, Vec<SeccompRule>> =
        REFUSED.iter().map(|number| (*number, Vec::new())).collect();
    let own = u64::from(std::process::id());
    for number in SIGNALS {
        rules.insert(number, vec![if_argument(SeccompCmpOp::Ne, own)?]);
    }
    // Nobody unties the host from the container.
    let death_signal = u64::try_from(libc::PR_SET_PDEATHSIG).unwrap_or_default();
    rules.insert(
        libc::SYS_prctl,
        vec![if_argument(SeccompCmpOp::Eq, death_signal)?],
    );
    let architecture = std::env::consts::ARCH
        .try_into()
        .map_err(io::Error::other)?;
    SeccompFilter::new(
        rules,
        SeccompAction::Allow,
        SeccompAction::Errno(libc::EPERM.cast_unsigned()),
        architecture,
    )
    .and_then(TryInto::try_into)
    .map_err(io::Error::other)
}

/// Refused if the first argument compares so with `value`.
fn if_argument(comparison: SeccompCmpOp, value: u64) -> io::Result<SeccompRule> {
    let condition = SeccompCondition::new(0, SeccompCmpArgLen::Dword, comparison, value);
    condition
        .and_then(|condition| SeccompRule::new(vec![condition]))
        .map_err(io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_a_program_for_this_machine() {
        let program = program().expect("it compiles");
        assert!(program.len() > REFUSED.len());
    }
}
