//! Who is stopped with whom, and in which order.

use fault_manager::{Action, Condition, Observation, Scope};
use system_model::fault::FaultKind;
use system_model::rules::{ApplicationSeverity, ComponentSeverity, DependencySeverity, Entity};
use system_model::specification::ExecutionKind;

use crate::support::{Bench, application, budget, located, needs};

use DependencySeverity::{Destroy, Ignore, Stop};
use Entity::{Component, Executor};

fn stop_on_any_fault(scope: &mut Scope) {
    for rules in &mut scope.rules.components {
        rules.severity = Some(located(ComponentSeverity::Stop));
    }
}

fn stopped(component: usize) -> Action {
    Action::Stop { component }
}

fn destroyed(component: usize) -> Action {
    Action::Destroy { component }
}

type Rules = Vec<(Entity, Vec<Entity>, usize, DependencySeverity)>;

/// Who needs whom of the components a to f, which one fails, what comes down.
fn cases() -> Vec<(&'static str, Rules, usize, Vec<Action>)> {
    vec![
        ("alone", vec![], 2, vec![stopped(2)]),
        (
            "a chain, against the order of indices too",
            vec![
                (Component(0), vec![Component(1)], 1, Stop),
                (Component(3), vec![Component(0)], 1, Stop),
            ],
            1,
            vec![stopped(3), stopped(0), stopped(1)],
        ),
        (
            "left, and with it what needs it",
            vec![
                (Component(0), vec![Component(1)], 1, Ignore),
                (Component(2), vec![Component(0)], 1, Stop),
            ],
            1,
            vec![stopped(1)],
        ),
        (
            "destroyed is more than stopped, whatever comes first",
            vec![
                (Component(0), vec![Component(1)], 1, Stop),
                (Component(2), vec![Component(1)], 1, Stop),
                (Component(0), vec![Component(2)], 1, Destroy),
            ],
            1,
            vec![destroyed(0), stopped(2), stopped(1)],
        ),
        (
            "two of three are enough",
            vec![(
                Component(3),
                vec![Component(0), Component(1), Component(2)],
                2,
                Stop,
            )],
            1,
            vec![stopped(1)],
        ),
        (
            "all components of the application that needs one",
            vec![(
                Entity::Application("robot".to_owned()),
                vec![Component(4)],
                1,
                Stop,
            )],
            4,
            vec![0, 1, 2, 3, 5, 4].into_iter().map(stopped).collect(),
        ),
        (
            "a diamond",
            vec![
                (Component(0), vec![Component(1), Component(2)], 2, Stop),
                (Component(1), vec![Component(3)], 1, Stop),
                (Component(2), vec![Component(3)], 1, Stop),
            ],
            3,
            vec![stopped(0), stopped(1), stopped(2), stopped(3)],
        ),
    ]
}

#[test]
fn exactly_what_depends_comes_down_dependents_first() {
    for (case, rules, failing, expected) in cases() {
        let mut scope = application("robot", &["a", "b", "c", "d", "e", "f"]);
        stop_on_any_fault(&mut scope);
        for (dependent, providers, need, severity) in rules {
            needs(&mut scope, dependent, &providers, need, severity);
        }
        let mut bench = Bench::new(vec![scope]);
        bench.crash(failing);
        assert_eq!(bench.actions(), expected, "{case}");
    }
}

#[test]
fn an_executor_is_down_with_any_member_and_its_members_are_stopped_with_it() {
    let mut scope = application("robot", &["a", "b", "c", "d", "e"]);
    stop_on_any_fault(&mut scope);
    for member in [0, 1] {
        scope.specification.components[member].execution.kind = ExecutionKind::PeriodicShared;
    }
    for member in [3, 4] {
        scope.specification.components[member].execution.kind = ExecutionKind::Passive;
    }
    needs(&mut scope, Executor(0), &[Executor(3)], 1, Stop);
    let mut bench = Bench::new(vec![scope]);
    bench.crash(4);
    assert_eq!(bench.actions(), [stopped(0), stopped(1), stopped(4)]);
    assert_eq!(bench.manager.condition(3), Some(Condition::Working));
}

/// Figure 8: A lives with two of its cameras gone, and with it D; B works on their pictures too and
/// stops, and with it C. Everything else runs on.
#[test]
fn figure_8() {
    let of_cameras = ["front", "left", "right"].map(str::to_owned);
    let cameras: Vec<Scope> = of_cameras
        .iter()
        .map(|name| {
            let mut scope = application(name, &["camera"]);
            scope.rules.components[0].fault = budget(0, ApplicationSeverity::Local);
            scope
        })
        .collect();
    let named = |name: &str| Entity::Application(name.to_owned());
    let task = |name: &str, providers: &[Entity], need: usize| {
        let mut scope = application(name, &["work", "display"]);
        if need > 0 {
            needs(&mut scope, named(name), providers, need, Stop);
        }
        scope
    };
    let all = of_cameras.each_ref().map(|name| named(name));
    let mut scopes = vec![
        task("C", &[named("B")], 1),
        task("B", &all, 3),
        task("A", &all, 1),
        task("D", &[named("A")], 1),
        task("E", &[], 0),
        task("F", &[named("E")], 1),
    ];
    scopes.extend(cameras);
    let (c, b, front, left) = ([0, 1], [2, 3], 12, 13);
    let mut bench = Bench::new(scopes);
    bench.crash(front);
    let mut expected: Vec<Action> = c.into_iter().chain(b).map(stopped).collect();
    expected.push(stopped(front));
    assert_eq!(bench.actions(), expected);
    let plan = &bench.newest().plan;
    assert!(
        plan.contains(&"stop work: it needs front and left and right".to_owned()),
        "{plan:?}"
    );
    bench.crash(left);
    assert_eq!(bench.actions(), [stopped(left)]);
    for running in 4..12 {
        let condition = bench.manager.condition(running);
        assert_eq!(condition, Some(Condition::Working), "component {running}");
    }
    bench.complain(
        14,
        &fault_manager::DetectorKind::Hang,
        FaultKind::Hang,
        false,
    );
    let a_and_d = [6, 7, 4, 5, 14].map(stopped);
    assert_eq!(bench.actions(), a_and_d, "the last camera");
}

/// The same with the cameras as components of one application.
#[test]
fn figure_8_within_one_application() {
    let names = ["D", "C", "A", "B", "camera_1", "camera_2", "camera_3"];
    let mut scope = application("robot", &names);
    for rules in &mut scope.rules.components {
        rules.fault = budget(0, ApplicationSeverity::Ignore);
    }
    let cameras = [Component(4), Component(5), Component(6)];
    needs(&mut scope, Component(2), &cameras, 1, Stop);
    needs(&mut scope, Component(3), &cameras[..2], 2, Stop);
    needs(&mut scope, Component(1), &[Component(3)], 1, Stop);
    needs(&mut scope, Component(0), &[Component(2)], 1, Stop);
    let mut bench = Bench::new(vec![scope]);
    bench.crash(4);
    assert_eq!(bench.actions(), [stopped(1), stopped(3), stopped(4)]);
    bench.crash(5);
    assert_eq!(bench.actions(), [stopped(5)]);
    for running in [0, 2, 6] {
        assert_eq!(bench.manager.condition(running), Some(Condition::Working));
    }
}

#[test]
fn a_component_that_is_ignored_in_error_breaks_what_needs_it() {
    let mut scope = application("robot", &["a", "b"]);
    scope.rules.components[1].severity = Some(located(ComponentSeverity::Ignore));
    needs(&mut scope, Component(0), &[Component(1)], 1, Stop);
    let mut bench = Bench::new(vec![scope]);
    bench.complain(
        1,
        &fault_manager::DetectorKind::FaultEvent(None),
        FaultKind::Reported,
        true,
    );
    assert!(bench.acts.is_empty(), "it runs");
    bench.crash(1);
    assert_eq!(bench.actions(), [stopped(0)]);
    assert_eq!(bench.manager.condition(1), Some(Condition::Lost));
}

#[test]
fn a_stop_overtakes_the_recovery_of_what_depends() {
    let mut scope = application("robot", &["a", "b"]);
    scope.rules.components[1].severity = Some(located(ComponentSeverity::Stop));
    needs(&mut scope, Component(0), &[Component(1)], 1, Stop);
    let mut bench = Bench::new(vec![scope]);
    bench.crash(0);
    let reset = bench.act();
    bench.crash(1);
    assert_eq!(bench.abandoned, [reset.id]);
    assert_eq!(bench.actions(), [stopped(0), stopped(1)]);
    let first = bench.records.values().next().expect("a record");
    assert_eq!(first.actions[0].outcome, "abandoned");
    assert!(first.handling_us.is_some());
    bench.done(&reset);
    assert_eq!(bench.manager.condition(0), Some(Condition::Stopped));
}

#[test]
fn an_operator_starts_again_what_was_stopped_but_not_what_lacks_what_it_needs() {
    let mut scope = application("robot", &["a", "b"]);
    scope.rules.components[1].severity = Some(located(ComponentSeverity::Stop));
    needs(&mut scope, Component(0), &[Component(1)], 1, Stop);
    let mut bench = Bench::new(vec![scope]);
    bench.crash(1);
    for stop in bench.acts.clone() {
        bench.done(&stop);
    }
    bench.works(0);
    let again = bench.act();
    assert_eq!(again.action, stopped(0));
    bench.done(&again);
    bench.works(1);
    bench.works(0);
    assert!(bench.acts.is_empty());
    assert_eq!(bench.manager.condition(0), Some(Condition::Working));
    assert_eq!(bench.manager.condition(1), Some(Condition::Working));
}

#[test]
fn a_stop_is_not_overdue_because_a_recovery_that_it_overtook_is() {
    let mut scope = application("robot", &["a", "b"]);
    for rules in &mut scope.rules.components {
        rules.fault = budget(1, ApplicationSeverity::Local);
    }
    let mut bench = Bench::new(vec![scope]);
    bench.crash(0);
    bench.crash(1);
    let deadline = bench.manager.due().expect("of both resets");
    bench.now = deadline;
    bench.tell(Observation::Tick);
    assert_eq!(bench.actions(), [stopped(0), stopped(1)]);
}
