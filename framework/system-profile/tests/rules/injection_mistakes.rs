//! What each mistake in an injection is called.

use system_model::injection::MAX_INJECTIONS;

use crate::project::Project;

/// Attributes of an injection and what is wrong with them.
const MISTAKES: [(&str, &[&str]); 43] = [
    ("", &["<inject> has no fault"]),
    (
        "component='motor' fault='panik'",
        &["there is no fault `panik` to inject"],
    ),
    ("fault='panic'", &["`panic` of which component?"]),
    (
        "fault='stuck' port='range'",
        &["`stuck` of which component?"],
    ),
    (
        "fault='recovery_fails'",
        &["`recovery_fails` of which component?"],
    ),
    (
        "component='frnt' fault='panic'",
        &["there is no component `frnt`"],
    ),
    (
        "component='front' fault='stuck' port='rang'",
        &["`front` has no port `rang`"],
    ),
    (
        "component='front' fault='stuck' port='alarm'",
        &["`stuck` of the port alarm, which is an output event port"],
    ),
    ("component='front' fault='stuck'", &["`stuck` needs port"]),
    (
        "component='front' fault='offset' port='range'",
        &["`offset` needs value"],
    ),
    (
        "component='front' fault='out_of_range' port='range' value='high'",
        &["`high` in attribute value of <inject> is no number"],
    ),
    (
        "component='front' fault='drift' port='range' per_scond='1'",
        &[
            "`drift` needs per_second",
            "warning: unknown attribute per_scond in <inject>",
        ],
    ),
    (
        "component='front' fault='noise' port='range' deviation='-1'",
        &["`-1` in attribute deviation of <inject> is not larger than 0"],
    ),
    (
        "component='front' fault='delay' port='range' duration='-80ms'",
        &["`-80ms` in attribute duration of <inject> is no time from 0 to a week"],
    ),
    (
        "component='front' fault='drop' port='range' field='distance'",
        &["warning: unknown attribute field in <inject>"],
    ),
    ("component='motor' fault='slow'", &["`slow` needs duration"]),
    (
        "component='motor' fault='slow' duration='0'",
        &["`0` in attribute duration of <inject> is no time at all"],
    ),
    ("component='motor' fault='leak'", &["`leak` needs bytes"]),
    (
        "component='motor' fault='leak' bytes='-1'",
        &["`-1` in attribute bytes of <inject> is no number"],
    ),
    (
        "component='motor' fault='leak' bytes='0'",
        &["a leak of nothing"],
    ),
    (
        "component='motor' fault='error_return'",
        &["`error_return` needs code"],
    ),
    (
        "component='motor' fault='error_return' code='200'",
        &["200 is no error"],
    ),
    (
        "component='motor' fault='exit' code='256'",
        &["`256` in attribute code of <inject> is no number"],
    ),
    (
        "component='motor' fault='panic' callback='onExcute'",
        &["`onExcute` in attribute callback of <inject> is not understood"],
    ),
    (
        "component='map' fault='panic'",
        &["this callback of `map` is never called: it is passive"],
    ),
    (
        "component='motor' fault='panic' callback='onEvent'",
        &["this callback of `motor` is never called: it has no input event port"],
    ),
    ("fault='unplug_sonar'", &["`unplug_sonar` needs index"]),
    (
        "fault='unplug_sonar' index='4'",
        &["the board has no socket 4"],
    ),
    (
        "fault='unplug_sonar' component='motor'",
        &["`motor` has no property index that names a sonar's socket"],
    ),
    (
        "fault='motor_driver_off'",
        &["`motor_driver_off` needs side"],
    ),
    (
        "fault='encoder_dead' side='middle'",
        &["`middle` in attribute side of <inject> is not understood"],
    ),
    ("fault='camera_smoke'", &["`camera_smoke` needs density"]),
    (
        "fault='camera_smoke' density='1.2'",
        &["smoke has a density from 0 to 1"],
    ),
    (
        "component='motor' fault='panic' at='5s' at_cycle='2'",
        &["both at and at_cycle say when it begins"],
    ),
    (
        "component='motor' fault='panic' at='-5s' for='0s' probability='1.5' repeat='0'",
        &[
            "`-5s` in attribute at of <inject> is no time from 0 to a week",
            "`0s` in attribute for of <inject> is no time at all",
            "`1.5` in attribute probability of <inject> is no probability",
            "`0` in attribute repeat of <inject> is too few",
        ],
    ),
    (
        "component='motor' fault='panic' at_cycle='0'",
        &["`0` in attribute at_cycle of <inject> is no cycle"],
    ),
    (
        "fault='camera_smoke' density='1' at_cycle='9'",
        &["at_cycle does not say whose cycles it counts"],
    ),
    (
        "component='map' fault='library_missing' at_cycle='9'",
        &["a passive component has no cycles"],
    ),
    (
        "component='motor' fault='panic' repeat='3'",
        &["repeat does not say how far apart"],
    ),
    (
        "component='motor' fault='panic' at_cycle='3' every='1s'",
        &["attribute every of <inject> does not fit when it begins"],
    ),
    (
        "component='motor' fault='panic' every_cycles='3'",
        &["attribute every_cycles of <inject> does not fit when it begins"],
    ),
    (
        "component='motor' fault='slow' duration='9ms' every='1s'",
        &["it stays for ever and cannot begin again"],
    ),
    (
        "component='motor' fault='recovery_fails' probability='0.5'",
        &["a probability is one of each call or each datum, and this fault has neither"],
    ),
];

#[test]
fn every_mistake_has_a_name() {
    let project = Project::new();
    project.in_a_world();
    for (attributes, expected) in MISTAKES {
        let (injections, problems) = project.inject(&format!("<inject {attributes}/>"));
        assert_eq!(problems, expected, "{attributes}");
        let only_warnings = expected.iter().all(|text| text.starts_with("warning"));
        assert_eq!(injections.is_some(), only_warnings, "{attributes}");
    }
}

#[test]
fn all_mistakes_of_a_file_are_reported_at_once() {
    let project = Project::new();
    project.in_a_world();
    let mistakes = MISTAKES.iter();
    let text = mistakes.map(|(attributes, _)| format!("<inject {attributes}/>\n"));
    let (_, problems) = project.inject(&text.collect::<String>());
    let expected = MISTAKES.iter().map(|(_, problems)| problems.len());
    assert_eq!(problems.len(), expected.sum::<usize>());
}

#[test]
fn a_robot_without_a_world_has_no_world_to_break() {
    let (injections, problems) =
        Project::new().inject("<inject fault='motor_driver_off' side='left'/>");
    assert_eq!(
        problems,
        ["the application `patrol` drives in no simulated world"]
    );
    assert!(injections.is_none());
}

#[test]
fn files_about_something_else() {
    let project = Project::new();
    for (text, expected) in [
        (
            "<fault_injections application='mapping'/>",
            "1: warning: there is no application `mapping` (mapping.xml); only this file alone \
             was checked",
        ),
        (
            "<fault_injections/>",
            "1: <fault_injections> has no application",
        ),
        (
            "<fault_injections application='patrol'><injct/></fault_injections>",
            "1: warning: unknown element <injct> in <fault_injections>",
        ),
    ] {
        let path = project.write("rules/x.xml", text);
        assert_eq!(project.check(&path), [expected]);
    }
    let path = project.write("rules/x.xml", "<fault_injections application='mapping'/>");
    let outcome = system_profile::load_injections(&project.specification(), &path);
    assert!(outcome.injections.is_none());
    assert_eq!(
        outcome.problems[0].message,
        "these are injections into `mapping`, not into `patrol`"
    );
}

#[test]
fn too_many_injections_are_refused() {
    let many = "<inject component='motor' fault='panic'/>".repeat(MAX_INJECTIONS + 1);
    let (injections, problems) = Project::new().inject(&many);
    assert!(injections.is_none());
    assert_eq!(problems, ["2001 injections; at most 2000 are read"]);
}
