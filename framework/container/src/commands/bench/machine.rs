//! The machine that figures were taken on.

use std::fmt;
use std::fs;

use serde::Serialize;
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

/// What a reader of figures should know of it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Model of the processor.
    pub processor: String,
    /// Cores that this process may use.
    pub cores: usize,
    /// Memory in MiB.
    pub memory_mib: u64,
    /// Name and release of the kernel.
    pub kernel: String,
    /// Whether it runs under a hypervisor, which makes a wake-up of another core several times as
    /// long.
    pub is_virtual: bool,
    /// Whether real-time scheduling is permitted (`SCHED_FIFO`).
    pub real_time: bool,
}

impl Machine {
    /// The machine that this process runs on. What cannot be found out is said to be unknown.
    pub fn here() -> Self {
        let processors = read("/proc/cpuinfo");
        let model = field(&processors, "model name").or_else(|| field(&processors, "Model"));
        let flags = field(&processors, "flags").unwrap_or_default();
        let memory = field(&read("/proc/meminfo"), "MemTotal").unwrap_or_default();
        let memory_kib = memory.split_whitespace().next();
        Self {
            processor: model.unwrap_or_else(|| "unknown processor".to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            memory_mib: memory_kib
                .and_then(|kib| kib.parse::<u64>().ok())
                .map_or(0, |kib| kib / 1024),
            kernel: format!(
                "{} {}",
                read("/proc/sys/kernel/ostype").trim(),
                read("/proc/sys/kernel/osrelease").trim()
            ),
            is_virtual: flags.split_whitespace().any(|flag| flag == "hypervisor"),
            real_time: real_time_is_permitted(),
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            processor,
            cores,
            memory_mib,
            kernel,
            is_virtual,
            real_time,
        } = self;
        let of_virtual = if *is_virtual {
            " (virtual machine)"
        } else {
            ""
        };
        let scheduling = if *real_time {
            "SCHED_FIFO permitted"
        } else {
            "SCHED_FIFO NOT permitted"
        };
        write!(
            formatter,
            "{processor}, {cores} cores{of_virtual}, {memory_mib} MiB, {kernel}, {scheduling}"
        )
    }
}

fn read(path: &str) -> String {
    fs::read_to_string(path).unwrap_or_default()
}

/// The first value of a field in the way of `/proc`: `name : value`.
fn field(text: &str, name: &str) -> Option<String> {
    let mut fields = text.lines().filter_map(|line| line.split_once(':'));
    let (_, value) = fields.find(|(key, _)| key.trim() == name)?;
    Some(value.trim().to_owned())
}

/// Asked by a thread of its own: this one keeps its priority.
fn real_time_is_permitted() -> bool {
    let asking = std::thread::spawn(|| {
        let fifo = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
        set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Min, fifo).is_ok()
    });
    asking.join().unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_by_their_whole_name() {
        let text = "processor\t: 0\nmodel\t\t: 17\nmodel name\t: A processor: fast\nflags\t\t: fpu hypervisor\n";
        let cases = [
            ("model name", Some("A processor: fast")),
            ("model", Some("17")),
            ("flags", Some("fpu hypervisor")),
            ("name", None),
        ];
        for (name, expected) in cases {
            assert_eq!(field(text, name).as_deref(), expected, "{name}");
        }
    }
}
