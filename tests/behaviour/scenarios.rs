//! The scenarios that are shipped end as `rules/scenarios/README.md` says.

use std::path::PathBuf;

use serde_json::Value;
use tests::{Application, Outcome, repository, take_turn};

/// The slowest drive with three sonars needs 100 s of robot time.
const LIMIT: &str = "150s";

/// Where the robot stands still for ever, it need not be watched that long.
const SHORT: &str = "10s";

const SEEDS: std::ops::RangeInclusive<u64> = 1..=20;

/// A seed whose target is near, for real time.
const NEAR_SEED: u64 = 17;

/// A scenario and its end.
struct Scenario {
    folder: &'static str,
    application: &'static str,
    /// Kind of fault and component of every root cause, in order.
    faults: &'static [(&'static str, &'static str)],
    /// What was done, in order.
    actions: &'static [&'static str],
    /// What is to be known of what was done.
    notes: &'static [&'static str],
    /// Components that are not as they were at the start: state and incarnation.
    changed: &'static [(&'static str, &'static str, u64)],
    reaches_target: bool,
}

const UNPLUGGED_SONAR: Scenario = Scenario {
    folder: "unplugged_sonar",
    application: "target_following",
    faults: &[("out_of_range", "left_sonar"); 3],
    actions: &[
        "reset left_sonar: done",
        "reset left_sonar: done",
        "stop left_sonar: done",
    ],
    notes: &[],
    changed: &[("left_sonar", "INACTIVE", 3)],
    reaches_target: true,
};

const CRASH_RESTORED_BY_RESET: Scenario = Scenario {
    folder: "crash_restored_by_reset",
    application: "target_following",
    faults: &[("segfault", "obstacle_avoidance")],
    actions: &["reset obstacle_avoidance: done"],
    notes: &["checkpoint"],
    changed: &[("obstacle_avoidance", "ACTIVE", 2)],
    reaches_target: true,
};

const CRASH_REPLACED_BY_SECONDARY: Scenario = Scenario {
    folder: "crash_replaced_by_secondary",
    application: "target_following",
    faults: &[("segfault", "obstacle_avoidance"); 3],
    actions: &[
        "reset obstacle_avoidance: done",
        "reset obstacle_avoidance: done",
        "replace obstacle_avoidance by obstacle_avoidance_simple: done",
    ],
    notes: &["checkpoint", "checkpoint", "by a warm standby"],
    changed: &[("obstacle_avoidance", "ACTIVE", 4)],
    reaches_target: true,
};

const MOTOR_DRIVER_WITHOUT_POWER: Scenario = Scenario {
    folder: "motor_driver_without_power",
    application: "target_following",
    faults: &[("process_model", "motor_driver")],
    actions: &["emergency stop: done"],
    notes: &["every actuator was told"],
    changed: &[("motor_driver", "INACTIVE", 1)],
    reaches_target: false,
};

const LYING_SONAR: Scenario = Scenario {
    folder: "lying_sonar",
    application: "redundant_sonars",
    faults: &[("voting_dissent", "front_sonar_2"); 2],
    actions: &["reset front_sonar_2: done", "stop front_sonar_2: done"],
    notes: &[],
    changed: &[("front_sonar_2", "INACTIVE", 2)],
    reaches_target: true,
};

const HANGING_COMPONENT: Scenario = Scenario {
    folder: "hanging_component",
    application: "target_following",
    faults: &[("heartbeat_missed", "path_planner")],
    actions: &["reset path_planner: done"],
    notes: &["checkpoint"],
    changed: &[("path_planner", "ACTIVE", 2)],
    reaches_target: true,
};

impl Scenario {
    fn run(&self, clock: &str, seed: u64) -> Outcome {
        let root = repository();
        let folder = root.join("rules/scenarios").join(self.folder);
        let file = |name: &str| folder.join(name).display().to_string();
        let (rules, injections) = (file("rules.xml"), file("injections.xml"));
        let limit = if self.reaches_target { LIMIT } else { SHORT };
        let seed = seed.to_string();
        let arguments = [
            "--clock",
            clock,
            "--for",
            limit,
            "--seed",
            &seed,
            "--rules",
            &rules,
            "--inject",
            &injections,
        ];
        let profile: PathBuf = root.join(format!("profiles/applications/{}.xml", self.application));
        Application::new()
            .run_file(&profile, &arguments)
            .ended_well()
    }

    /// In real time the scenario's own component is looked at: a machine that has other things to
    /// do may make another one late, which is a fault as well.
    #[track_caller]
    fn check_in_real_time(&self, outcome: &Outcome) {
        let context = format!("{} in real time", self.folder);
        let is_own = |verdict: &&Value| {
            let component = word(&verdict["component"]);
            self.faults.iter().any(|(_, own)| *own == component)
        };
        let mut verdicts = outcome.verdicts();
        verdicts.retain(|verdict| verdict["cause"] == "root" && is_own(verdict));
        let faults: Vec<(&str, &str)> = verdicts
            .iter()
            .map(|it| (word(&it["kind"]), word(&it["component"])))
            .collect();
        assert_eq!(faults, self.faults, "{context}");
        let actions = verdicts.iter().filter_map(|it| it["actions"].as_array());
        let actions: Vec<String> = actions
            .flatten()
            .map(|it| format!("{}: {}", word(&it["action"]), word(&it["outcome"])))
            .collect();
        assert_eq!(actions, self.actions, "{context}");
        for verdict in &verdicts {
            for time in ["detection_us", "decision_us", "handling_us"] {
                assert!(verdict[time].is_u64(), "{context}: {time} of {verdict}");
            }
        }
        for (name, state, incarnation) in self.changed {
            let component = outcome.component(name);
            assert_eq!(component["state"], *state, "{context}: {name}");
            assert_eq!(component["incarnation"], *incarnation, "{context}: {name}");
        }
    }

    /// It ends as it should; how soon is not asked.
    #[track_caller]
    fn check(&self, outcome: &Outcome, context: &str) {
        let context = format!("{} {context}", self.folder);
        let mut verdicts = outcome.verdicts();
        verdicts.retain(|verdict| verdict["cause"] == "root");
        let faults: Vec<(&str, &str)> = verdicts
            .iter()
            .map(|it| (word(&it["kind"]), word(&it["component"])))
            .collect();
        assert_eq!(faults, self.faults, "{context}");
        for verdict in &verdicts {
            for time in ["detection_us", "decision_us", "handling_us"] {
                assert!(verdict[time].is_u64(), "{context}: {time} of {verdict}");
            }
        }
        assert_eq!(outcome.actions(), self.actions, "{context}");
        let notes = outcome.notes();
        assert_eq!(notes.len(), self.notes.len(), "{context}: {notes:?}");
        for (note, expected) in notes.iter().zip(self.notes) {
            assert!(note.contains(expected), "{context}: {note}");
        }
        let components = outcome.summary()["components"].as_object();
        for (name, component) in components.expect("there are components") {
            let changed = self.changed.iter().find(|(changed, ..)| changed == name);
            let (state, incarnation) = changed.map_or(("ACTIVE", 1), |(_, state, incarnation)| {
                (*state, *incarnation)
            });
            assert_eq!(component["state"], state, "{context}: {name}");
            assert_eq!(component["incarnation"], incarnation, "{context}: {name}");
        }
        let robot = &outcome.summary()["robot"];
        assert_eq!(robot["reached"], self.reaches_target, "{context}: {robot}");
        assert_eq!(robot["collisions"], 0, "{context}: {robot}");
    }

    fn holds_in_simulated_time(&self) {
        for seed in SEEDS {
            let outcome = self.run("simulated", seed);
            self.check(&outcome, &format!("with seed {seed}"));
            if seed == *SEEDS.start() {
                let again = self.run("simulated", seed);
                assert!(
                    outcome.raw_events() == again.raw_events(),
                    "{}: the events of a seed differ from run to run",
                    self.folder
                );
            }
        }
    }
}

fn word(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

#[test]
fn an_unplugged_sonar_is_stopped() {
    UNPLUGGED_SONAR.holds_in_simulated_time();
}

#[test]
fn a_crash_is_restored_by_a_reset() {
    CRASH_RESTORED_BY_RESET.holds_in_simulated_time();
}

#[test]
fn a_crash_again_and_again_is_replaced_by_the_secondary() {
    CRASH_REPLACED_BY_SECONDARY.holds_in_simulated_time();
}

#[test]
fn a_motor_driver_without_power_ends_in_an_emergency_stop() {
    MOTOR_DRIVER_WITHOUT_POWER.holds_in_simulated_time();
}

#[test]
fn a_lying_sonar_is_outvoted() {
    LYING_SONAR.holds_in_simulated_time();
}

#[test]
fn a_hanging_component_is_found_by_its_heartbeat() {
    HANGING_COMPONENT.holds_in_simulated_time();
}

/// One after the other: the machine has other tests to run meanwhile.
#[test]
fn in_real_time() {
    let _turn = take_turn();
    for scenario in [
        UNPLUGGED_SONAR,
        CRASH_RESTORED_BY_RESET,
        CRASH_REPLACED_BY_SECONDARY,
        MOTOR_DRIVER_WITHOUT_POWER,
        LYING_SONAR,
        HANGING_COMPONENT,
    ] {
        let outcome = scenario.run("real", NEAR_SEED);
        scenario.check_in_real_time(&outcome);
    }
}
