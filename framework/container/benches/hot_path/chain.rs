//! One executor cycle of a chain of components, each reading a 64-byte datum and writing one; without
//! monitors, and with all kinds of them on every component.

use std::sync::Arc;
use std::time::Duration;

use component_sdk::expansion::descriptor;
use component_sdk::prelude::*;
use container::adaptation::AdaptationRequests;
use container::clock::Clock;
use container::component::{
    Component as Running, ComponentCell, DataInput, DataOutput, Environment, PortEnd, Services,
};
use container::event_log::EventLog;
use container::executor::{Executor, Member};
use container::guard::{CodeRange, Guarded};
use container::injection::Injections;
use container::lane::{Crew, Lane, Work};
use container::port::connection;
use container::schedule::BusyTime;
use container::status::ComponentStatus;
use container::supervision::{LOOK_PERIOD, Monitors, Observations, Scenes};
use container::wake::Wake;
use container::world::Worlds;
use criterion::Criterion;
use system_model::data_type::{DataType, Field, Scalar};
use system_model::life_cycle::Operation;
use system_model::specification::{ExecutionKind, QueuePolicy, SchedulingPolicy};

use super::monitored;

/// 64 bytes, as a pose with a time stamp has.
#[derive(PortData, Clone, Copy)]
#[repr(C)]
struct Sample {
    values: [f64; 8],
}

/// Period of the chain: that of most of the reference robot.
pub const PERIOD: Duration = Duration::from_millis(20);

/// Largest number that is sent.
pub const LARGEST: f64 = 100.0;

/// The ports of a link, by index.
pub const INPUT: usize = 0;
/// See [`INPUT`].
pub const OUTPUT: usize = 1;

/// What the links send, as their library would describe it.
pub fn data_type() -> DataType {
    DataType {
        name: "Sample".to_owned(),
        size: size_of::<Sample>(),
        layout_hash: 0,
        fields: vec![Field {
            path: "values".to_owned(),
            unit: String::new(),
            offset: 0,
            scalar: Scalar::F64,
            count: 8,
        }],
    }
}

#[derive(Ports)]
struct LinkPorts {
    input: Input<Sample>,
    output: Output<Sample>,
}

/// Passes on what it gets; the first of the chain, which gets nothing, sends a number.
struct Link {
    ports: LinkPorts,
    number: f64,
    /// Numbers passed on: what a checkpoint keeps.
    passed: Option<&'static mut Sample>,
}

impl Component for Link {
    type Ports = LinkPorts;

    fn new(ports: LinkPorts) -> Self {
        Self {
            ports,
            number: 0.0,
            passed: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.passed = Some(context.critical(Sample { values: [0.0; 8] })?);
        Ok(())
    }

    fn on_execute(&mut self, _context: &Context) -> Outcome {
        self.number = (self.number + 1.0) % LARGEST;
        let sample = self.ports.input.read().unwrap_or(Sample {
            values: [self.number; 8],
        });
        self.ports.output.write(&sample);
        if let Some(passed) = &mut self.passed {
            **passed = sample;
        }
        Ok(())
    }
}

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("cycle");
    for length in [2, 10] {
        group.bench_function(format!("chain_of_{length}"), |bencher| {
            bencher.iter_custom(|count| time_cycles(length, count, false));
        });
        group.bench_function(format!("monitored_chain_of_{length}"), |bencher| {
            bencher.iter_custom(|count| time_cycles(length, count, true));
        });
    }
    group.finish();
}

/// How often the monitors are looked at in a period.
const LOOKS: u32 = (PERIOD.as_millis() / LOOK_PERIOD.as_millis()) as u32;

/// Cycles run on a lane, as in the container: the lane's thread is prepared for traps.
struct Cycles {
    executor: Executor,
    /// Looked at as often as the fault manager's thread does in a period, on this thread: that it is
    /// another one in real time would only hide the cost.
    monitors: Option<Monitors>,
    environment: Arc<Environment>,
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
            let now = PERIOD * u32::try_from(cycle).expect("not so many");
            self.executor.cycle(nanoseconds(now), lane);
            if let Some(monitors) = &mut self.monitors {
                for look in 0..LOOKS {
                    monitors.look(now + LOOK_PERIOD * look, &self.environment.observations);
                }
            }
        }
        *self.time.lock().expect("not poisoned") = start.elapsed();
        assert!(
            !self.environment.observations.is_pending(),
            "nothing is wrong with the chain"
        );
    }

    fn after_loss(&mut self, lost: &container::guard::loss::LostThread) {
        panic!("a component of the benchmark was lost: {lost:?}");
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).expect("not so long")
}

fn time_cycles(length: usize, count: u64, monitored: bool) -> Duration {
    let (events, writer) = EventLog::open(None, false, None).expect("an event log");
    let environment = Arc::new(Environment {
        clock: Clock::simulated(),
        events,
        observations: Observations::default(),
        scenes: Scenes::default(),
        injections: Injections::default(),
        worlds: Worlds::default(),
        score: None,
        adaptation_requests: AdaptationRequests::default(),
        busy: BusyTime::default(),
    });
    let mut executor = Executor::new(
        "chain".to_owned(),
        ExecutionKind::Periodic,
        PERIOD,
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
                newest_from_afar: None,
                tap: None,
                size: size_of::<Sample>(),
            }),
            PortEnd::DataOutput(output),
        ];
        executor.members.push(member(number, ports, &environment));
    }
    let time = Arc::new(std::sync::Mutex::new(Duration::ZERO));
    let monitors = monitored.then(|| monitored::instrument(&executor));
    let work = Cycles {
        executor,
        monitors,
        environment: Arc::clone(&environment),
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
            guarded, services, status, PERIOD,
        ))),
        number,
        triggers: Vec::new(),
        followers: Vec::new(),
    }
}
