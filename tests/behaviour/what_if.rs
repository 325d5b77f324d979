//! The table of what would come of every fault of every component of the reference robot agrees with
//! what the container really does.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZero;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use fault_manager::Scope;
use fault_manager::what_if::{
    Answer, Assumptions, BEGIN, Cell, Recoveries, SupposedFault, Supposition, Table, input_port,
};
use system_model::injection::{Distortion, InjectedFault, Misbehaviour};
use system_profile::{LoadOptions, Severity, load_application, load_rules};
use tests::{Application, Outcome, repository};

/// What is known of the components, and of no profile and no rule: these have nothing else to make
/// their data of. The others go on without, or with what is wrong: obstacle avoidance with three
/// sonars, the planner by searching, actuator control by stopping.
const PASSES_ON: [&str; 6] = [
    "front_sonar.ranges",
    "left_sonar.ranges",
    "right_sonar.ranges",
    "rear_sonar.ranges",
    "wheel_encoders.ticks",
    "obstacle_avoidance.odometry",
];

/// Data of whole numbers, which are always numbers. Types are known to libraries alone, so the table
/// answers what would be if they were not.
const WHOLE_NUMBERS: [&str; 6] = [
    "motor_driver.command",
    "motor_driver.encoders",
    "camera.image",
    "object_detector.image",
    "wheel_encoders.ticks",
    "actuator_control.command",
];

/// In this drive the robot moves from the first second on.
const SEED: &str = "4";

/// From the beginning of the fault the slowest course, a hang of a component without a period, takes
/// a second until it is seen; power is taken from an actuator a second after an emergency stop.
const LENGTH: &str = "3500ms";

fn scopes() -> Vec<Scope> {
    let options = LoadOptions {
        search_paths: Vec::new(),
        dangling: Severity::Error,
    };
    let application = load_application(&profile(), &options);
    let specification = application.specification.expect("the robot is shipped");
    let rules = load_rules(&specification, &[rules()], &options);
    vec![Scope {
        specification,
        rules: rules.rules.expect("its rules are shipped"),
    }]
}

fn profile() -> PathBuf {
    repository().join("profiles/applications/target_following.xml")
}

fn rules() -> PathBuf {
    repository().join("rules/target_following.xml")
}

/// What a person sees of a course: what was done, and where everything ended.
#[derive(Debug, PartialEq)]
struct Course {
    actions: Vec<String>,
    /// Components that are not as they were at the start: state and incarnation.
    changed: BTreeMap<String, (String, u64)>,
    application: String,
}

impl Course {
    fn supposed(answer: &Answer) -> Self {
        let components = answer.components.iter();
        Self {
            actions: answer.actions(),
            changed: components
                .map(|it| {
                    let end = (it.state.to_owned(), u64::from(it.incarnation));
                    (it.component.clone(), end)
                })
                .filter(|(_, end)| is_changed(end))
                .collect(),
            application: answer.applications[0].state.to_owned(),
        }
    }

    fn real(outcome: &Outcome) -> Self {
        let summary = outcome.summary();
        let components = summary["components"].as_object().expect("components");
        Self {
            actions: outcome.actions(),
            changed: components
                .iter()
                .map(|(name, it)| {
                    let state = it["state"].as_str().expect("a state").to_owned();
                    let incarnation = it["incarnation"].as_u64().expect("a number");
                    (name.clone(), (state, incarnation))
                })
                .filter(|(_, end)| is_changed(end))
                .collect(),
            application: summary["applications"]["target_following"]["state"]
                .as_str()
                .expect("a state")
                .to_owned(),
        }
    }

    /// Without what is chance where numbers are: how often each of several is hit before the first
    /// of them is given up.
    fn without_chance(self) -> (BTreeSet<String>, BTreeMap<String, String>, String) {
        let actions = self.actions.into_iter();
        let what = |action: String| action.split(':').next().unwrap_or_default().to_owned();
        let states = self
            .changed
            .into_iter()
            .map(|(name, (state, _))| (name, state));
        (
            actions.map(what).collect(),
            states.collect(),
            self.application,
        )
    }
}

fn is_changed((state, incarnation): &(String, u64)) -> bool {
    state != "ACTIVE" || *incarnation != 1
}

/// The same as an injection. A fault of the handling shows by the handling of a crash.
fn injections(scopes: &[Scope], supposition: &Supposition) -> String {
    let component = &scopes[0].specification.components[supposition.component].name;
    let at = BEGIN.as_millis();
    let fault = supposition.fault.name();
    let inject = |what: String| format!("<inject at='{at}ms' component='{component}' {what}/>\n");
    let mut text = match supposition.injected(scopes).expect("it can be injected") {
        InjectedFault::Container { .. } => inject("fault='segfault'".to_owned()),
        _ => String::new(),
    };
    let (extent, port) = match supposition.injected(scopes) {
        Some(InjectedFault::Callback { misbehaviour, .. }) => (extent(misbehaviour), String::new()),
        Some(InjectedFault::Port {
            port, distortion, ..
        }) => (extent_of(distortion), format!("port='{port}'")),
        _ => (String::new(), String::new()),
    };
    text.insert_str(0, &inject(format!("fault='{fault}' {port} {extent}")));
    format!("<fault_injections application='target_following'>\n{text}</fault_injections>")
}

fn extent(misbehaviour: Misbehaviour) -> String {
    match misbehaviour {
        Misbehaviour::Slow(time) => format!("duration='{}ms'", time.as_millis()),
        Misbehaviour::Leak(bytes) => format!("bytes='{bytes}'"),
        Misbehaviour::ErrorReturn(code) => format!("code='{code}'"),
        _ => String::new(),
    }
}

fn extent_of(distortion: Distortion) -> String {
    match distortion {
        Distortion::OutOfRange(value) | Distortion::Offset(value) => format!("value='{value}'"),
        Distortion::Drift(per_second) => format!("per_second='{per_second}'"),
        Distortion::Noise(deviation) => format!("deviation='{deviation}'"),
        Distortion::Delay(time) => format!("duration='{}ms'", time.as_millis()),
        _ => String::new(),
    }
}

fn run(scopes: &[Scope], supposition: &Supposition) -> Outcome {
    let application = Application::new();
    let injections = application.write("injections.xml", injections(scopes, supposition));
    let (rules, injections) = (
        rules().display().to_string(),
        injections.display().to_string(),
    );
    let arguments = [
        "--rules",
        &rules,
        "--inject",
        &injections,
        "--clock",
        "simulated",
    ];
    let arguments = [&arguments[..], &["--for", LENGTH, "--seed", SEED]].concat();
    application.run_file(&profile(), &arguments)
}

/// What differs; nothing if all is as supposed.
fn difference(scopes: &[Scope], cell: &Cell) -> Option<String> {
    let Supposition { fault, port, .. } = &cell.supposition;
    let component = &scopes[0].specification.components[cell.supposition.component].name;
    let subject = match port {
        Some(port) => format!("{component}.{port}"),
        None => component.clone(),
    };
    let words = format!("{subject} {}", fault.name());
    let answer = match &cell.answer {
        Ok(answer) => answer,
        Err(reason) => return Some(format!("{words}: {reason}")),
    };
    let outcome = run(scopes, &cell.supposition);
    if *fault == SupposedFault::Port(Distortion::NotANumber)
        && WHOLE_NUMBERS.contains(&subject.as_str())
    {
        outcome.was_refused(4, &["not_a_number", "whole numbers"]);
        return None;
    }
    let (supposed, real) = (
        Course::supposed(answer),
        Course::real(&outcome.ended_well()),
    );
    let text = format!("{words}:\n  supposed {supposed:?}\n  real     {real:?}");
    let same = match fault {
        SupposedFault::Port(Distortion::Noise(_)) => {
            supposed.without_chance() == real.without_chance()
        }
        _ => supposed == real,
    };
    (!same).then_some(text)
}

#[test]
fn the_table_of_the_reference_robot_agrees_with_the_container() {
    let scopes = scopes();
    let passes_on = PASSES_ON.map(|text| input_port(&scopes, text).expect("it is an input"));
    let assumptions = Assumptions {
        recoveries: Recoveries::Succeed,
        passes_on: passes_on.to_vec(),
    };
    let table = Table::new(&scopes, &assumptions, &mut |_| {});
    let cells: Vec<&Cell> = table.rows.iter().flat_map(|row| &row.cells).collect();
    // 11 components with 12 faults of callbacks and 3 of the handling, 28 ports with 9 of data.
    assert_eq!(cells.len(), 11 * 15 + 28 * 9);
    let next = AtomicUsize::new(0);
    let differences = Mutex::new(Vec::new());
    let workers = std::thread::available_parallelism().map_or(1, NonZero::get);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(cell) = cells.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let found = difference(&scopes, cell);
                    differences
                        .lock()
                        .expect("nobody panics with it")
                        .extend(found);
                }
            });
        }
    });
    let differences = differences.into_inner().expect("nobody panicked with it");
    assert!(
        differences.is_empty(),
        "{} of {} cells differ:\n{}",
        differences.len(),
        cells.len(),
        differences.join("\n")
    );
}
