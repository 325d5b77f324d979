//! A component does not return; it alone is broken off and goes to ERROR, the others go on. Rules
//! say that nothing is recovered here: this is about the hang staying where it is.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use container::component::{CallLimits, ComponentCell};
use container::guard::loss::LostThread;
use container::lane::{Crew, Lane, Work};
use system_model::life_cycle::{LifeCycleState, Operation};
use tests::{Application, Member, artifacts, assembled, environment};

/// Ways to hang, and whether the thread is lost with the component.
const WAYS: [(&str, bool); 5] = [
    ("hangs", false),
    ("hangs_asking", false),
    ("hangs_allocating", false),
    ("hangs_asleep", true),
    ("blocks_signals", false),
];

/// Cycles in a second of simulated time at 10 ms.
const CYCLES: u64 = 100;

/// A healthy chain beside a component that hangs, with all that can call the latter.
fn application(way: &str, callback: &str) -> Application {
    let faulty = Member::new("faulty", way)
        .property("callback", callback)
        .property("at_cycle", "1");
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .with(&faulty)
        .with(&Member::new("sink", "recorder"))
        .with(&Member::new("herald", "herald"))
        .with(&Member::new("asker", "asker"))
        .connect("data", "counter.output", "recorder.input")
        .connect("data", "faulty.output", "sink.input")
        .connect("event", "herald.news", "faulty.heard")
        .connect("service", "asker.arithmetic", "faulty.arithmetic")
        .not_recovered(&["faulty"])
}

/// Where a component hangs in simulated time: each takes a second of the machine's, so only one way
/// is tried everywhere.
fn callbacks(way: &str) -> &'static [&'static str] {
    match way {
        "hangs" => &[
            "onPeriodChanged",
            "onExecute",
            "onUpdated",
            "onEvent",
            "onCall",
        ],
        _ => &["onExecute", "onCall"],
    }
}

/// In simulated time a hang lasts until the watchdog's deadline, of that clock; nothing of the others
/// changes.
#[test]
fn in_simulated_time() {
    for (way, thread_lost) in WAYS {
        for callback in callbacks(way) {
            let outcome = application(way, callback).simulate("1s").ended_well();
            let context = format!("{way} in {callback}");
            let expected = ("hang".to_owned(), (*callback).to_owned());
            assert_eq!(outcome.faults("faulty"), [expected], "{context}");
            let fault = outcome.events("fault", "faulty")[0];
            assert_eq!(fault["thread_lost"], thread_lost, "{context}");
            let message = fault["message"].as_str().expect("a text");
            // Who loses its thread does so when the machine's time is over.
            let limit = if thread_lost { "1s" } else { "30ms" };
            let expected = format!("it did not return within {limit}");
            assert!(message.starts_with(&expected), "{message}");
            let states = outcome.states("faulty");
            assert!(states.iter().any(|state| state == "ERROR"), "{context}");
            for healthy in ["counter", "recorder", "sink", "herald"] {
                assert_eq!(outcome.cycles(healthy), CYCLES, "{context}: {healthy}");
            }
            assert_eq!(
                outcome.states("recorder"),
                ["READY", "ACTIVE", "INACTIVE", "DESTROYED"],
                "{context}"
            );
        }
    }
}

/// Stopping goes on in order. A machine that gives the component too little time to be found out
/// leaves it behind first.
#[test]
fn while_it_stops() {
    for (way, _) in WAYS {
        let outcome = application(way, "onStop").simulate("1s").ended_well();
        let hang = ("hang".to_owned(), "onStop".to_owned());
        let left_behind = outcome
            .raw_events()
            .contains("component 'faulty' did not return: it is left behind");
        assert!(
            outcome.faults("faulty") == [hang] || left_behind,
            "{way}: {}",
            outcome.raw_events()
        );
        for healthy in ["counter", "recorder"] {
            assert_eq!(outcome.cycles(healthy), CYCLES, "{way}: {healthy}");
            assert_eq!(
                outcome.states(healthy),
                ["READY", "ACTIVE", "INACTIVE", "DESTROYED"],
                "{way}: {healthy}"
            );
        }
    }
}

/// Who called a component that is broken off gets an answer and goes on.
#[test]
fn the_caller_is_not_charged() {
    let outcome = application("hangs", "onCall").simulate("1s").ended_well();
    assert_eq!(
        outcome.logs("asker"),
        [
            "answer 502 INTERNAL_FAULT",
            "answer 405 PRECONDITION_NOT_MET"
        ]
    );
    // It waited for three of its periods.
    assert_eq!(outcome.cycles("asker"), CYCLES - 2);
    assert_eq!(outcome.component("asker")["faults"], 0);
}

/// By the machine's clock, each on a thread of its own: the healthy ones go on meanwhile.
#[test]
fn in_real_time() {
    let mut application = Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .connect("data", "counter.output", "recorder.input");
    for (way, _) in WAYS {
        application = application.with(&Member::new(way, way));
    }
    let application = application.not_recovered(&WAYS.map(|(way, _)| way));
    let outlived = |events: &str| {
        let faults = events.match_indices("\"event\":\"fault\"");
        let last = faults.skip(WAYS.len() - 1).last();
        last.is_some_and(|(last, _)| events[last..].matches("got ").count() > 20)
    };
    let outcome = application.run_until(outlived).ended_well();
    for (way, thread_lost) in WAYS {
        let expected = ("hang".to_owned(), "onExecute".to_owned());
        assert_eq!(outcome.faults(way), [expected], "{way}");
        assert_eq!(outcome.component(way)["state"], "ERROR", "{way}");
        assert_eq!(outcome.cycles(way), 4, "{way}");
        let fault = outcome.events("fault", way)[0];
        assert_eq!(fault["thread_lost"], thread_lost, "{way}");
        let message = fault["message"].as_str().expect("a text");
        assert!(
            message.starts_with("it did not return within 30ms"),
            "{message}"
        );
    }
    assert_eq!(outcome.component("counter")["faults"], 0);
    let logs = outcome.logs("recorder");
    let last = logs.last().map(String::as_str).unwrap_or_default();
    assert!(last.ends_with("gaps 0"), "{last}");
    assert!(!outcome.raw_events().contains("left behind"));
}

/// What blocks every signal by itself cannot be broken off: the container goes on without it, and
/// ends without it.
#[test]
fn although_it_hears_no_signal() {
    for callback in ["onExecute", "onStop"] {
        let deaf = Member::new("deaf", "hangs_deaf")
            .property("callback", callback)
            .property("at_cycle", "1");
        let outcome = Application::new()
            .with(&Member::new("diary", "diary").period(200))
            .with(&deaf)
            .run_until(|events| events.contains("onExecute"))
            .ended_well();
        assert!(outcome.raw_events().contains("left behind"), "{callback}");
        assert_eq!(
            outcome.states("diary"),
            ["READY", "ACTIVE", "INACTIVE", "DESTROYED"],
            "{callback}: the others stop in order"
        );
    }
}

/// While it is brought up: with a limit of its own, so that nobody waits for the default.
#[test]
fn while_it_is_brought_up() {
    for (callback, limit) in [("onInitialize", "50ms"), ("onStart", "50ms")] {
        let faulty = Member::new("faulty", "hangs")
            .property("callback", callback)
            .property("at_cycle", "1");
        let application = Application::new().with(&faulty);
        let (environment, writer) = environment();
        let components = assembled(&application.profile(), artifacts(), &environment).components;
        let component = Arc::clone(&components[0]);
        let message = Arc::default();
        let lane = Lane::new(
            "up",
            Box::new(BringUp {
                component,
                message: Arc::clone(&message),
            }),
        );
        let crew = Crew::new().expect("a crew");
        crew.start(&lane, || {}).expect("a thread");
        assert!(lane.wait(Duration::from_secs(60)), "{callback}");
        crew.dismiss();
        environment.events.finish();
        writer.close().expect("no file to fail");
        let expected = format!("hang in {callback}: it did not return within {limit}");
        assert_eq!(*message.lock().expect("not poisoned"), expected);
    }
}

/// Brings a component up and notes what it failed of.
struct BringUp {
    component: Arc<ComponentCell>,
    message: Arc<Mutex<String>>,
}

impl Work for BringUp {
    fn run(&mut self, lane: &Lane) {
        let mut component = self
            .component
            .enter(lane.token(), Duration::ZERO)
            .expect("free");
        component.set_limits(CallLimits {
            cycle: Duration::from_secs(60),
            startup: Duration::from_millis(50),
        });
        component.construct(lane.loss()).expect("constructed");
        for operation in [Operation::Initialize, Operation::Start] {
            let _fails = component.operate(operation, lane.loss());
        }
        assert_eq!(component.state(), LifeCycleState::Error);
        let last = component.status().last_fault().unwrap_or_default();
        *self.message.lock().expect("not poisoned") = last;
    }

    fn after_loss(&mut self, lost: &LostThread) {
        panic!("only the component is broken off: {lost:?}");
    }
}
