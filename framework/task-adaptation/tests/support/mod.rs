//! Tasks for tests and benchmarks.

use system_model::task::{
    Attachment, ComponentClass, DecisionOptions, GenerationOptions, LinkPorts, QualityPreferences,
    StateMachine, TaskComponent, TaskInstance, TaskLink, TaskResource, TaskRobot,
    TaskSpecification,
};

/// A chain from a sensor over computations to an actuator; every robot has everything, needs one unit
/// for each component, and has `room` units.
pub fn chain(robots: usize, components: usize, optional: usize, room: f64) -> TaskSpecification {
    let component = |index: usize| TaskComponent {
        name: format!("component_{index}"),
        class: match index {
            0 => ComponentClass::Sensor,
            index if index == components - 1 => ComponentClass::Actuator,
            _ => ComponentClass::Computation,
        },
        is_essential: index < components,
        threshold: 1.0,
    };
    let all = components + optional;
    let instance = |component| TaskInstance {
        component,
        demand: vec![1.0],
        estimates: Vec::new(),
        attachment: Attachment::default(),
    };
    let link = |from| TaskLink {
        from,
        to: from + 1,
        through: (components..all)
            .filter(|it| it % (components - 1) == from)
            .collect(),
        ports: LinkPorts::default(),
    };
    TaskSpecification {
        name: "chain".into(),
        sub_tasks: Vec::new(),
        state_machine: StateMachine {
            states: Vec::new(),
            transitions: Vec::new(),
        },
        components: (0..all).map(component).collect(),
        links: (0..components - 1).map(link).collect(),
        exclusions: Vec::new(),
        resources: vec![TaskResource {
            name: "cpu".into(),
            unit: String::new(),
            weight: 1.0,
        }],
        robots: (0..robots)
            .map(|robot| TaskRobot {
                name: format!("R{}", robot + 1),
                available: vec![room],
                sensors: Vec::new(),
                instances: (0..all).map(instance).collect(),
            })
            .collect(),
        quality: QualityPreferences {
            functional_weight: 1.0,
            functional_threshold: 0.1,
            non_functional_threshold: 0.1,
        },
        generation: GenerationOptions::default(),
        decision: DecisionOptions::default(),
        running: None,
    }
}
