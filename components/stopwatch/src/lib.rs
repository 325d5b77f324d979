//! Stopwatch: measures how long data take through the components between two of its kind, and how
//! long a cycle takes.
//!
//! In every cycle it sends the time, and notes how old the datum is that has arrived. The time is
//! that of the machine's monotonic clock, whatever the container's clock is, so that two stopwatches
//! agree in different processes and in simulated time.
//!
//! Properties: `samples`, how many of the last times of each kind are kept (default 10000);
//! `record`, the file that they are written to when it is stopped (default: none).
#![forbid(unsafe_code)]

mod record;

use component_sdk::prelude::*;
use rustix::time::{ClockId, clock_gettime};

use record::Record;

/// What is sent: as the relay passes it on.
#[derive(PortData, Debug, Clone, Copy)]
#[repr(C)]
pub struct Parcel {
    /// Counted from 1.
    sequence: u64,
    /// When it was sent, by the machine's monotonic clock.
    #[unit("ns")]
    time: u64,
    /// From 0 to 999.
    value: f64,
}

/// Values repeat after so many data, so that they stay in a range that a rule can name.
const VALUES: u16 = 1000;

/// Ports of the stopwatch.
#[derive(Ports)]
pub struct StopwatchPorts {
    input: Input<Parcel>,
    output: Output<Parcel>,
}

/// The stopwatch.
pub struct Stopwatch {
    ports: StopwatchPorts,
    sequence: u64,
    value: u16,
    record: Record,
    file: Option<String>,
}

impl Component for Stopwatch {
    type Ports = StopwatchPorts;

    fn new(ports: StopwatchPorts) -> Self {
        Self {
            ports,
            sequence: 0,
            value: 0,
            record: Record::default(),
            file: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.record = Record::new(context.property_or("samples", 10_000)?);
        self.file = context.property("record");
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let arrived = self.ports.input.read();
        let now_ns = monotonic_ns();
        let by_container = || u64::try_from(context.now().as_nanos()).unwrap_or(u64::MAX);
        self.record.cycle(now_ns, by_container);
        if let Some(parcel) = arrived {
            self.record.passage(now_ns.saturating_sub(parcel.time));
        }
        self.sequence += 1;
        self.value = (self.value + 1) % VALUES;
        self.ports.output.write(&Parcel {
            sequence: self.sequence,
            time: now_ns,
            value: f64::from(self.value),
        });
        Ok(())
    }

    fn on_stop(&mut self, _context: &Context) -> Outcome {
        let Some(file) = &self.file else {
            return Ok(());
        };
        std::fs::write(file, self.record.to_string())
            .map_err(|error| Failure::new(Status::OUT_OF_RESOURCES, format!("{file}: {error}")))
    }
}

fn monotonic_ns() -> u64 {
    let time = clock_gettime(ClockId::Monotonic);
    let seconds = u64::try_from(time.tv_sec).unwrap_or_default();
    let nanoseconds = u64::try_from(time.tv_nsec).unwrap_or_default();
    seconds * 1_000_000_000 + nanoseconds
}

export_component!(Stopwatch);
