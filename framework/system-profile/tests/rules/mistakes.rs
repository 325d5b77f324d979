//! What each mistake is called; and that no file, however damaged, makes the reader panic.

use proptest::prelude::*;
use system_profile::{Document, LoadOptions, check_file, read_profile};

use crate::project::{PERIODIC, Project, of, profile};

const ALL_MISTAKES: &str = include_str!("../data/all_mistakes.xml");
const EXPECTED: &str = include_str!("../data/all_mistakes.txt");

#[test]
fn all_mistakes_are_reported_at_once() {
    let project = Project::new();
    let path = project.write("rules/all_mistakes.xml", ALL_MISTAKES);
    let found = project.check(&path).join("\n");
    assert!(found == EXPECTED.trim_end(), "{found}");
}

#[test]
fn mistakes_in_inline_rules() {
    let project = Project::new();
    let path = project.write(
        "components/sonar.xml",
        &profile(
            "sonar",
            PERIODIC,
            "<event_port><name>alarm</name><usage>output</usage><stuck count='3'/></event_port>",
            "<watchdog deadlne='10'/>",
        ),
    );
    assert_eq!(
        project.check(&path),
        [
            "4: warning: unknown attribute deadlne in <watchdog>",
            "5: a stuck value of the port alarm, which is an output event port",
        ]
    );
}

#[test]
fn copies_that_do_not_outlive_the_container_have_no_greatest_age() {
    let project = Project::new();
    let rule = "<resurrect><reset>true</reset><backup max_age='1min'>40</backup></resurrect>";
    let loaded = project.load(&[&of("motor", rule)]);
    assert_eq!(
        loaded.problems,
        ["r0:1: a greatest age of copies that do not outlive the container"]
    );
}

#[test]
fn two_rule_files_must_not_contradict_each_other() {
    let project = Project::new();
    let watchdog = |deadline: &str| of("motor", &format!("<watchdog deadline='{deadline}'/>"));
    project.load(&[&watchdog("60"), &watchdog("0.06s")]).sound();
    let loaded = project.load(&[&watchdog("60"), &watchdog("70")]);
    assert!(loaded.rules.is_none());
    assert_eq!(
        loaded.problems,
        ["r1:1: this <watchdog> contradicts the one at /rules/r0.xml:1:60"]
    );
    let secondary = |reference: &str| {
        let text =
            format!("<fault><secondary><reference>{reference}</reference></secondary></fault>");
        of("avoidance", &text)
    };
    let loaded = project.load(&[&secondary("simple.xml"), &of("avoidance", "<fault/>")]);
    assert_eq!(
        loaded.problems,
        ["r1:1: this list of secondaries contradicts the one at /rules/r0.xml:1:64"]
    );
}

#[test]
fn a_standby_is_one_that_can_take_over() {
    let project = Project::new();
    for (rule, expected) in [
        ("<standby preload='loaded'/>", None),
        ("<standby/>", Some("<standby> has no preload")),
        (
            "<standby preload='hot'/>",
            Some("`hot` in attribute preload of <standby> is not understood"),
        ),
        (
            "<standby preload='warm'/><resurrect><reset>false</reset></resurrect>",
            Some("a standby of `motor`, which is never reset"),
        ),
        (
            "<standby preload='warm'/><fault retry_max='0'/>",
            Some("a standby of `motor`, which is never reset"),
        ),
    ] {
        let problems = project.load(&[&of("motor", rule)]).problems;
        let expected = expected.map(|text| format!("r0:1: {text}"));
        assert_eq!(problems, Vec::from_iter(expected), "{rule}");
    }
    let standby = |preload: &str| of("motor", &format!("<standby preload='{preload}'/>"));
    let loaded = project.load(&[&standby("warm"), &standby("loaded")]);
    let told = loaded.problems.concat();
    assert!(
        told.contains("this <standby> contradicts the one at"),
        "{told}"
    );
}

#[test]
fn a_rule_file_without_its_application_is_checked_alone() {
    let project = Project::new();
    let path = project.write("rules/x.xml", "<fault_rules application='patrl'/>");
    assert_eq!(
        project.check(&path),
        [
            "1: warning: there is no application `patrl` (patrl.xml); only this file alone was checked"
        ]
    );
    let path = project.write("rules/x.xml", "<fault_rules/>");
    assert_eq!(
        project.check(&path),
        ["1: <fault_rules> has no application"]
    );
    let loaded = project.load_files(&[path]);
    assert!(loaded.rules.is_none());
}

#[test]
fn rules_of_another_application_and_no_rules_at_all() {
    let project = Project::new();
    let other = project.write("rules/x.xml", "<fault_rules application='mapping'/>");
    let none = project.write(
        "rules/y.xml",
        "<package_profile><name>y</name><subcomponents/>\
        <port_connections/></package_profile>",
    );
    assert_eq!(
        project.load_files(&[other, none]).problems,
        [
            "x:1: these are rules of `mapping`, not of `patrol`",
            "y:1: <package_profile> holds no rules",
        ]
    );
}

#[test]
fn too_many_rules_are_refused() {
    let many = "<component/>".repeat(20_001);
    let text = format!("<fault_rules application='a'>{many}</fault_rules>");
    let document = Document::from_bytes("r.xml", text.as_bytes());
    assert!(read_profile(&document).is_none());
    assert_eq!(document.problems().len(), 1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_damaged_rule_file_never_panics(
        cut in 0..ALL_MISTAKES.len(),
        edits in prop::collection::vec((0..ALL_MISTAKES.len(), any::<u8>()), 0..6),
        swaps in prop::collection::vec((0..110_usize, 0..110_usize), 0..6),
    ) {
        let project = Project::new();
        let mut lines: Vec<&str> = ALL_MISTAKES.lines().collect();
        for (a, b) in swaps {
            let count = lines.len();
            lines.swap(a % count, b % count);
        }
        let mut bytes = lines.join("\n").into_bytes();
        project.write("rules/swapped.xml", std::str::from_utf8(&bytes).unwrap());
        check_file(&project.folder.path().join("rules/swapped.xml"), &LoadOptions::default());
        let count = bytes.len();
        for (at, byte) in edits {
            bytes[at % count] = byte;
        }
        for part in [&bytes[..], &bytes[..cut.min(count)], &bytes[cut.min(count)..]] {
            let path = project.folder.path().join("rules/damaged.xml");
            std::fs::write(&path, part).unwrap();
            check_file(&path, &LoadOptions::default());
        }
    }
}
