//! The reference robot under sabotage: every half a second something of it dies. It reaches its
//! target, touches nothing, and its log accounts for every blow.
//!
//! By the machine's clock a drive takes half a minute, so there is one; `SABOTAGE_SEEDS=17..37` makes
//! it twenty.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use rustix::process::Signal;
use serde_json::Value;
use tests::{Application, Outcome, Watched, repository};

use super::chance::Chance;

const COMPONENTS: [&str; 11] = [
    "motor_driver",
    "camera",
    "object_detector",
    "front_sonar",
    "left_sonar",
    "right_sonar",
    "rear_sonar",
    "wheel_encoders",
    "obstacle_avoidance",
    "path_planner",
    "actuator_control",
];

/// From one blow to the next.
const PERIOD: Duration = Duration::from_millis(500);

/// A drive takes up to 45 s if nothing fails; a busy machine gets more.
const LIMIT: &str = "300s";

/// That, and stopping.
const LONGEST_RUN: Duration = Duration::from_secs(330);

/// Blows and what they are seen as.
const BLOWS: [(Signal, &str); 3] = [
    (Signal::KILL, "host_ended"),
    (Signal::SEGV, "host_ended"),
    (Signal::STOP, "hang"),
];

/// Faults that are injected behind the guard, and what they are seen as.
const TRAPS: [(&str, &str); 8] = [
    ("panic", "panic"),
    ("segfault", "segfault"),
    ("divide_by_zero", "divide_by_zero"),
    ("illegal_instruction", "illegal_instruction"),
    ("abort", "abort"),
    ("exit", "exit"),
    ("stack_overflow", "stack_overflow"),
    ("hang", "hang"),
];

/// A component that was hit, and the kind of fault that this is.
type Blow = (&'static str, &'static str);

fn rules() -> PathBuf {
    repository().join("rules/every_component_in_a_process.xml")
}

fn profile() -> PathBuf {
    repository().join("profiles/applications/target_following.xml")
}

/// It has arrived, and for every blow there is a fault of that component and kind, in order, that
/// was recovered from. What a busy machine is late with may be a fault as well. The last blows came
/// while it ended.
#[track_caller]
fn is_accounted_for(outcome: &Outcome, blows: &[Blow], context: &str) {
    let robot = &outcome.summary()["robot"];
    assert_eq!(robot["reached"], true, "{context}: {robot}");
    assert_eq!(robot["collisions"], 0, "{context}: {robot}");
    let verdicts = outcome.verdicts();
    for component in COMPONENTS {
        let own = blows.iter().filter(|(hit, _)| *hit == component);
        let mut seen = verdicts.iter().filter(|it| it["component"] == component);
        for (_, kind) in own {
            let verdict = seen.find(|it| it["kind"] == *kind && is_handled(it));
            assert!(
                verdict.is_some(),
                "{context}: {kind} of {component} is not on record: {blows:?}\n{:?}",
                outcome.faults(component)
            );
        }
    }
}

fn is_handled(verdict: &Value) -> bool {
    let actions = verdict["actions"].as_array();
    actions.is_some_and(|all| all.iter().any(|action| action["outcome"] == "done"))
}

/// Whether so many blows to a component are on record, and it has worked since the last of them.
fn is_back(events: &str, component: &str, blows: usize) -> bool {
    let line = |event: &str| format!("\"event\":\"{event}\",\"component\":\"{component}\"");
    let (fault, state) = (line("fault"), line("state"));
    let (mut recorded, mut works) = (0, false);
    for line in events.lines() {
        let is_blow = |(_, kind): &(Signal, &str)| line.contains(&format!("\"kind\":\"{kind}\""));
        if line.contains(&fault) && BLOWS.iter().any(is_blow) {
            recorded += 1;
            works = false;
        } else if line.contains(&state) {
            works = line.contains("\"to\":\"ACTIVE\"");
        }
    }
    works && recorded >= blows
}

/// Hits the process of a random component every half a second until the robot has arrived. Who was
/// hit is left alone until the log says that it is back.
fn sabotage(application: &Application, run: &mut Watched, chance: &mut Chance) -> Vec<Blow> {
    let mut blows: Vec<Blow> = Vec::new();
    // One that was hit may take a while to die.
    let mut seen_off = BTreeSet::new();
    let began = Instant::now();
    while began.elapsed() < LONGEST_RUN {
        std::thread::sleep(PERIOD);
        if !run.is_running() {
            break;
        }
        let events = application.events_so_far();
        let component = COMPONENTS[chance.index(COMPONENTS.len())];
        let (signal, kind) = BLOWS[chance.index(BLOWS.len())];
        let own = blows.iter().filter(|(hit, _)| *hit == component).count();
        let has_arrived = events.contains("\"event\":\"target_reached\"");
        if has_arrived || !is_back(&events, component, own) {
            continue;
        }
        // The oldest is the one that runs; the others stand by.
        let hosts = run.hosts();
        let host = hosts.iter().find(|host| host.runs(component));
        if let Some(host) = host
            && seen_off.insert(host.id())
            && host.signal(signal)
        {
            blows.push((component, kind));
        }
    }
    blows
}

#[test]
fn it_arrives_though_a_process_is_hit_every_half_a_second() {
    /// Its target is near, so that the test takes a quarter of a minute.
    const NEAR: &str = "17..18";
    let seeds = std::env::var("SABOTAGE_SEEDS").unwrap_or_else(|_unset| NEAR.to_owned());
    let (first, end) = seeds.split_once("..").expect("seeds are first..end");
    let number = |text: &str| text.parse::<u64>().expect("a seed is a number");
    for seed in number(first)..number(end) {
        let application = Application::new();
        let (rules, number) = (rules().display().to_string(), seed.to_string());
        let arguments = [
            "--clock", "real", "--for", LIMIT, "--seed", &number, "--rules", &rules,
        ];
        let mut run = application.start_files(&[profile()], &arguments);
        let mut blows = sabotage(&application, &mut run, &mut Chance::new(seed));
        let finished = run.wait(Duration::from_secs(1));
        let outcome = application.outcome(finished).ended_well();
        assert!(blows.len() >= 10, "hardly any sabotage: {blows:?}");
        // The last two may have come while it stopped.
        blows.truncate(blows.len() - 2);
        is_accounted_for(&outcome, &blows, &format!("seed {seed}"));
        println!("seed {seed}: {} blows", blows.len());
    }
}

/// Traps of random components, one every half a second.
fn traps(chance: &mut Chance) -> Vec<(u64, &'static str, Blow)> {
    let period = u64::try_from(PERIOD.as_millis()).expect("half a second");
    (1..240)
        .map(|number| {
            let component = COMPONENTS[chance.index(COMPONENTS.len())];
            let (fault, kind) = TRAPS[chance.index(TRAPS.len())];
            (number * period, fault, (component, kind))
        })
        .collect()
}

/// The same rules, but everything stays in the container.
#[test]
fn it_arrives_though_something_traps_behind_the_guard_every_half_a_second() {
    let shipped = std::fs::read_to_string(rules()).expect("the rules are shipped");
    let guarded = shipped.replace(">process<", ">guarded<");
    assert_ne!(shipped, guarded);
    for seed in 0..20 {
        let application = Application::new();
        let traps = traps(&mut Chance::new(seed));
        let inject = |(at_ms, fault, (component, _)): &(u64, &str, Blow)| {
            format!("<inject at='{at_ms}ms' component='{component}' fault='{fault}'/>\n")
        };
        let injections: String = traps.iter().map(inject).collect();
        let injections = application.write(
            "injections.xml",
            format!(
                "<fault_injections application='target_following'>{injections}</fault_injections>"
            ),
        );
        let rules = application.write("rules.xml", &guarded);
        let path = |path: PathBuf| path.display().to_string();
        let (rules, injections, number) = (path(rules), path(injections), seed.to_string());
        let arguments = [
            "--clock",
            "simulated",
            "--for",
            LIMIT,
            "--seed",
            &number,
            "--rules",
            &rules,
            "--inject",
            &injections,
        ];
        let outcome = application.run_file(&profile(), &arguments).ended_well();
        let ended = outcome.summary()["robot"]["time_s"].as_f64();
        let last = outcome.all_events().last().expect("there are events");
        let ended_ms = last["t_ns"].as_u64().expect("a time") / 1_000_000;
        let begun = traps.iter().filter(|(at_ms, ..)| at_ms + 1_000 < ended_ms);
        let blows: Vec<Blow> = begun.map(|(_, _, blow)| *blow).collect();
        assert!(
            blows.len() >= 10,
            "hardly any sabotage: {ended:?} {blows:?}"
        );
        is_accounted_for(&outcome, &blows, &format!("seed {seed}"));
    }
}
