use std::time::Duration;

use system_model::task::{
    Condition, ContainerFigure, DecisionOptions, GenerationOptions, GivenEstimate, HopCount,
    Placement, QualityAttribute,
};

use super::*;

const TASK: &str = include_str!("../../../tests/data/schema/task.xml");

fn messages(text: &str) -> Vec<String> {
    let outcome = load(&Document::from_bytes("task.xml", text.as_bytes()));
    let problems = outcome.problems.into_iter();
    problems.map(|problem| problem.message).collect()
}

#[test]
fn names_become_numbers_and_amounts_stand_by_resource() {
    let outcome = load(&Document::from_bytes("task.xml", TASK.as_bytes()));
    assert!(outcome.problems.is_empty(), "{:?}", outcome.problems);
    let task = outcome.task.expect("a good task");
    let names: Vec<&str> = task.components.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(names, ["camera", "filter", "sharpener", "motor"]);
    let essential: Vec<bool> = task.components.iter().map(|it| it.is_essential).collect();
    assert_eq!(essential, [true, false, false, true]);
    assert_eq!(task.sub_tasks[1].components, [3]);
    assert_eq!((task.links[0].from, task.links[0].to), (0, 3));
    assert_eq!(task.links[0].through, [1, 2]);
    assert_eq!(task.exclusions, [[1, 2]]);
    assert_eq!(task.robots[0].available, [2.0, 5.0]);
    assert_eq!(task.robots[1].available, [0.0, 0.0]);
    let camera = &task.robots[0].instances[0];
    assert_eq!(camera.demand, [0.2, 0.0]);
    let on_second = Condition {
        component: 3,
        robot: Some(1),
    };
    let with_filter = Condition {
        component: 1,
        robot: None,
    };
    let conditional = GivenEstimate {
        functional: 0.1,
        with: vec![with_filter, on_second],
    };
    assert_eq!(camera.estimates[0], conditional);
    let running = [0, 3].map(|component| Placement {
        component,
        robot: 0,
    });
    assert_eq!(task.running.as_deref(), Some(&running[..]));
    assert_eq!(task.generation.hops, HopCount::Essential);
    assert_eq!(task.decision.dwell, Duration::from_secs(5));
}

#[test]
fn what_is_measured_of_a_running_robot_is_attached_to_its_instances() {
    let outcome = load(&Document::from_bytes("task.xml", TASK.as_bytes()));
    let task = outcome.task.expect("a good task");
    let ports = &task.links[0].ports;
    assert_eq!(ports.output.as_deref(), Some("picture"));
    let (blurred, sharp) = (Some("blurred".to_owned()), Some("sharp".to_owned()));
    assert_eq!(ports.through, [(None, None), (blurred, sharp)]);
    let sensor = &task.robots[0].sensors[0].value;
    assert_eq!((sensor.resource, sensor.scale), (1, 0.5));
    let motor = &task.robots[0].instances[2].attachment;
    assert_eq!(motor.subcomponent.as_deref(), Some("drive"));
    assert_eq!(motor.gauges, [(0, ContainerFigure::ProcessorLoad)]);
    let [noise, age] = &motor.evaluators[..] else {
        panic!("{:?}", motor.evaluators);
    };
    let window = QualityAttribute::StandardDeviation { window: 30 };
    assert_eq!(noise.value.attribute, window);
    assert_eq!((noise.value.target, noise.value.scale), (-1.0, 2.0));
    assert_eq!(age.value.attribute, QualityAttribute::Age);
    assert_eq!((age.value.target, age.value.scale), (0.0, 1.0));
    let estimator = motor.estimator.as_ref().expect("an estimator");
    assert_eq!(estimator.value.cycles, 2);
    let own = ("estimate".to_owned(), Some("error".to_owned()));
    assert_eq!(estimator.value.own, Some(own));
    assert_eq!(task.decision.evaluation_period, Duration::from_millis(5));
}

#[test]
fn what_is_not_said_is_usual() {
    let start = TASK.find("  <generation").expect("options");
    let end = TASK.find("  <running>").expect("what runs");
    let text = format!("{}{}", &TASK[..start], &TASK[end..]);
    let outcome = load(&Document::from_bytes("task.xml", text.as_bytes()));
    let task = outcome.task.expect("a good task");
    assert_eq!(task.generation, GenerationOptions::default());
    assert_eq!(task.decision, DecisionOptions::default());
}

#[test]
fn the_task_begins_in_its_initial_state() {
    let text = TASK.replace("initial=\"following\"", "initial=\"there\"");
    let text = text.replace(
        "from=\"following\" event=\"reached\" to=\"there\"",
        "from=\"there\" event=\"moved\" to=\"following\"",
    );
    let outcome = load(&Document::from_bytes("task.xml", text.as_bytes()));
    assert!(outcome.problems.is_empty(), "{:?}", outcome.problems);
    let machine = outcome.task.expect("a good task").state_machine;
    let names: Vec<&str> = machine.states.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(names, ["there", "following"]);
    assert_eq!(
        (machine.transitions[0].from, machine.transitions[0].to),
        (0, 1)
    );
}

#[test]
fn every_mistake_is_told_at_once() {
    let text = TASK
        .replace(
            "<through component=\"filter\"/>",
            "<through component=\"fliter\"/>",
        )
        .replace("name=\"sharpener\" class", "name=\"filter\" class")
        .replace("<run sub_task=\"move\"/>", "")
        .replace("<has resource=\"power\"", "<has resource=\"cpu\"")
        .replace("<use component=\"motor\" robot=\"R1\"/>", "")
        .replace("hysteresis=\"0.1\"", "hysteresis=\"11\"");
    let messages = messages(&text);
    for expected in [
        "the task has no component called `fliter`",
        "`filter` stands here again",
        "no state runs the sub-task `move`",
        "this resource stands here again",
        "`11` in attribute hysteresis of <decision> is out of range",
    ] {
        let found = messages.iter().filter(|it| *it == expected).count();
        assert_eq!(found, 1, "{expected} in {messages:#?}");
    }
}

#[test]
fn what_runs_must_be_able_to() {
    for (from, to, expected) in [
        (
            "<use component=\"camera\" robot=\"R1\"/>",
            "<use component=\"camera\" robot=\"R2\"/>",
            "there is no R2:camera",
        ),
        (
            "<use component=\"camera\" robot=\"R1\"/>",
            "",
            "`camera` is essential and does not run",
        ),
        (
            "<use component=\"motor\" robot=\"R1\"/>\n  </running>",
            "<use component=\"motor\" robot=\"R1\"/><use component=\"motor\" robot=\"R2\"/></running>",
            "it cannot be used together with R1:motor",
        ),
        (
            "<instance component=\"camera\">",
            "<instance component=\"sharpener\">",
            "no robot has `camera`, so the task cannot be done",
        ),
    ] {
        let messages = messages(&TASK.replace(from, to));
        assert!(messages.iter().any(|it| it == expected), "{messages:#?}");
    }
}
