//! What is said and drawn of an application before anything runs.

use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use tests::{Application, Finished, Member, Watched, artifacts, assert_html, repository};

/// The whole table takes seconds in a build without optimisation.
const LIMIT: Duration = Duration::from_secs(100);

fn steadfast(arguments: &[&str]) -> Finished {
    let mut command = Command::new(artifacts().join("steadfast"));
    Watched::spawn(command.args(arguments)).wait(LIMIT)
}

/// A command about the reference robot with its rules.
fn of_robot(command: &str, arguments: &[&str]) -> String {
    let path = |name: &str| repository().join(name).display().to_string();
    let profile = path("profiles/applications/target_following.xml");
    let rules = path("rules/target_following.xml");
    let arguments = [&[command, &profile, "--rules", &rules], arguments].concat();
    let finished = steadfast(&arguments);
    assert_eq!(finished.code, Some(0), "{finished}");
    finished.stdout
}

fn json_of_robot(command: &str, arguments: &[&str]) -> Value {
    let arguments = [arguments, &["--format", "json"]].concat();
    serde_json::from_str(&of_robot(command, &arguments)).expect("JSON")
}

/// Whether a text is well-formed XML.
fn is_xml(text: &str) -> bool {
    let document = system_profile::Document::from_bytes("page", text.as_bytes());
    document.tree().is_some() && !document.has_errors()
}

const COMPONENTS: [&str; 11] = [
    "motor_driver",
    "camera",
    "object_detector",
    "front_sonar",
    "left_sonar",
    "right_sonar",
    "rear_sonar",
    "wheel_encoders",
    "obstacle_avoidance",
    "path_planner",
    "actuator_control",
];

#[test]
fn a_component_is_explained_from_its_detectors_to_its_loss() {
    let text = of_robot("explain", &["--component", "obstacle_avoidance"]);
    for words in [
        "does not return within 60 ms",
        "no cycle in 3 periods of 100 ms",
        "1. It is reset, at most 2 times within 10 s",
        "2. obstacle_avoidance_simple takes its place",
        "3. Emergency stop",
        "needs 3 of front_sonar, left_sonar, right_sonar, rear_sonar",
        "path_planner is stopped when it is",
        "If it cannot be brought back: emergency stop",
    ] {
        assert!(text.contains(words), "'{words}' is not in it: {text}");
    }
    let all = json_of_robot("explain", &[]);
    let names = all["components"].as_array().expect("components");
    let names: Vec<&str> = names
        .iter()
        .filter_map(|it| it["component"].as_str())
        .collect();
    assert_eq!(names, COMPONENTS);
}

#[test]
fn a_question_is_answered_by_the_fault_manager_itself() {
    let crash = json_of_robot("explain", &["--what-if", "obstacle_avoidance segfault"]);
    assert_eq!(
        crash["actions"],
        serde_json::json!(["reset obstacle_avoidance: done"])
    );
    let question = [
        "--what-if",
        "obstacle_avoidance segfault",
        "--assume-recovery-fails",
    ];
    let lost = json_of_robot("explain", &question);
    assert_eq!(lost["outcome"], "emergency stop");
    assert_eq!(lost["stops_robot"], true);
    let silence = of_robot("explain", &["--what-if", "camera.image drop"]);
    assert!(
        silence.contains("No rule and no default sees it"),
        "{silence}"
    );
}

/// The same faults as in the scenarios that are shipped, which are run elsewhere.
#[test]
fn answers_are_those_of_the_scenarios() {
    for (application, scenario, question, actions) in [
        (
            "redundant_sonars",
            "lying_sonar",
            "front_sonar_2.range offset",
            &["reset front_sonar_2: done", "stop front_sonar_2: done"][..],
        ),
        (
            "target_following",
            "unplugged_sonar",
            "left_sonar.range out_of_range",
            &[
                "reset left_sonar: done",
                "reset left_sonar: done",
                "stop left_sonar: done",
            ],
        ),
    ] {
        let profile = repository().join(format!("profiles/applications/{application}.xml"));
        let rules = repository().join(format!("rules/scenarios/{scenario}/rules.xml"));
        let (profile, rules) = (profile.display().to_string(), rules.display().to_string());
        let arguments = [
            "explain",
            &profile,
            "--rules",
            &rules,
            "--what-if",
            question,
        ];
        let finished = steadfast(&[&arguments[..], &["--format", "json"]].concat());
        let answer: Value = serde_json::from_str(&finished.stdout).expect("JSON");
        assert_eq!(answer["actions"], serde_json::json!(actions), "{scenario}");
    }
}

#[test]
fn a_question_that_is_none_is_refused_with_what_there_is() {
    let profile = repository().join("profiles/applications/target_following.xml");
    let profile = profile.display().to_string();
    let refused = steadfast(&["explain", &profile, "--what-if", "kamera segfault"]);
    assert_eq!(refused.code, Some(1), "{refused}");
    assert!(
        refused.stderr.contains("there are: motor_driver, camera"),
        "{refused}"
    );
    let missing = steadfast(&["graph", "no_such_file.xml"]);
    assert_eq!(missing.code, Some(2), "{missing}");
}

#[test]
fn the_table_flags_what_ends_in_nothing_and_whose_loss_stops_the_robot() {
    let table = json_of_robot("explain", &["--what-if", "all"]);
    let flagged = |key: &str| -> Vec<String> {
        let list = table[key].as_array().expect("a list").iter();
        list.filter_map(Value::as_str).map(str::to_owned).collect()
    };
    assert_eq!(flagged("loss_stops_robot"), COMPONENTS);
    let nothing = flagged("ends_in_nothing");
    assert!(nothing.contains(&"camera leak".to_owned()), "{nothing:?}");
    assert!(!nothing.contains(&"camera panic".to_owned()), "{nothing:?}");
    let page = of_robot("explain", &["--what-if", "all", "--format", "html"]);
    assert!(is_xml(&page), "the page is not well-formed");
    for forbidden in ["http://", "https://", "<script"] {
        assert!(!page.contains(forbidden), "the page needs {forbidden}");
    }
    let application = Application::new();
    assert_html(&application.write("table.html", &page));
}

#[test]
fn a_graph_shows_every_component_in_every_format() {
    for format in ["svg", "dot", "mermaid", "json"] {
        let text = of_robot("graph", &["--format", format]);
        for name in COMPONENTS
            .iter()
            .chain(&["drive", "obstacle_avoidance_simple"])
        {
            assert!(text.contains(name), "{name} is not in the {format}");
        }
        assert_eq!(is_xml(&text), format == "svg", "{format}");
    }
    let graph = json_of_robot("graph", &[]);
    let edges = graph["edges"].as_array().expect("edges");
    let of_kind = |kind: &str| edges.iter().filter(|edge| edge["kind"] == kind).count();
    assert_eq!(
        (of_kind("data"), of_kind("watch"), of_kind("dependency")),
        (16, 2, 10)
    );
    let shared = graph["executors"].as_array().expect("executors").iter();
    let shared = shared.filter_map(|executor| executor["members"].as_array());
    assert_eq!(
        shared.map(Vec::len).max(),
        Some(5),
        "four sonars and the encoders"
    );
}

/// Names that mean something to XML, DOT or Mermaid, and names in other scripts.
#[test]
fn a_graph_of_odd_names_stays_what_it_is() {
    let application = Application::new()
        .with(&Member::new("카메라", "counter"))
        .with_profile(&Member::new("plain", "recorder"))
        .with_reference("an &quot;odd|{one}&lt;", "plain.xml")
        .connect("data", "카메라.output", "an &quot;odd|{one}&lt;.input");
    let file = application.profile().display().to_string();
    let draw = |format: &str| {
        let finished = steadfast(&["graph", &file, "--format", format]);
        assert_eq!(finished.code, Some(0), "{finished}");
        finished.stdout
    };
    let svg = draw("svg");
    assert!(is_xml(&svg) && svg.contains("카메라"), "{svg}");
    assert!(svg.contains("an &quot;odd|{one}&lt;"), "{svg}");
    let dot = draw("dot");
    assert!(dot.contains(r#"an\ \"odd\|\{one\}\<"#), "{dot}");
    let mermaid = draw("mermaid");
    assert!(mermaid.contains("an #quot;odd|{one}#lt;"), "{mermaid}");
}
