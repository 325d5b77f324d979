//! Several applications in one container: told apart by name, each with its own rules.

use tests::{Application, Member};

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
    let world = tests::repository().join("profiles/worlds/target_arena.xml");
    let world = std::fs::read(world).expect("it can be read");
    let in_a_world = |name: &str| {
        let application = named(name, "<world><reference>arena.xml</reference></world>");
        application.write("arena.xml", &world);
        application
    };
    let (one, other) = (in_a_world("one"), in_a_world("other"));
    let outcome = one.run_together(&[file_of(&one), file_of(&other)], &SIMULATED);
    outcome.was_refused(1, &["'one' drives in", "'other' in"]);
}
