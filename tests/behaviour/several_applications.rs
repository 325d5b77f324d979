//! Several applications in one container: told apart by name, each with its own rules.

use tests::{Application, Member, repository};

use crate::visual_servoing::tracked_on;

/// An application of a counter and a recorder, under a name of its own.
fn named(name: &str, rest: &str) -> Application {
    let application = Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .connect("data", "counter.output", "recorder.input")
        .element(rest);
    let text = std::fs::read_to_string(application.profile()).expect("it was written");
    application.write(
        "application.xml",
        text.replace("<name>application</name>", &format!("<name>{name}</name>")),
    );
    application
}

fn file_of(application: &Application) -> std::path::PathBuf {
    application.folder().join("application.xml")
}

const SIMULATED: [&str; 4] = ["--clock", "simulated", "--for", "1s"];

#[test]
fn components_are_told_apart_and_connected_within_their_application() {
    let (one, other) = (named("one", ""), named("other", ""));
    let outcome = one
        .run_together(&[file_of(&one), file_of(&other)], &SIMULATED)
        .ended_well();
    for name in ["one/recorder", "other/recorder"] {
        assert_eq!(outcome.logs(name), ["received 100, last 100, gaps 0"]);
    }
    let started = outcome.all_events().iter();
    let started: Vec<_> = started
        .filter(|event| event["event"] == "run_started")
        .map(|event| (event["application"].clone(), event["components"].clone()))
        .collect();
    assert_eq!(
        started,
        [("one".into(), 2.into()), ("other".into(), 2.into())]
    );
    for name in ["one", "other"] {
        assert_eq!(outcome.summary()["applications"][name]["state"], "ACTIVE");
    }
}

#[test]
fn rules_and_injections_go_to_the_application_that_they_name() {
    let (one, other) = (named("one", ""), named("other", ""));
    let argument = |name: &str, text: &str| one.write(name, text).display().to_string();
    let rules = argument(
        "rules.xml",
        "<fault_rules application='other'>
           <component name='counter'><severity>ignore</severity></component>
         </fault_rules>",
    );
    let inject = |name: &str| {
        argument(
            &format!("inject_{name}.xml"),
            &format!(
                "<fault_injections application='{name}'>
                   <inject at_cycle='50' component='counter' fault='panic'/>
                 </fault_injections>"
            ),
        )
    };
    let (into_one, into_other) = (inject("one"), inject("other"));
    let files = [
        "--rules",
        &rules,
        "--inject",
        &into_one,
        "--inject",
        &into_other,
    ];
    let outcome = one
        .run_together(
            &[file_of(&one), file_of(&other)],
            &[&SIMULATED[..], &files].concat(),
        )
        .ended_well();
    assert_eq!(outcome.component("one/counter")["incarnation"], 2);
    assert_eq!(outcome.component("one/counter")["state"], "ACTIVE");
    assert_eq!(outcome.component("other/counter")["state"], "ERROR");
    assert_eq!(outcome.cycles("other/counter"), 49);
    assert_eq!(outcome.summary()["applications"]["one"]["state"], "ACTIVE");
    assert_eq!(
        outcome.summary()["applications"]["other"]["state"],
        "DEGRADED"
    );
}

#[test]
fn problems_of_all_files_are_listed_together() {
    let (one, other) = (named("one", "<wrld/>"), named("other", ""));
    other.write("counter.xml", "<component_profile>");
    let rules = one.write("rules.xml", "<fault_rules application='third'/>");
    let rules = rules.display().to_string();
    let arguments = [&SIMULATED[..], &["--rules", &rules]].concat();
    let outcome = one.run_together(&[file_of(&one), file_of(&other)], &arguments);
    outcome.was_refused(
        1,
        &[
            "counter.xml",
            "not well-formed",
            "third",
            "were not started",
        ],
    );
}

#[test]
fn what_cannot_be_in_one_container_is_refused() {
    let one = named("one", "");
    let outcome = one.run_together(&[file_of(&one), file_of(&one)], &SIMULATED);
    outcome.was_refused(1, &["called `one`, too"]);
    let (one, other) = (in_a_world("one"), in_a_world("other"));
    let supervised = ["--supervised", "--clock", "real", "--for", "1s"];
    let outcome = one.run_together(&[file_of(&one), file_of(&other)], &supervised);
    outcome.was_refused(1, &["keeps one world alive"]);
}

/// A robot in a world of its own that drives towards its target, and counts.
fn in_a_world(name: &str) -> Application {
    let root = repository();
    let application = named(name, "<world><reference>arena.xml</reference></world>");
    let world = std::fs::read(root.join("profiles/worlds/target_arena.xml")).expect("a world");
    application.write("arena.xml", world);
    application
}

/// Each application opens devices in its own world, or in the one that it shares; each world has
/// arenas of its own, and goes the same way in each run.
#[test]
fn applications_drive_in_worlds_of_their_own() {
    let shipped = |name: &str| {
        let file = repository().join("profiles/applications").join(name);
        std::fs::read_to_string(file).expect("a shipped application")
    };
    let run = Application::new();
    let folder = repository().join("profiles");
    let world = std::fs::read_to_string(folder.join("worlds/servoing_arena.xml")).expect("a world");
    run.write("near.xml", world);
    let robot = |name: &str, world: &str| {
        let text = shipped("visual_servoing.xml");
        let text = text.replace(
            "<name>visual_servoing</name>",
            &format!("<name>{name}</name>"),
        );
        run.write(
            &format!("{name}.xml"),
            text.replace("servoing_arena.xml", world),
        )
    };
    let files = [robot("one", "servoing_arena.xml"), robot("two", "near.xml")];
    let search = |folder: &str| repository().join(folder).display().to_string();
    let (components, worlds) = (search("profiles/components"), search("profiles/worlds"));
    let picture = run.folder().join("drive.svg").display().to_string();
    let smoke = run.write(
        "smoke.xml",
        "<fault_injections application='two'>
           <inject at='500ms' fault='camera_smoke' density='1'/>
         </fault_injections>",
    );
    let smoke = smoke.display().to_string();
    let file = run.folder().join("run.mcap");
    let recording = file.display().to_string();
    let arguments = [
        &SIMULATED[..],
        &["--search-path", &components, "--search-path", &worlds],
        &["--picture", &picture, "--inject", &smoke],
        &["--record", &recording],
    ]
    .concat();
    let drive = || run.run_together(&files, &arguments).ended_well();
    let outcome = drive();
    let summary = outcome.summary();
    let robots = &summary["robots"];
    assert_eq!(summary["robot"], robots["one"], "{summary:#}");
    assert_ne!(robots["one"], robots["two"], "{summary:#}");
    let pictures = ["drive.svg", "drive-two.svg"].map(|name| {
        let file = run.folder().join(name);
        std::fs::read_to_string(file).expect("a picture of each drive")
    });
    assert_ne!(pictures[0], pictures[1]);
    for (name, in_smoke) in [("one", false), ("two", true)] {
        let tracked = tracked_on(&file, &format!("/{name}/ssd_tracker/target"));
        assert!(tracked.len() >= 9, "{name}: {}", tracked.len());
        let last = tracked.last().expect("pictures are tracked");
        assert_eq!(last.error > 40.0, in_smoke, "{name}: {}", last.error);
    }
    let again = drive();
    assert_eq!(again.summary()["robots"], *robots);
    assert!(again.raw_events() == outcome.raw_events());
}

/// The run is over when the robot of each world has reached its target.
#[test]
fn a_run_in_several_worlds_ends_when_all_have_arrived() {
    let run = Application::new();
    let shipped = |name: &str| {
        let file = repository().join("profiles").join(name);
        std::fs::read_to_string(file).expect("a shipped file")
    };
    run.write("other.xml", shipped("worlds/target_arena.xml"));
    let text = shipped("applications/target_following.xml");
    let robot = |name: &str, world: &str| {
        let named = format!("<name>{name}</name>");
        let text = text.replace("<name>target_following</name>", &named);
        run.write(
            &format!("{name}.xml"),
            text.replace("target_arena.xml", world),
        )
    };
    let files = [robot("one", "target_arena.xml"), robot("two", "other.xml")];
    let search = |folder: &str| repository().join(folder).display().to_string();
    let (components, worlds) = (search("profiles/components"), search("profiles/worlds"));
    let paths = ["--search-path", &components, "--search-path", &worlds];
    let simulated = ["--clock", "simulated", "--for", "300s"];
    let outcome = run.run_together(&files, &[&simulated[..], &paths].concat());
    let outcome = outcome.ended_well();
    let reached = outcome.all_events().iter();
    let reached = reached.filter(|event| event["event"] == "target_reached");
    let mut arrived: Vec<&str> = reached
        .filter_map(|event| event["application"].as_str())
        .collect();
    arrived.sort_unstable();
    assert_eq!(arrived, ["one", "two"]);
    for name in arrived {
        assert_eq!(outcome.summary()["robots"][name]["reached"], true, "{name}");
        let application = &outcome.summary()["applications"][name];
        assert_eq!(application["ended_by"], "target_reached", "{name}");
    }
}
