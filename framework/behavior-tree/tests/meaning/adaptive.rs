//! Module, Decider and Reactor: the two state diagrams of ReFRESH edge by edge, ranking, and what its
//! code did wrong.

use behavior_tree::Value;

use crate::harness::Trial;

/// A Module with an estimator that expects these costs. Its evaluator says at the beginning of each
/// run that there is something to do, and after one that succeeds that it was done well.
fn module(executor: &str, performance: f64, resource: f64) -> String {
    let key = executor.to_lowercase();
    let failures = executor.matches('F').count();
    let evaluator = match executor.ends_with('S') {
        true => format!("{}FS", "F".repeat(failures)),
        false => "F".to_owned(),
    };
    format!(
        "(ReFRESH_Module performance_cost={{p{key}}} resource_cost={{r{key}}} {executor} \
         {evaluator}<_onSuccess=\"p{key} := 0.5; r{key} := 0.5\"> \
         S<_onSuccess=\"p{key} := {performance}; r{key} := {resource}\">)"
    )
}

fn decider(children: &[String]) -> String {
    let children = children.join(" ");
    format!("(ReFRESH_Decider performance_weight=0.5 resource_weight=0.5 {children})")
}

fn reactor(children: &[String]) -> String {
    decider(children).replace("Decider", "Reactor")
}

/// A Module of executor, evaluator, estimator; its answers, and the ticks and halts of the three.
type Row = (&'static str, &'static str, [u32; 3], [u32; 3]);

#[test]
fn every_edge_of_the_module_is_as_drawn() {
    let rows: [Row; 13] = [
        // Estimator -> FAILURE: it does not succeed, and running is not allowed to it.
        ("S S F", "F", [0, 0, 1], [0, 0, 0]),
        ("S S R", "F", [0, 0, 1], [0, 0, 1]),
        // Estimator -> Evaluator, Executor -> SUCCESS: there is nothing to do.
        ("R S S", "S", [0, 1, 1], [0, 0, 0]),
        // Evaluator, Executor -> the same: the executor runs.
        ("RR F S", "RR", [2, 1, 1], [0, 0, 0]),
        ("RR R S", "RR", [2, 2, 1], [0, 0, 0]),
        // -> SUCCESS: an evaluator that runs succeeds.
        ("R RRS S", "RRS", [3, 3, 1], [1, 0, 0]),
        // An evaluator that runs fails.
        ("R RF S", "RF", [2, 2, 1], [1, 0, 0]),
        // -> FAILURE: the executor fails.
        ("RF R S", "RF", [2, 1, 1], [0, 1, 0]),
        // -> Evaluator alone: the executor has succeeded; -> SUCCESS, -> FAILURE.
        ("RS FS S", "RS", [2, 2, 1], [0, 0, 0]),
        ("RS F S", "RF", [2, 2, 1], [0, 0, 0]),
        // Evaluator alone -> the same, as long as it runs.
        ("S FRS S", "RS", [1, 3, 1], [0, 0, 0]),
        ("S FRF S", "RF", [1, 3, 1], [0, 0, 0]),
        // It answers at once: asked again only when the executor has ended.
        ("RRRS FS S", "RRRS", [4, 2, 1], [0, 0, 0]),
    ];
    for (children, answers, ticks, halts) in rows {
        let mut trial = Trial::new(&format!("(ReFRESH_Module {children})"));
        assert_eq!(trial.answers(answers.len()), answers, "{children}");
        assert_eq!(trial.ticks(), ticks, "ticks of {children}");
        assert_eq!(trial.halts(), halts, "halts of {children}");
    }
}

#[test]
fn a_halt_leads_out_of_every_state_of_the_module() {
    for (children, halts) in [
        ("R R S", [1, 1, 0]),
        ("R F S", [1, 0, 0]),
        // In the state of the evaluator alone.
        ("S FR S", [0, 1, 0]),
    ] {
        let mut trial = Trial::new(&format!("(ReFRESH_Module {children})"));
        assert_eq!(trial.answers(1), "R", "{children}");
        trial.halt().expect("halting works");
        assert_eq!(trial.halts(), halts, "{children}");
        // And in again at the beginning.
        trial.tick();
        assert_eq!(trial.ticks()[2], 2, "{children}");
    }
}

#[test]
fn costs_that_reach_the_boundary_end_a_module() {
    let text = "(ReFRESH_Module performance_cost={p} resource_cost={r} R R)";
    for (performance, resource, expected) in [
        (Value::Number(0.5), 0.5, "R"),
        (Value::Number(1.0), 0.5, "F"),
        (Value::Number(0.5), 1.0, "F"),
        // Of several costs the greatest counts.
        (Value::Text("0.1;0.9".into()), 0.5, "R"),
        (Value::Text("0.1;1.2".into()), 0.5, "F"),
    ] {
        let mut trial = Trial::new(text);
        assert_eq!(trial.answers(1), "R");
        trial.tree.set_entry("p", performance.clone());
        trial.tree.set_entry("r", Value::Number(resource));
        assert_eq!(trial.answers(1), expected, "{performance} {resource}");
    }
    // At the end the performance counts alone.
    let mut trial = Trial::new("(ReFRESH_Module performance_cost={p} resource_cost={r} RS FS)");
    trial.tick();
    trial.tree.set_entry("p", Value::Number(1.0));
    assert_eq!(trial.answers(1), "F");
}

/// Defect 1: the cost of what has no evaluator was 1, which never passed for success.
#[test]
fn a_module_without_an_evaluator_can_succeed() {
    assert_eq!(Trial::new("(ReFRESH_Module RS)").answers(2), "RS");
    assert_eq!(Trial::new("(ReFRESH_Module RF)").answers(2), "RF");
    let text = decider(&["(ReFRESH_Module RS)".to_owned()]);
    assert_eq!(Trial::new(&text).answers(3), "RRS");
}

#[test]
fn the_cheapest_goes_first_then_the_order_of_connection() {
    // Each child with its weighted cost; the one that is ticked in the second tick.
    for (children, first) in [
        (
            vec![
                module("RS", 0.8, 0.2),
                module("RRS", 0.3, 0.4),
                module("RRRS", 0.9, 0.9),
            ],
            1,
        ),
        (vec![module("RS", 0.4, 0.4), module("RRS", 0.2, 0.6)], 0),
        // Infeasible ones never come first, however cheap the sum.
        (vec![module("RS", 1.1, 0.0), module("RRS", 0.9, 0.9)], 1),
        (vec![module("RS", 0.0, 1.0), module("RRS", 0.9, 0.9)], 1),
        // One without an estimator comes behind those that have one, what is no Module last.
        (
            vec!["(ReFRESH_Module RS)".to_owned(), module("RRS", 0.9, 0.9)],
            1,
        ),
        (vec!["RS".to_owned(), "(ReFRESH_Module RRS)".to_owned()], 1),
        (vec!["R".to_owned(), "RR".to_owned()], 0),
        (vec!["F".to_owned(), "RRS".to_owned()], 1),
    ] {
        let text = decider(&children);
        let mut trial = Trial::new(&text);
        assert_eq!(trial.answers(1), "R", "{text}");
        let plan = std::sync::Arc::clone(trial.tree.plan());
        trial.tick();
        let root = plan.node_ids().next().expect("a root");
        let running = plan
            .children(root)
            .iter()
            .position(|child| trial.tree.status(*child) != behavior_tree::Status::Idle);
        assert_eq!(running, Some(first), "{text}");
    }
}

#[test]
fn every_edge_of_the_decider_is_as_drawn() {
    for (children, answers) in [
        // IDLE -> Reconfigure -> child -> SUCCESS. A child is ticked in the tick after its choice.
        (vec![module("RS", 0.5, 0.5)], "RRS"),
        // Reconfigure -> FAILURE: all children fail.
        (vec!["F".to_owned(), "F".to_owned()], "F"),
        (vec!["(ReFRESH_Module S S F)".to_owned()], "F"),
        // Child -> Reconfigure -> other child -> SUCCESS.
        (
            vec![module("RF", 0.1, 0.1), module("RS", 0.5, 0.5)],
            "RRRRS",
        ),
        // Child -> Reconfigure -> FAILURE: nothing is left.
        (vec![module("RF", 0.1, 0.1)], "RRF"),
        // At the beginning what is only possible is not enough.
        (vec![module("RS", 1.5, 0.5)], "F"),
        // Later it is, as long as it has the resources.
        (vec![module("RF", 0.1, 0.1), module("S", 1.5, 0.5)], "RRRS"),
    ] {
        let text = decider(&children);
        assert_eq!(Trial::new(&text).answers(answers.len()), answers, "{text}");
    }
    let mut trial = Trial::new(&decider(&[module("R", 0.5, 0.5)]));
    assert_eq!(trial.answers(2), "RR");
    trial.halt().expect("halting works");
    assert_eq!(trial.halts(), [1, 0, 0]);
}

#[test]
fn retries_are_bounded_for_each_child() {
    // Two that always fail take turns: each is chosen again three times, the fourth is too many.
    let children = [module("F", 0.1, 0.1), module("FF", 0.2, 0.2)];
    let text = decider(&children);
    let mut trial = Trial::new(&text);
    let answers = trial.answers(8);
    assert_eq!(answers, "RRRRRRRF", "{text}");
    // Once kept, for want of another, it is chosen again as well.
    let text = "(ReFRESH_Decider performance_weight=1 resource_weight=1 retries=2 \
                fallback_no_reconfig=true (ReFRESH_Module F))";
    assert_eq!(Trial::new(text).answers(4), "RRRF");
}

/// Defects 2 and 7: a child that has failed is idle, and halted, before others are estimated, and
/// can itself be estimated again.
#[test]
fn a_failed_child_is_idle_before_the_next_works() {
    let mut trial = Trial::new(&decider(&[module("F", 0.1, 0.1), module("FS", 0.2, 0.2)]));
    // First, second, first, second: estimated each time.
    assert_eq!(trial.answers(5), "RRRRS");
    assert_eq!(trial.ticks()[2], 2, "the estimator of the first child");
    // A child that still runs when another takes over is halted once.
    let probed = "(ReFRESH_Decider performance_weight=1 resource_weight=1 R R)";
    let mut trial = Trial::new(probed);
    trial.tick();
    assert_eq!(trial.halts(), [1, 1], "both have been tried out");
}

/// Defect 3: without any candidate that has the resources the best possible one was number -1.
#[test]
fn nothing_possible_is_a_failure() {
    let text = decider(&[module("RF", 0.1, 0.1), module("S", 0.5, 1.5)]);
    assert_eq!(Trial::new(&text).answers(3), "RRF");
}

#[test]
fn a_reactor_does_its_task_and_mitigates_when_that_fails() {
    // The last child is the task. Ticks: choose task, task fails, choose mitigation and do it,
    // task again.
    let text = reactor(&[module("S", 0.1, 0.1), module("RFRS", 0.9, 0.9)]);
    let mut trial = Trial::new(&text);
    assert_eq!(trial.answers(6), "RRRRRS");
    // The task without trouble; the mitigation is not even estimated.
    let text = reactor(&[module("S", 0.1, 0.1), module("RS", 0.9, 0.9)]);
    let mut trial = Trial::new(&text);
    assert_eq!(trial.answers(3), "RRS");
    assert_eq!(trial.ticks()[..3], [0, 0, 0]);
    // Nothing is left that could mitigate.
    let text = reactor(&[module("F", 0.1, 0.1), module("RF", 0.9, 0.9)]);
    assert_eq!(Trial::new(&text).answers(4), "RRRF");
}

/// Defect 4: when the task could be entered at once the number of the active child was -1.
#[test]
fn a_reactor_whose_task_can_be_entered_works_on_it() {
    let mut trial = Trial::new(&reactor(&["F".to_owned(), module("RS", 0.5, 0.5)]));
    assert_eq!(trial.answers(3), "RRS");
    assert_eq!(trial.ticks()[0], 0, "no mitigation is tried out");
}

#[test]
fn a_reactor_whose_task_cannot_be_entered_mitigates_first() {
    let task = "(ReFRESH_Module S S FS)".to_owned();
    let text = reactor(&[module("S", 0.1, 0.1), task.clone()]);
    assert_eq!(Trial::new(&text).answers(3), "RRS");
    // What has only the resources, unless that is ruled out.
    let text = reactor(&[module("S", 1.5, 0.1), task]);
    assert_eq!(Trial::new(&text).answers(3), "RRS");
    let strict = text.replace("Reactor ", "Reactor fallback_no_reconfig=true ");
    assert_eq!(Trial::new(&strict).answers(1), "F");
}

#[test]
fn weights_must_be_said() {
    let (plan, findings) = crate::harness::compile(
        &[crate::harness::file(
            &[("Main", "(ReFRESH_Decider S)")],
            behavior_tree::definition::Format::V4,
        )],
        "Main",
    );
    assert!(plan.is_none());
    let told: Vec<&str> = findings.iter().map(|it| it.message.as_str()).collect();
    assert_eq!(
        told,
        [
            "ReFRESH_Decider has no performance_weight",
            "ReFRESH_Decider has no resource_weight"
        ]
    );
}
