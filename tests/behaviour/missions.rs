//! Behaviour trees over components: they act, they fail as anything may, and they are seen.

use serde_json::Value;
use tests::{Application, Member, Outcome, repository};

/// An application with a tree in it.
fn with_tree(attributes: &str, tree: &str) -> Application {
    let application = Application::new()
        .with(&Member::new("first", "counter"))
        .with(&Member::new("second", "counter"))
        .element(&format!(
            "<tree name='mission' file='tree.xml' {attributes}/>"
        ));
    application.write(
        "tree.xml",
        format!("<root BTCPP_format='4'><BehaviorTree ID='Mission'>{tree}</BehaviorTree></root>"),
    );
    application
}

/// The states that a tree went through.
fn phases(outcome: &Outcome) -> Vec<&str> {
    let events = outcome.all_events().iter();
    let states = events.filter(|event| event["event"] == "tree_state");
    states.filter_map(|event| event["to"].as_str()).collect()
}

fn kinds(outcome: &Outcome) -> Vec<(&str, &str)> {
    let text = |verdict: &'_ Value, key: &str| verdict[key].as_str().map(str::to_owned);
    let mut kinds = Vec::new();
    for verdict in outcome.verdicts() {
        if let (Some(_), Some(_)) = (text(verdict, "component"), text(verdict, "kind")) {
            let pair = (
                verdict["component"].as_str().unwrap_or_default(),
                verdict["kind"].as_str().unwrap_or_default(),
            );
            if !kinds.contains(&pair) {
                kinds.push(pair);
            }
        }
    }
    kinds
}

#[test]
fn components_are_stopped_and_started_by_a_tree() {
    let tree = "<Sequence><StopComponent component='first'/>\
                <ComponentInState component='first' state='INACTIVE'/>\
                <Sleep msec='300'/><StartComponent component='first'/>\
                <ComponentWorks component='first'/><ResetComponent component='second'/></Sequence>";
    let outcome = with_tree("", tree).simulate("2s").ended_well();
    assert_eq!(phases(&outcome), ["running", "success"]);
    assert_eq!(outcome.component("first")["state"], "ACTIVE");
    assert_eq!(outcome.component("second")["incarnation"], 2);
    let orders: Vec<&Value> = outcome.verdicts();
    assert!(
        orders
            .iter()
            .all(|it| it["evidence"]["order"]["by"] == "mission")
    );
    let again = with_tree("", tree).simulate("2s").ended_well();
    assert_eq!(outcome.raw_events(), again.raw_events());
}

#[test]
fn it_does_so_in_real_time() {
    let tree = "<Sequence><StopComponent component='first'/>\
                <StartComponent component='first'/></Sequence>";
    let outcome = with_tree("tick_ms='10' tick_deadline_ms='10'", tree).run_really("2s");
    let outcome = outcome.ended_well();
    assert_eq!(phases(&outcome), ["running", "success"]);
}

/// A script without meaning at run time, and a loop that never ends a tick.
#[test]
fn a_tree_that_fails_is_a_fault_and_ends_in_the_safe_state() {
    for (tree, kind) in [
        ("<ScriptCondition code=\"x &lt; 'a'\"/>", "tree_error"),
        (
            "<Repeat num_cycles='-1'><AlwaysSuccess/></Repeat>",
            "tick_overrun",
        ),
    ] {
        let outcome = with_tree("", tree).simulate("1s").ended_well();
        assert_eq!(kinds(&outcome), [("mission", kind)]);
        assert_eq!(phases(&outcome), ["running", "failed"]);
        assert!(
            outcome
                .actions()
                .contains(&"emergency stop: done".to_owned())
        );
        let outcome = with_tree("severity='ignore'", tree).simulate("1s");
        assert_eq!(outcome.ended_well().actions(), Vec::<String>::new());
        let outcome = with_tree("severity='stop'", tree)
            .simulate("1s")
            .ended_well();
        assert_eq!(phases(&outcome), ["running", "failed", "stopped"]);
        let outcome = with_tree("severity='reset'", tree)
            .simulate("1s")
            .ended_well();
        let phases = phases(&outcome);
        assert_eq!(phases, ["running", "failed", "running", "failed"]);
        assert_eq!(
            outcome.actions().last().map(String::as_str),
            Some("emergency stop: done")
        );
    }
}

/// The first crash is reset, the second is the tree's.
const CRASHES: &str = "<inject at_cycle='20' component='first' fault='panic'/>\
                       <inject at_cycle='60' component='first' fault='panic'/>";

fn handled(tree: &str, deadline: &str) -> Outcome {
    let rules = format!(
        "<component name='first'><resurrect><reset>true</reset></resurrect>\
         <fault window='10s'><retry_max>1</retry_max><severity>ignore</severity></fault>\
         <handle tree='mission' deadline='{deadline}'/></component>"
    );
    let application = with_tree("starts='by_fault'", tree).rules(&rules);
    application.injections(CRASHES).simulate("4s").ended_well()
}

#[test]
fn a_fault_rule_begins_a_tree_and_its_outcome_is_that_of_the_rung() {
    let outcome = handled("<ResetComponent component='first'/>", "1s");
    assert_eq!(phases(&outcome), ["running", "success"]);
    let actions = outcome.actions();
    let expected = [
        "reset first: done",
        "handle first by tree mission: done",
        "reset first: done",
    ];
    assert_eq!(actions, expected);
    assert_eq!(outcome.component("first")["state"], "ACTIVE");
    for (tree, word) in [
        ("<AlwaysFailure/>", "failed"),
        ("<Sleep msec='9999'/>", "overdue"),
    ] {
        let outcome = handled(tree, "500ms");
        let handled = format!("handle first by tree mission: {word}");
        assert_eq!(
            outcome.actions()[1..],
            [handled, "stop first: done".to_owned()]
        );
    }
}

#[test]
fn a_tree_sees_reports_and_clears_faults() {
    let tree = "<Sequence><Inverter><FaultPresent component='first'/></Inverter>\
                <RaiseFault component='first' message='too warm'/>\
                <AwaitFault component='first' kind='reported' timeout_ms='1000'/>\
                <ClearFault component='first'/>\
                <Inverter><FaultPresent component='first'/></Inverter></Sequence>";
    let application = with_tree("", tree).not_recovered(&["first"]);
    let outcome = application.simulate("1s").ended_well();
    assert_eq!(phases(&outcome), ["running", "success"]);
    assert_eq!(kinds(&outcome), [("first", "reported")]);
}

/// A method is asked for in one tick and answered in a later one, in either kind of time.
#[test]
fn a_tree_calls_a_service() {
    let tree = "<Sequence><CallService component='adder' port='arithmetic' method='double' \
                value='20' reply='{twice}'/><ScriptCondition code=\"twice == 40\"/></Sequence>";
    let application = || {
        let adder = Member::new("adder", "adder").kind("passive");
        let application = Application::new()
            .with(&adder)
            .element("<tree name='mission' file='tree.xml'/>");
        let text = format!(
            "<root BTCPP_format='4'><BehaviorTree ID='Mission'>{tree}</BehaviorTree></root>"
        );
        application.write("tree.xml", text);
        application
    };
    let outcome = application().simulate("1s").ended_well();
    assert_eq!(phases(&outcome), ["running", "success"]);
    let outcome = application().run_really("1s").ended_well();
    assert_eq!(phases(&outcome), ["running", "success"]);
}

/// Smoke comes, and a sonar is unplugged: rules and injections of the shipped mission.
fn inspection(seed: u64) -> Outcome {
    let scenario = repository().join("rules/scenarios/inspection");
    let file = |name: &str| scenario.join(name).display().to_string();
    let seed = seed.to_string();
    let profile = repository().join("profiles/applications/inspection.xml");
    let arguments = [
        "--rules",
        &file("rules.xml"),
        "--inject",
        &file("injections.xml"),
        "--clock",
        "simulated",
        "--for",
        "200s",
        "--seed",
        &seed,
    ];
    let outcome = Application::new().run_together(&[profile], &arguments);
    outcome.ended_well()
}

/// The states of a node that has a name of its own, in the order of time.
fn states<'a>(outcome: &'a Outcome, name: &str) -> Vec<(u64, &'a str)> {
    let events = outcome.all_events().iter();
    let events = events.filter(|event| event["event"] == "tree_nodes");
    let mut states = Vec::new();
    for event in events {
        let nodes = event["nodes"].as_array().into_iter().flatten();
        for node in nodes {
            let path = node[0].as_str().unwrap_or_default();
            if path.rsplit('/').next() == Some(name) {
                let time = event["t_ns"].as_u64().unwrap_or_default();
                states.push((time, node[1].as_str().unwrap_or_default()));
            }
        }
    }
    states
}

#[track_caller]
fn began(outcome: &Outcome, name: &str, context: &str) -> u64 {
    let states = states(outcome, name);
    let mut running = states.iter().filter(|(_, state)| *state == "RUNNING");
    running
        .next()
        .unwrap_or_else(|| panic!("{name} never began: {context}"))
        .0
}

/// Search, approach, inspect, return; the Decider swaps the detector when smoke has come, the Reactor
/// mends the sonar, and the robot comes home in one piece.
#[test]
fn the_inspection_ends_as_told() {
    for seed in 1..=20 {
        let context = format!("seed {seed}");
        let outcome = inspection(seed);
        assert_eq!(phases(&outcome), ["running", "success"], "{context}");
        let steps = ["search", "approach", "inspect", "return"];
        let times = steps.map(|step| began(&outcome, step, &context));
        assert!(times.is_sorted(), "{context}: {times:?}");
        let smoke_ns = 4_000_000_000;
        assert!(
            began(&outcome, "through_smoke", &context) > smoke_ns,
            "{context}"
        );
        let unplugged_ns = 20_000_000_000;
        let mended = began(&outcome, "mending", &context);
        assert!(
            (unplugged_ns..unplugged_ns + 1_000_000_000).contains(&mended),
            "{context}"
        );
        assert!(
            outcome.component("smoke_detector")["incarnation"] != 1,
            "{context}"
        );
        assert_eq!(
            outcome.component("front_sonar")["state"],
            "INACTIVE",
            "{context}"
        );
        assert_eq!(outcome.summary()["robot"]["collisions"], 0, "{context}");
    }
}
