//! One of two robots that do a task together is killed: the other one decides again, and goes on or stops
//! safely where nothing is left that could do the task.

use std::path::{Path, PathBuf};

use rustix::process::Signal;
use serde_json::Value;
use tests::{Application, Watched, repository, take_turn};

use crate::two_robots::{ROBOTS, search_paths};
use crate::visual_servoing::robots_at;

/// Two containers that have changed over to the dehazer of the second.
struct Pair {
    first: Application,
    second: Application,
    files: [PathBuf; 2],
    rules: [PathBuf; 2],
    running: [Option<Watched>; 2],
}

impl Pair {
    /// Starts both and waits for the change. The battery of the first gives so many watts.
    fn changed_over(power: u32) -> Self {
        let (first, second) = (Application::new(), Application::new());
        let files = robots_at(&first, ROBOTS);
        let task = shipped("profiles/tasks/visual_servoing_two_robots.xml");
        let low = "resource=\"power\" amount=\"8\"";
        assert!(task.contains(low), "the battery of the first robot is low");
        let power = format!("resource=\"power\" amount=\"{power}\"");
        let task = first.write("task.xml", task.replacen(low, &power, 1));
        let rules = ROBOTS.map(|robot| {
            let name = format!("rules/{robot}.xml");
            let text = shipped(&name);
            let shipped = "../profiles/tasks/visual_servoing_two_robots.xml";
            assert!(text.contains(shipped), "{name} attaches the task");
            let task = task.display().to_string();
            first.write(&format!("{robot}_rules.xml"), text.replace(shipped, &task))
        });
        let mut pair = Self {
            first,
            second,
            files,
            rules,
            running: [None, None],
        };
        pair.start(1);
        pair.second
            .wait_until(|events| events.contains("\"to\":\"READY\""));
        pair.start(0);
        pair.first
            .wait_until(|events| !decisions(events, "evaluated").is_empty());
        let decision = decisions(&pair.first.events_so_far(), "evaluated").remove(0);
        assert_eq!(decision["chosen"], 9, "{decision:#}");
        pair
    }

    fn start(&mut self, robot: usize) {
        let application = [&self.first, &self.second][robot];
        let (paths, rules) = (search_paths(), self.rules[robot].display().to_string());
        let mut arguments: Vec<&str> = paths.iter().map(String::as_str).collect();
        arguments.extend(["--rules", &rules]);
        let file = self.files[robot].clone();
        self.running[robot] = Some(application.start_files(&[file], &arguments));
    }

    fn kill(&mut self, robot: usize) {
        let killed = self.running[robot].take().expect("it runs");
        killed.signal(Signal::KILL);
    }
}

fn shipped(name: &str) -> String {
    let file: &Path = &repository().join(name);
    std::fs::read_to_string(file).expect("a shipped file")
}

fn decisions(events: &str, trigger: &str) -> Vec<Value> {
    let events = events.lines();
    let events = events.filter_map(|line| serde_json::from_str::<Value>(line).ok());
    events
        .filter(|event| event["event"] == "adaptation" && event["trigger"] == trigger)
        .collect()
}

/// What was decided upon the death of a robot, once it is.
fn after_death(application: &Application) -> Value {
    application.wait_until(|events| !decisions(events, "lost").is_empty());
    decisions(&application.events_so_far(), "lost").remove(0)
}

/// The components that run from a decision on.
fn chosen(decision: &Value) -> String {
    let candidates = decision["candidates"].as_array().expect("candidates");
    let mut candidates = candidates.iter();
    let chosen = candidates.find(|it| it["number"] == decision["chosen"]);
    chosen.expect("a choice")["components"].to_string()
}

fn went(events: &str, component: &str, from: &str, to: &str) -> bool {
    events.contains(&format!(
        "\"component\":\"{component}\",\"from\":\"{from}\",\"to\":\"{to}\""
    ))
}

#[test]
fn where_nothing_is_left_that_could_do_the_task_the_robot_stops() {
    let _turn = take_turn();
    let mut pair = Pair::changed_over(8);
    pair.kill(1);
    let decision = after_death(&pair.first);
    assert_eq!(decision["outcome"], "no_candidate", "{decision:#}");
    let nearest = decision["nearest"].to_string();
    assert!(nearest.contains("R1 has 8 W of power"), "{decision:#}");
    pair.first
        .wait_until(|events| went(events, "robot_motor", "ACTIVE", "INACTIVE"));
    let run = pair.running[0].take().expect("it goes on");
    let outcome = pair.first.interrupt(run).ended_well();
    let stopped = outcome.verdicts().into_iter().any(|verdict| {
        verdict["component"] == "robot_motor" && verdict.to_string().contains("emergency")
    });
    assert!(stopped, "{:#?}", outcome.verdicts());
}

#[test]
fn where_there_is_another_way_the_task_goes_on_without_the_dead_robot() {
    let _turn = take_turn();
    let mut pair = Pair::changed_over(20);
    pair.kill(1);
    let decision = after_death(&pair.first);
    assert_eq!(decision["outcome"], "changed", "{decision:#}");
    assert!(chosen(&decision).contains("R1:Dehazer(HW)"), "{decision:#}");
    let run = pair.running[0].take().expect("it goes on");
    let outcome = pair.first.interrupt(run).ended_well();
    assert!(outcome.cycles("hardware_dehazer") > 0);
    let actions = outcome.actions();
    let is_stop = |action: &String| action.contains("emergency");
    assert!(!actions.iter().any(is_stop), "{actions:?}");
}

#[test]
fn when_the_robot_that_decides_dies_the_other_one_takes_the_task_over_and_gives_it_back() {
    let _turn = take_turn();
    let mut pair = Pair::changed_over(8);
    pair.kill(0);
    let decision = after_death(&pair.second);
    assert_eq!(decision["outcome"], "changed", "{decision:#}");
    assert!(!chosen(&decision).contains("R1:"), "{decision:#}");
    let events = pair.second.events_so_far();
    assert!(went(&events, "robot_motor", "READY", "ACTIVE"), "{events}");
    // The first robot comes back and decides, by its name: one motor runs, not two.
    pair.start(0);
    pair.second
        .wait_until(|events| went(events, "robot_motor", "ACTIVE", "INACTIVE"));
    let run = pair.running[1].take().expect("it goes on");
    let _ended = pair.second.interrupt(run).ended_well();
}
