//! All kinds of monitors that the rules of the reference robot use, on every component of a chain:
//! validity of input and output, freshness with a safe value, watchdog, heartbeat, memory, backup,
//! process model.

use std::sync::Arc;
use std::time::Duration;

use container::component::{
    CallLimits, Component, Detectors, InputTap, OutputTap, PortEnd, SafeDatum, Watch,
};
use container::executor::Executor;
use container::port::Newest;
use container::status::ComponentStatus;
use container::supervision::{
    Channel, InputAge, MemoryUse, ModelMonitor, Monitors, Reading, Reference, Subject, WorkDone,
};
use fault_manager::DetectorId;
use fault_manager::detection::NumberReader;
use fault_manager::detection::data_check::DataCheck;
use fault_manager::detection::liveness::{Freshness, Heartbeat};
use fault_manager::detection::process_model::Monitor;
use system_model::data_type::DataType;
use system_model::process_model::{Matrix, ProcessModel, StateSpace, StateSpaceKind};
use system_model::profile::Located;
use system_model::rules::{
    DecisionRule, FreshnessRule, HeartbeatRule, Judgement, PortChecks, ProcessModelRule, SafeValue,
    ValidityRule,
};
use system_model::specification::Place;

use super::chain::{INPUT, LARGEST, OUTPUT, PERIOD, data_type};

/// Nobody complains, so nobody is asked who it was.
const DETECTOR: DetectorId = DetectorId(0);

/// As the reference robot has it: every third cycle.
const BACKUP_PERIOD: Duration = Duration::from_millis(60);

/// Ten cycles.
const MAXIMUM_AGE: Duration = Duration::from_millis(200);

/// The field that is checked, and that is input and output of the process model.
const FIELD: &str = "values[0]";

/// Puts all of them on the members of an executor. What is looked at from time to time is returned.
pub fn instrument(executor: &Executor) -> Monitors {
    let mut monitors = Monitors::default();
    let mut newest: Option<Arc<Newest>> = None;
    for (index, member) in executor.members.iter().enumerate() {
        let mut component = member.component.enter(1, Duration::ZERO).expect("free");
        let status = Arc::clone(component.status());
        component.services_mut().set_detectors(Detectors {
            component: index,
            exception: DETECTOR,
            hang: DETECTOR,
            reported: DETECTOR,
        });
        component.set_limits(CallLimits::default());
        component.keep_checkpoints(BACKUP_PERIOD);
        component.count_allocations();
        monitors.heartbeats.push(heartbeat(&status));
        monitors.memories.push(MemoryUse {
            subject: subject(&status),
            limit_bytes: 1 << 20,
        });
        let model = process_model(&status);
        tap_input(&mut component, &model);
        if let Some(newest) = newest.take() {
            monitors.inputs.push(InputAge {
                subject: subject(&status),
                port: "input".to_owned(),
                freshness: Freshness::new(&freshness_rule()),
                newest,
            });
        }
        newest = tap_output(&mut component, &model, index == 0);
        monitors.models.push(model);
    }
    monitors
}

fn subject(status: &Arc<ComponentStatus>) -> Subject {
    Subject::new(DETECTOR, Arc::clone(status))
}

fn heartbeat(status: &Arc<ComponentStatus>) -> WorkDone {
    WorkDone {
        subject: subject(status),
        heartbeat: Heartbeat::new(&HeartbeatRule {
            period: 5 * PERIOD,
            missed: 3,
            judgement: Judgement::default(),
        }),
    }
}

fn freshness_rule() -> FreshnessRule {
    FreshnessRule {
        maximum_age: MAXIMUM_AGE,
        judgement: Judgement::default(),
    }
}

fn watch(data_type: &DataType, port: &str) -> Watch {
    let rule = ValidityRule {
        field: Some(FIELD.to_owned()),
        minimum: Some(0.0),
        maximum: Some(LARGEST),
        judgement: Judgement::default(),
    };
    let checks = PortChecks {
        validity: vec![Located {
            value: rule,
            place: Place::default(),
        }],
        ..PortChecks::default()
    };
    let check = DataCheck::compile(data_type, &checks).expect("the field is there");
    Watch::new(port.to_owned(), data_type.clone(), check, vec![DETECTOR])
}

fn reading() -> Reading {
    let reader = NumberReader::compile(&data_type(), Some(FIELD), 0);
    Reading::Number(reader.expect("the field is there"))
}

fn tap_input(component: &mut Component, model: &ModelMonitor) {
    let Some(PortEnd::DataInput(input)) = component.services_mut().port_mut(INPUT) else {
        panic!("a link has an input");
    };
    let data_type = data_type();
    let safe = SafeValue {
        field: None,
        value: 0.0,
    };
    let mut tap = InputTap::default();
    tap.watch = Some(watch(&data_type, "input"));
    tap.safe = SafeDatum::new(&data_type, std::iter::once(&safe)).ok();
    tap.maximum_age = Some(MAXIMUM_AGE);
    tap.samplers = vec![model.sampler(Channel::Input(0), reading())];
    input.tap = Some(Box::new(tap));
}

/// The first of the chain gets no data: what it sends is its model's input too.
fn tap_output(
    component: &mut Component,
    model: &ModelMonitor,
    is_first: bool,
) -> Option<Arc<Newest>> {
    let Some(PortEnd::DataOutput(output)) = component.services_mut().port_mut(OUTPUT) else {
        panic!("a link has an output");
    };
    let data_type = data_type();
    let mut tap = OutputTap::new(data_type.size);
    tap.watch = Some(watch(&data_type, "output"));
    if is_first {
        tap.samplers
            .push(model.sampler(Channel::Input(0), reading()));
    }
    tap.samplers
        .push(model.sampler(Channel::Output(0), reading()));
    output.tap = Some(Box::new(tap));
    let (sender, _) = output.connections.first_mut()?;
    Some(sender.watch())
}

/// Two states, as a driven wheel has; its noise is that of the numbers sent, which are any.
fn process_model(status: &Arc<ComponentStatus>) -> ModelMonitor {
    let matrix = |rows, columns, elements: &[f64]| Matrix {
        rows,
        columns,
        elements: elements.to_vec(),
    };
    let model = ProcessModel {
        name: "link".to_owned(),
        state_space: StateSpace {
            kind: StateSpaceKind::Discrete,
            period: PERIOD,
            a: matrix(2, 2, &[0.9, 0.0, 0.1, 0.9]),
            b: matrix(2, 1, &[0.1, 0.0]),
            c: matrix(1, 2, &[0.0, 1.0]),
            d: matrix(1, 1, &[0.0]),
            initial: vec![0.0, 0.0],
        },
        process_noise: matrix(2, 2, &[1e-3, 0.0, 0.0, 1e-3]),
        measurement_noise: matrix(1, 1, &[1.0]),
        input_delay: PERIOD,
        input_jitter: PERIOD,
        inputs: Vec::new(),
    };
    let rule = ProcessModelRule {
        model: "link".to_owned(),
        window: 9 * PERIOD,
        threshold: 10.0 * LARGEST,
        method: DecisionRule::Window,
        parameters: Vec::new(),
        judgement: Judgement::default(),
    };
    let monitor = Monitor::new(&model, &rule).expect("a sound model");
    let reference = Reference::Model(Box::new(monitor));
    let status = Arc::clone(status);
    ModelMonitor::new("link".to_owned(), "window", DETECTOR, status, reference)
}
