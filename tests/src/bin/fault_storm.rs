//! Ten thousand components fail in this one process, one after the other; prints what that cost it.
//!
//! A program of its own, because descriptors, threads and memory belong to a whole process.
//! Argument: the folder with the component libraries.
#![forbid(unsafe_code)]

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use container::component::{Component, DataOutput, Environment, PortEnd, Services};
use container::guard::Guarded;
use container::guard::loss::Loss;
use container::library::LoadedLibrary;
use container::port::{Receiver, connection};
use container::status::ComponentStatus;
use serde_json::json;
use system_model::life_cycle::{LifeCycleState, Operation};
use system_model::specification::{PortDirection, PortKind, QueuePolicy};
use tests::environment;

/// How many components fail.
const FAULTS: u64 = 10_000;

/// Misbehaviours by turns of chance. Not among them: a fault in the C library, which costs its
/// thread by design.
const KINDS: [&str; 10] = [
    "panics",
    "writes_null",
    "divides_by_zero",
    "illegal_instruction",
    "aborts",
    "exits",
    "bus_error",
    "bad_pointer",
    "returns_error",
    "double_panics",
];

/// One fault of so many is a stack overflow: it alone makes a whole stack of memory real.
const OVERFLOW_EVERY: u64 = 100;

/// Size of the datum that the test components exchange.
const SAMPLE_BYTES: usize = 16;

fn main() {
    let folder = std::env::args()
        .nth(1)
        .expect("the folder of the libraries");
    let load = |name: &str| {
        let path = Path::new(&folder).join(format!("lib{name}.so"));
        LoadedLibrary::load(&path).expect("a component of the tests")
    };
    Guarded::prepare_thread().expect("a stack for the handler");
    let libraries = KINDS.map(load);
    let overflow = load("overflows_stack");
    let (environment, writer) = environment();
    let mut healthy = Instance::new(&load("counter"), &environment);
    healthy.bring_up();
    // The first fault of each kind initialises what is made once.
    for library in libraries.iter().chain([&overflow]) {
        Instance::new(library, &environment).fail();
    }
    let before = Figures::now();
    let mut chance = Chance(1);
    for number in 0..FAULTS {
        let library = if number % OVERFLOW_EVERY == 0 {
            &overflow
        } else {
            &libraries[chance.below(KINDS.len())]
        };
        Instance::new(library, &environment).fail();
        healthy.cycle(number + 1);
    }
    let after = Figures::now();
    environment.events.finish();
    writer.close().expect("no file to fail");
    println!(
        "{}",
        json!({
            "faults": FAULTS,
            "overflows": FAULTS / OVERFLOW_EVERY,
            "before": before.to_json(),
            "after": after.to_json(),
        })
    );
}

/// A component with the other end of its data output.
struct Instance {
    component: Component,
    loss: Loss,
    receiver: Option<Receiver>,
}

impl Instance {
    fn new(library: &LoadedLibrary, environment: &Arc<Environment>) -> Self {
        let mut receiver = None;
        let ports =
            library
                .description
                .ports
                .iter()
                .map(|port| match (port.kind, port.direction) {
                    (PortKind::Data, PortDirection::Output) => {
                        let (sender, other) = connection(QueuePolicy::Last, 1, SAMPLE_BYTES);
                        receiver = Some(other);
                        PortEnd::DataOutput(DataOutput {
                            size: SAMPLE_BYTES,
                            connections: vec![(sender, None)],
                            tap: None,
                        })
                    }
                    (PortKind::Event, _) => PortEnd::EventInput,
                    _ => PortEnd::Provided,
                });
        let ports = ports.collect();
        let services = Services::new(
            Arc::from("instance"),
            1,
            Arc::clone(environment),
            library.description.ports.clone().into(),
            ports,
            vec![("at_cycle".to_owned(), "1".to_owned())],
        );
        let callbacks = library.description.callbacks;
        let guarded = Guarded::new(callbacks, library.code, 0).expect("a stack");
        let status = Arc::new(ComponentStatus::new("instance".to_owned()));
        Self {
            component: Component::new(guarded, services, status, Duration::from_millis(1)),
            loss: Loss::default(),
            receiver,
        }
    }

    fn bring_up(&mut self) {
        self.component.construct(&self.loss).expect("constructed");
        for operation in [Operation::Initialize, Operation::Start] {
            self.component
                .operate(operation, &self.loss)
                .expect("operated");
        }
    }

    /// Runs it to its fault.
    fn fail(mut self) {
        self.bring_up();
        self.component.execute(0, &self.loss);
        assert_eq!(self.component.state(), LifeCycleState::Error);
        assert_eq!(self.component.status().faults(), 1);
    }

    /// One cycle of the healthy component: it sends this number.
    fn cycle(&mut self, number: u64) {
        self.component.execute(0, &self.loss);
        let receiver = self.receiver.as_mut().expect("the counter has an output");
        let sent = receiver.receive().expect("it has sent something");
        assert_eq!(sent.bytes()[..8], number.to_ne_bytes());
    }
}

/// What the process has and holds.
struct Figures {
    descriptors: usize,
    threads: usize,
    resident_kib: u64,
    blocked_signals: String,
}

impl Figures {
    fn now() -> Self {
        let count = |folder: &str| std::fs::read_dir(folder).expect("/proc is there").count();
        let status = std::fs::read_to_string("/proc/thread-self/status").expect("/proc is there");
        let line = |key: &str| {
            status
                .lines()
                .find_map(|line| line.strip_prefix(key))
                .map(str::trim)
                .expect("the kernel tells")
        };
        let resident = line("VmRSS:").trim_end_matches(" kB");
        Self {
            descriptors: count("/proc/self/fd"),
            threads: count("/proc/self/task"),
            resident_kib: resident.parse().expect("a number of KiB"),
            blocked_signals: line("SigBlk:").to_owned(),
        }
    }

    fn to_json(&self) -> serde_json::Value {
        json!({
            "descriptors": self.descriptors,
            "threads": self.threads,
            "resident_kib": self.resident_kib,
            "blocked_signals": self.blocked_signals,
        })
    }
}

/// The same numbers every time, mixed well enough to vary the order.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        usize::try_from(self.0 >> 33).expect("31 bits") % limit
    }
}
