//! A component that was taken off leaves evidence: the functions of its library that were being
//! called.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use container::assembly::{LibraryOptions, assemble};
use container::clock::Clock;
use container::component::{CallLimits, ComponentCell, Environment};
use container::device::Devices;
use container::event_log::EventLog;
use container::guard::loss::LostThread;
use container::lane::{Crew, Lane, Work};
use container::library::LibrarySearch;
use system_model::life_cycle::Operation;
use system_profile::{LoadOptions, load_application};
use tests::{Application, Member, artifacts};

/// More than a fault takes on a busy machine.
const LIMIT: Duration = Duration::from_secs(60);

/// The backtrace of a component that fails in this way in its first cycle.
fn backtrace(way: &str) -> Vec<String> {
    let faulty = Member::new("faulty", way).property("at_cycle", "1");
    let application = Application::new().with(&faulty);
    let loaded = load_application(&application.profile(), &LoadOptions::default());
    let specification = loaded.specification.expect("a sound application");
    let (events, writer) = EventLog::open(None, false, None).expect("an event log");
    let environment = Arc::new(Environment {
        clock: Clock::simulated(),
        events,
        devices: Devices::default(),
    });
    let options = LibraryOptions {
        search: LibrarySearch::new(vec![artifacts().to_owned()]),
        probe: None,
    };
    let assembly = assemble(&specification, &options, &environment);
    let assembly = assembly.unwrap_or_else(|problems| panic!("{problems:?}"));
    let lines = Arc::default();
    let work = Fail {
        component: Arc::clone(&assembly.components[0]),
        lines: Arc::clone(&lines),
        is_over: false,
    };
    let lane = Lane::new("fail", Box::new(work));
    let crew = Crew::new().expect("a crew");
    crew.start(&lane, || {}).expect("a thread");
    assert!(lane.wait(LIMIT), "{way}");
    crew.dismiss();
    environment.events.finish();
    writer.close().expect("no file to fail");
    std::mem::take(&mut *lines.lock().expect("not poisoned"))
}

/// Brings a component up and runs it to its fault.
struct Fail {
    component: Arc<ComponentCell>,
    lines: Arc<Mutex<Vec<String>>>,
    is_over: bool,
}

impl Fail {
    fn keep_backtrace(&self, lane: &Lane) {
        let entered = self.component.enter(lane.token(), Duration::ZERO);
        let scene = entered
            .expect("free")
            .take_scene()
            .expect("it was taken off");
        *self.lines.lock().expect("not poisoned") = scene.backtrace();
    }
}

impl Work for Fail {
    fn run(&mut self, lane: &Lane) {
        if !self.is_over {
            let entered = self.component.enter(lane.token(), Duration::ZERO);
            let mut component = entered.expect("free");
            component.set_limits(CallLimits {
                cycle: Duration::from_millis(50),
                startup: LIMIT,
            });
            component.construct(lane.loss()).expect("constructed");
            for operation in [Operation::Initialize, Operation::Start] {
                component.operate(operation, lane.loss()).expect("operated");
            }
            component.execute(0, lane.loss());
        }
        self.keep_backtrace(lane);
    }

    fn after_loss(&mut self, lost: &LostThread) {
        self.is_over = true;
        let entered = self.component.enter(u32::MAX >> 1, Duration::ZERO);
        entered.expect("nobody else is inside").lost(lost);
    }
}

#[test]
fn name_the_functions_of_the_component() {
    for way in [
        "writes_null",
        "bus_error",
        "illegal_instruction",
        "divides_by_zero",
        "hangs",
        // In the C library, below the component's own code.
        "crashes_in_libc",
        "hangs_asleep",
    ] {
        let lines = backtrace(way);
        let own = format!("tests/faulty-components/{way}/src/lib.rs:");
        let misbehave = |line: &String| line.contains("misbehave") && line.contains(&own);
        let first = lines.iter().position(misbehave);
        let first = first.unwrap_or_else(|| panic!("{way}: {lines:#?}"));
        // Outside it are the functions that had called it, up to where the container came in.
        for (function, file) in [
            ("strike_if_due", "tests/parts/src/faulty.rs:"),
            ("on_execute", "component-sdk/src/export.rs:"),
        ] {
            let named = |line: &String| line.contains(function) && line.contains(file);
            assert!(lines[first..].iter().any(named), "{way}: {lines:#?}");
        }
        assert!(lines.iter().all(|line| !line.contains("0x")), "{lines:#?}");
        assert_eq!(lines, backtrace(way), "{way}: the same every time");
    }
}

#[test]
fn of_an_endless_recursion_are_bounded() {
    let lines = backtrace("overflows_stack");
    assert_eq!(lines.len(), 32, "{lines:#?}");
    let recursion = |line: &&String| line.starts_with("overflows_stack::descend at ");
    assert!(lines.iter().filter(recursion).count() > 25, "{lines:#?}");
}
