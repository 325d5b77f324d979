//! Behaviour trees over components: they act, they fail as anything may, and they are seen.

use serde_json::Value;
use tests::{Application, Member, Outcome};

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
