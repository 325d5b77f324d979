//! What it costs a process to contain, and to run, components.

use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use tests::{Application, Member, Watched, artifacts};

/// Many times what it takes.
const LIMIT: Duration = Duration::from_secs(300);

fn printed(command: &mut Command) -> String {
    let finished = Watched::spawn(command).wait(LIMIT);
    assert_eq!(finished.code, Some(0), "{finished}");
    finished.stdout
}

/// An abandoned instance keeps its stack, of which a few pages were touched, and its heap. A stack
/// overflow has touched the whole stack. Nothing else may stay behind.
#[test]
fn ten_thousand_faults_leave_only_the_abandoned_instances() {
    const INSTANCE_KIB: u64 = 32;
    const STACK_KIB: u64 = 1024;
    let storm = env!("CARGO_BIN_EXE_fault_storm");
    let text = printed(Command::new(storm).arg(artifacts()));
    let figures: Value = serde_json::from_str(&text).expect("the storm prints JSON");
    let (before, after) = (&figures["before"], &figures["after"]);
    for unchanged in ["descriptors", "threads", "blocked_signals"] {
        assert_eq!(
            before[unchanged], after[unchanged],
            "{unchanged}: {figures}"
        );
    }
    let number = |value: &Value| value.as_u64().expect("a number");
    let (faults, overflows) = (number(&figures["faults"]), number(&figures["overflows"]));
    assert_eq!(faults, 10_000);
    let growth = number(&after["resident_kib"]).saturating_sub(number(&before["resident_kib"]));
    let bound = faults * INSTANCE_KIB + overflows * STACK_KIB;
    assert!(growth < bound, "{growth} KiB of at most {bound}: {figures}");
}

/// A takeover by a standby: what is still allocated and freed from the fault to the successor's first
/// completed callback is what the fault manager and the event log keep of it (names, texts, the
/// symptom), each in a piece of its own. Nothing is loaded.
#[test]
fn a_takeover_allocates_only_what_is_kept_of_it() {
    const MOST: u64 = 44;
    const RULES: &str = "<resurrect><reset>true</reset><backup>1</backup></resurrect>\
                         <fault window='100ms'><retry_max>100</retry_max></fault>";
    for preload in ["loaded", "warm"] {
        let rules = format!("<standby preload='{preload}'/>{RULES}");
        let mut takeover = Command::new(env!("CARGO_BIN_EXE_takeover"));
        takeover
            .arg(artifacts())
            .args([rules.as_str(), "segfault", "20", "SCHED_OTHER", "64"]);
        let text = printed(&mut takeover);
        let figures: Value = serde_json::from_str(&text).expect("it prints JSON");
        let by = format!("by a {preload} standby");
        let allocations = figures["takeovers"][&by]["allocations"].as_u64();
        assert!(allocations.is_some_and(|it| it <= MOST), "{figures}");
    }
}

/// Data through every kind of queue, events, calls, checkpoints and their way to the disk: the container
/// allocates nothing for them.
#[test]
fn nothing_on_the_path_allocates() {
    let application = Application::new()
        .with(&Member::new("counter", "counter").property("remembers", "true"))
        .with(&Member::new("first", "echo").queue("FIFO", 8))
        .with(&Member::new("second", "echo").queue("LIFO", 8))
        .with(
            &Member::new("third", "echo")
                .queue("LAST", 1)
                .kind("aperiodic"),
        )
        .with(&Member::new("recorder", "recorder").queue("FIFO", 2))
        .with(&Member::new("herald", "herald"))
        .with(&Member::new("asker", "asker"))
        .with(&Member::new("patient", "panics").property("callback", "never"))
        .connect("data", "counter.output", "first.input")
        .connect("data", "first.output", "second.input")
        .connect("data", "second.output", "third.input")
        .connect("data", "third.output", "recorder.input")
        .connect("event", "herald.news", "patient.heard")
        .connect("service", "asker.arithmetic", "patient.arithmetic");
    let counter = env!("CARGO_BIN_EXE_allocation_count");
    let text = printed(
        Command::new(counter)
            .arg(application.profile())
            .arg(artifacts()),
    );
    assert_eq!(text.trim(), "0");
}
