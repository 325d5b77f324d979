//! Faults of the world, with the reference robot.

use tests::{Application, Outcome, repository};

/// What goes wrong, by which rules it is seen, and what comes of it.
struct Case {
    injection: &'static str,
    rules: &'static str,
    kind: &'static str,
    component: &'static str,
    actions: &'static [&'static str],
}

/// A model of the left wheels: they turn as commanded.
const LEFT_DRIVE: &str = "<monitor name='left_drive'><process_model model='left_drive.xml' \
    method='window' window='180' threshold='0.07' severity='emergency'>\
    <input component='motor_driver' port='command'/>\
    <output component='wheel_encoders' port='odometry' field='left'/></process_model></monitor>\
    <component name='motor_driver'><port name='command'>\
    <freshness max_age='200' safe_value='0'/></port><actuator stop_category='1'/></component>";

const CASES: [Case; 4] = [
    Case {
        injection: "component='left_sonar' fault='unplug_sonar'",
        rules: "<component name='left_sonar'><port name='range'><validity field='distance' \
                severity='stop'><min>0.03</min><max>3</max></validity></port></component>",
        kind: "out_of_range",
        component: "left_sonar",
        actions: &["stop left_sonar: done"],
    },
    Case {
        injection: "fault='motor_driver_off' side='left'",
        rules: LEFT_DRIVE,
        kind: "process_model",
        component: "motor_driver",
        actions: &["emergency stop: done"],
    },
    Case {
        injection: "fault='encoder_dead' side='left'",
        rules: LEFT_DRIVE,
        kind: "process_model",
        component: "motor_driver",
        actions: &["emergency stop: done"],
    },
    // Pictures come as before; that nothing is to be seen in twenty of them is all that shows.
    Case {
        injection: "fault='camera_smoke' density='1'",
        rules: "<component name='object_detector'><port name='object'>\
                <stuck count='20' severity='stop'/></port></component>",
        kind: "stuck",
        component: "object_detector",
        actions: &["stop object_detector: done"],
    },
];

/// In this drive the target stays in sight for longer than the runs below take.
const SEED: &str = "4";

fn run(rules: &str, injection: Option<&str>) -> Outcome {
    let application = Application::new();
    let scenario = repository().join("rules/scenarios/motor_driver_without_power");
    let model = std::fs::read(scenario.join("left_drive.xml")).expect("the model is shipped");
    application.write("left_drive.xml", model);
    let mut arguments = vec![
        "--clock".to_owned(),
        "simulated".to_owned(),
        "--for".to_owned(),
        "10s".to_owned(),
        "--seed".to_owned(),
        SEED.to_owned(),
    ];
    for (option, root, text) in [
        (
            "--rules",
            "fault_rules",
            (!rules.is_empty()).then(|| rules.to_owned()),
        ),
        (
            "--inject",
            "fault_injections",
            injection.map(|injection| format!("<inject at='2s' {injection}/>")),
        ),
    ] {
        let Some(text) = text else { continue };
        let text = format!("<{root} application='target_following'>{text}</{root}>");
        let file = application.write(&format!("{root}.xml"), text);
        arguments.extend([option.to_owned(), file.display().to_string()]);
    }
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let profile = repository().join("profiles/applications/target_following.xml");
    application.run_file(&profile, &arguments).ended_well()
}

#[test]
fn are_found_by_what_they_do_to_the_data() {
    for case in CASES {
        let outcome = run(case.rules, Some(case.injection));
        let verdicts = outcome.verdicts();
        assert_eq!(verdicts.len(), 1, "{}: {verdicts:?}", case.injection);
        let verdict = verdicts[0];
        assert_eq!(verdict["kind"], case.kind, "{}", case.injection);
        assert_eq!(verdict["component"], case.component, "{}", case.injection);
        assert!(verdict["first_symptom_ns"].as_u64() >= Some(2_000_000_000));
        assert_eq!(outcome.actions(), case.actions, "{}", case.injection);
    }
}

#[test]
fn none_of_those_rules_cries_wolf() {
    for case in CASES {
        let outcome = run(case.rules, None);
        assert!(outcome.verdicts().is_empty(), "{}", case.rules);
    }
}

/// The container knows nothing of sonars, motors and smoke.
#[test]
fn nobody_notices_them_without_a_rule() {
    for case in CASES {
        let outcome = run("", Some(case.injection));
        assert!(outcome.verdicts().is_empty(), "{}", case.injection);
        assert_eq!(
            outcome.summary()["applications"]["target_following"]["state"],
            "ACTIVE"
        );
    }
}
