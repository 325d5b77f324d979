//! Figure 8 of Ahn et al. (2012): six applications in one container, two cameras dead.

use std::path::PathBuf;

use serde_json::{Value, json};
use tests::{Application, Outcome, repository};

/// The applications of the figure, C, B, A, D, E, F, as the scenario's command has them.
const APPLICATIONS: [&str; 6] = [
    "navigation",
    "obstacle_detection",
    "hri",
    "human_interaction",
    "localisation",
    "mapping",
];

fn run(arguments: &[&str]) -> Outcome {
    let profiles = repository().join("profiles/applications");
    let files = APPLICATIONS.map(|name| profiles.join(format!("{name}.xml")));
    let scenario = repository().join("rules/scenarios/two_cameras_dead");
    let file = |name: &str| scenario.join(name).display().to_string();
    let rules = file("rules.xml");
    let injections = ["injections.xml", "injections_of_obstacle_detection.xml"].map(file);
    let scenario = [
        "--rules",
        &rules,
        "--inject",
        &injections[0],
        "--inject",
        &injections[1],
    ];
    let files: Vec<PathBuf> = files.into();
    Application::new()
        .run_together(&files, &[&scenario, arguments].concat())
        .ended_well()
}

fn verdicts(outcome: &Outcome) -> Vec<&Value> {
    let events = outcome.all_events().iter();
    events.filter(|event| event["event"] == "verdict").collect()
}

/// A and D live, B and C stop, E and F notice nothing.
#[track_caller]
fn ends_as_in_the_figure(outcome: &Outcome) {
    let state = |name: &str| &outcome.summary()["applications"][name]["state"];
    for (name, expected) in [
        ("hri", "DEGRADED"),
        ("human_interaction", "ACTIVE"),
        ("obstacle_detection", "STOPPED"),
        ("navigation", "STOPPED"),
        ("localisation", "ACTIVE"),
        ("mapping", "ACTIVE"),
    ] {
        assert_eq!(state(name), expected, "{name}");
    }
    for (name, state) in [
        ("hri/front_camera", "ACTIVE"),
        ("hri/left_camera", "ERROR"),
        ("hri/right_camera", "ERROR"),
        ("hri/left_detector", "ACTIVE"),
        ("obstacle_detection/left_camera", "ERROR"),
        ("obstacle_detection/right_camera", "INACTIVE"),
        ("navigation/path_planner", "INACTIVE"),
        ("navigation/actuator_control", "INACTIVE"),
    ] {
        assert_eq!(outcome.component(name)["state"], state, "{name}");
    }
}

/// The camera that B lost is the root cause of all that was stopped, C's components among it.
#[track_caller]
fn the_root_cause_is_named(outcome: &Outcome) {
    let verdicts = verdicts(outcome);
    let of_camera = |it: &&&Value| it["component"] == "obstacle_detection/left_camera";
    let last = verdicts.iter().rfind(of_camera).expect("a verdict");
    assert_eq!(last["cause"], "root");
    assert_eq!(last["kind"], "error_return");
    let actions = last["actions"].as_array().expect("actions");
    for stopped in [
        "stop obstacle_detection/right_camera",
        "stop obstacle_detection/left_detector",
        "stop obstacle_detection/right_detector",
        "stop obstacle_detection/obstacle_avoidance",
        "stop navigation/path_planner",
        "stop navigation/actuator_control",
    ] {
        let action = actions.iter().find(|action| action["action"] == stopped);
        assert_eq!(
            action.map(|it| &it["outcome"]),
            Some(&json!("done")),
            "{stopped}"
        );
    }
    for time in ["detection_us", "decision_us", "handling_us"] {
        assert!(last[time].is_u64(), "{time}");
    }
    let unconcerned = ["human_interaction", "localisation", "mapping"];
    for verdict in verdicts {
        let text = verdict.to_string();
        assert!(
            unconcerned.iter().all(|name| !text.contains(name)),
            "{text}"
        );
    }
}

#[test]
fn it_ends_as_in_the_figure() {
    let outcome = run(&["--clock", "simulated", "--for", "5s"]);
    ends_as_in_the_figure(&outcome);
    the_root_cause_is_named(&outcome);
    for (name, cycles) in [
        ("localisation/wheel_encoders", 250),
        ("mapping/left_sonar", 250),
        ("mapping/obstacle_avoidance", 250),
        ("human_interaction/path_planner", 125),
    ] {
        assert_eq!(outcome.cycles(name), cycles, "{name} noticed something");
    }
    let again = run(&["--clock", "simulated", "--for", "5s"]);
    assert_eq!(outcome.raw_events(), again.raw_events());
}

#[test]
fn it_ends_so_in_real_time_too() {
    let outcome = run(&["--clock", "real", "--for", "4s"]);
    ends_as_in_the_figure(&outcome);
    the_root_cause_is_named(&outcome);
}
