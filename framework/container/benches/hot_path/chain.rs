//! One executor cycle of a chain of components, each reading a 64-byte datum and writing one.

use std::sync::Arc;
use std::time::Duration;

use component_sdk::expansion::descriptor;
use component_sdk::prelude::*;
use container::clock::Clock;
use container::component::{
    Component as Running, ComponentCell, DataInput, DataOutput, Environment, PortEnd, Services,
};
use container::device::Devices;
use container::event_log::EventLog;
use container::executor::{Executor, Member};
use container::guard::{CodeRange, Guarded};
use container::injection::Injections;
use container::lane::{Crew, Lane, Work};
use container::port::connection;
use container::schedule::BusyTime;
use container::status::ComponentStatus;
use container::supervision::{Observations, Scenes};
use container::wake::Wake;
use criterion::Criterion;
use system_model::life_cycle::Operation;
use system_model::specification::{ExecutionKind, QueuePolicy, SchedulingPolicy};

/// 64 bytes, as a pose with a time stamp has.
#[derive(PortData, Clone, Copy)]
#[repr(C)]
struct Sample {
    values: [u64; 8],
}

#[derive(Ports)]
struct LinkPorts {
    input: Input<Sample>,
    output: Output<Sample>,
}

/// Passes on what it gets; the first of the chain, which gets nothing, sends a number.
struct Link {
    ports: LinkPorts,
    number: u64,
}

impl Component for Link {
    type Ports = LinkPorts;

    fn new(ports: LinkPorts) -> Self {
        Self { ports, number: 0 }
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        self.number += 1;
        let sample = self.ports.input.read().unwrap_or(Sample {
            values: [self.number; 8],
        });
        self.ports.output.write(&sample);
        Ok(())
    }
}

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("cycle");
    for length in [2, 10] {
        group.bench_function(format!("chain_of_{length}"), |bencher| {
            bencher.iter_custom(|count| time_cycles(length, count));
        });
    }
    group.finish();
}

/// Cycles run on a lane, as in the container: the lane's thread is prepared for traps.
struct Cycles {
    executor: Executor,
    count: u64,
    time: Arc<std::sync::Mutex<Duration>>,
}

impl Work for Cycles {
    fn run(&mut self, lane: &Lane) {
        for member in &self.executor.members {
            let mut component = member
                .component
                .enter(lane.token(), Duration::ZERO)
                .expect("free");
            component.construct(lane.loss()).expect("constructed");
            for operation in [Operation::Initialize, Operation::Start] {
                component.operate(operation, lane.loss()).expect("operated");
            }
        }
        let start = std::time::Instant::now();
        for cycle in 0..self.count {
            self.executor.cycle(cycle, lane);
        }
        *self.time.lock().expect("not poisoned") = start.elapsed();
    }

    fn after_loss(&mut self, lost: &container::guard::loss::LostThread) {
        panic!("a component of the benchmark was lost: {lost:?}");
    }
}

fn time_cycles(length: usize, count: u64) -> Duration {
    let (events, writer) = EventLog::open(None, false, None).expect("an event log");
    let environment = Arc::new(Environment {
        clock: Clock::simulated(),
        events,
        devices: Devices::default(),
        observations: Observations::default(),
        scenes: Scenes::default(),
        injections: Injections::default(),
        world: None,
        busy: BusyTime::default(),
    });
    let mut executor = Executor::new(
        "chain".to_owned(),
        ExecutionKind::Periodic,
        Duration::from_millis(1),
        0,
        SchedulingPolicy::Other,
        Arc::new(Wake::default()),
    );
    let mut arriving = None;
    for number in 0..length {
        let (sender, receiver) = connection(QueuePolicy::Last, 1, size_of::<Sample>());
        let output = DataOutput {
            size: size_of::<Sample>(),
            tap: None,
            connections: if number + 1 < length {
                vec![(sender, None)]
            } else {
                Vec::new()
            },
        };
        let ports = vec![
            PortEnd::DataInput(DataInput {
                source: arriving.replace(receiver),
                tap: None,
                size: size_of::<Sample>(),
            }),
            PortEnd::DataOutput(output),
        ];
        executor.members.push(member(number, ports, &environment));
    }
    let time = Arc::new(std::sync::Mutex::new(Duration::ZERO));
    let work = Cycles {
        executor,
        count,
        time: Arc::clone(&time),
    };
    let crew = Crew::new().expect("a crew");
    let lane = Lane::new("bench", Box::new(work));
    crew.start(&lane, || {}).expect("a thread");
    assert!(lane.wait(Duration::from_secs(60)), "the cycles end");
    crew.dismiss();
    environment.events.finish();
    writer.close().expect("no file to fail");
    *time.lock().expect("not poisoned")
}

fn member(number: usize, ports: Vec<PortEnd>, environment: &Arc<Environment>) -> Member {
    let name = format!("link{number}");
    let callbacks = descriptor::<Link>("link", "0").callbacks;
    let code = CodeRange { start: 0, end: 0 };
    let number = u32::try_from(number).expect("few");
    let guarded = Guarded::new(callbacks, code, number).expect("a stack");
    let status = Arc::new(ComponentStatus::new(name.clone()));
    let services = Services::new(
        Arc::from(name.as_str()),
        1,
        Arc::clone(environment),
        Arc::from([]),
        ports,
        Vec::new(),
    );
    Member {
        component: Arc::new(ComponentCell::new(Running::new(
            guarded,
            services,
            status,
            Duration::from_millis(1),
        ))),
        number,
        triggers: Vec::new(),
        followers: Vec::new(),
    }
}
