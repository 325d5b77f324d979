//! Behaviour trees: they fail like components, order like operators, and handle faults.

use std::time::Duration;

use fault_manager::{Action, Condition, Evidence, FaultState, Observation, OperatorOrder, Scope};
use system_model::mission::{DeclaredTree, TreeStart};
use system_model::rules::{ApplicationSeverity, ComponentSeverity, HandleRule};
use system_model::specification::Place;

use crate::support::{Bench, application, budget, located};

const CAMERA: usize = 0;
const TREE: usize = 2;
const WITHIN: Duration = Duration::from_secs(5);

fn tree(severity: ComponentSeverity) -> DeclaredTree {
    DeclaredTree {
        name: "rescue".to_owned(),
        starts: TreeStart::ByFault,
        tick: Duration::from_millis(100),
        tick_deadline: Duration::from_millis(20),
        severity,
        retry_max: 1,
        place: Place::default(),
    }
}

/// A camera whose faults are handled by the tree after one reset, and a planner.
fn robot(severity: ComponentSeverity) -> Scope {
    let mut robot = application("robot", &["camera", "planner"]);
    robot.specification.trees.push(tree(severity));
    let rules = &mut robot.rules.components[CAMERA];
    rules.fault = budget(1, ApplicationSeverity::Ignore);
    rules.handle = Some(located(HandleRule {
        tree: "rescue".to_owned(),
        deadline: WITHIN,
    }));
    robot
}

const HANDLE: Action = Action::Handle {
    component: CAMERA,
    tree: TREE,
    within: WITHIN,
};

/// The camera has crashed, and its reset has failed: the tree's turn.
fn begun() -> Bench {
    let mut bench = Bench::new(vec![robot(ComponentSeverity::Stop)]);
    bench.crash(CAMERA);
    let reset = bench.act();
    bench.failed(&reset);
    assert_eq!(bench.actions(), [HANDLE]);
    let plan = &bench.newest().plan;
    assert_eq!(
        plan.last().map(String::as_str),
        Some("handle camera by tree rescue")
    );
    bench
}

#[test]
fn a_tree_that_fails_is_begun_anew_within_its_budget_and_then_the_robot_stops() {
    for (severity, expected) in [
        (ComponentSeverity::Ignore, vec![]),
        (
            ComponentSeverity::Stop,
            vec![Action::Stop { component: TREE }],
        ),
        (ComponentSeverity::Emergency, vec![Action::EmergencyStop]),
    ] {
        let mut bench = Bench::new(vec![robot(severity)]);
        bench.crash(TREE);
        assert_eq!(bench.actions(), expected, "{severity:?}");
        assert_eq!(bench.newest().component, "rescue");
    }
    let mut bench = Bench::new(vec![robot(ComponentSeverity::Reset)]);
    bench.crash(TREE);
    let reset = bench.act();
    bench.done(&reset);
    assert_eq!(bench.newest().state, FaultState::Healed);
    bench.crash(TREE);
    assert_eq!(bench.actions(), [Action::EmergencyStop]);
}

#[test]
fn an_application_stops_with_its_trees() {
    let mut robot = robot(ComponentSeverity::Stop);
    robot.rules.components[1].fault = budget(0, ApplicationSeverity::Local);
    let mut bench = Bench::new(vec![robot]);
    bench.crash(1);
    assert!(bench.actions().contains(&Action::Stop { component: TREE }));
}

#[test]
fn an_order_of_a_tree_says_so() {
    let mut bench = Bench::new(vec![robot(ComponentSeverity::Stop)]);
    bench.tell(Observation::OrderedByTree {
        tree: TREE,
        component: CAMERA,
        order: OperatorOrder::Reset,
    });
    let by = Some("rescue".to_owned());
    let order = "reset camera".to_owned();
    assert_eq!(bench.newest().evidence, Evidence::Order { order, by });
}

/// The tree resets the component itself: that is no other rung, and heals the fault.
#[test]
fn a_fault_has_healed_when_the_tree_has_brought_its_component_back() {
    let mut bench = begun();
    let handle = bench.act();
    let fault = handle.fault;
    bench.tell(Observation::OrderedByTree {
        tree: TREE,
        component: CAMERA,
        order: OperatorOrder::Reset,
    });
    let reset = bench.act();
    bench.done(&reset);
    bench.works(CAMERA);
    assert_eq!(bench.records[&fault].state, FaultState::Healed);
    bench.done(&handle);
    assert_eq!(bench.actions(), []);
    assert!(bench.records[&fault].handling_us.is_some());
    assert_eq!(bench.manager.condition(CAMERA), Some(Condition::Working));
}

#[test]
fn the_ladder_goes_on_behind_a_tree_that_fails_is_late_or_changes_nothing() {
    let stop = [Action::Stop { component: CAMERA }];
    let mut bench = begun();
    let handle = bench.act();
    bench.failed(&handle);
    assert_eq!(bench.actions(), stop);

    let mut bench = begun();
    bench.wait(4_999);
    assert_eq!(bench.actions(), []);
    bench.wait(2);
    assert_eq!(bench.actions(), stop);
    assert_eq!(bench.abandoned.len(), 1);

    let mut bench = begun();
    let handle = bench.act();
    bench.done(&handle);
    assert_eq!(bench.actions(), [], "its component may still come to work");
    bench.wait(5_001);
    assert_eq!(bench.actions(), stop);
}

#[test]
fn a_tree_handles_the_faults_of_a_component_once_within_the_window() {
    let mut bench = begun();
    let handle = bench.act();
    bench.tell(Observation::OrderedByTree {
        tree: TREE,
        component: CAMERA,
        order: OperatorOrder::Reset,
    });
    let reset = bench.act();
    bench.done(&reset);
    bench.works(CAMERA);
    bench.done(&handle);
    bench.crash(CAMERA);
    assert_eq!(bench.actions(), [Action::Stop { component: CAMERA }]);
}
