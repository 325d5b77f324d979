//! A task that fails though every component runs is done in another way.

use serde_json::Value;
use tests::{Application, Member, Outcome};

/// What stands in the way of the data of the task, as a task file has it: instances of the optional
/// components with what they need.
struct Task {
    optional: Vec<(&'static str, String)>,
    worker: String,
    rest: String,
}

impl Task {
    /// Data go from `source` to `worker`, through one of the optional components if need be. The
    /// worker's error is the value that it writes, and may be 10.
    fn new() -> Self {
        Self {
            optional: Vec::new(),
            worker: "<evaluator port='output' field='value' scale='10'/>".to_owned(),
            rest: String::new(),
        }
    }

    fn with(mut self, name: &'static str, instance: &str) -> Self {
        self.optional.push((name, instance.to_owned()));
        self
    }

    fn text(&self) -> String {
        let each = |write: &dyn Fn(&str, &str) -> String| -> String {
            let all = self.optional.iter();
            all.map(|(name, instance)| write(name, instance)).collect()
        };
        let components = each(&|name, _| {
            format!("<component name='{name}' class='computation' essential='false'/>")
        });
        let through = each(&|name, _| format!("<through component='{name}' output='output'/>"));
        let exclusion = each(&|name, _| format!("<use component='{name}'/>"));
        let exclusion = match self.optional.len() {
            0 | 1 => String::new(),
            _ => format!("<exclusions><exclusion>{exclusion}</exclusion></exclusions>"),
        };
        let instances =
            each(&|name, instance| format!("<instance component='{name}'>{instance}</instance>"));
        format!(
            "<task_profile name='test'>
               <resources><resource name='power'/></resources>
               <sub_tasks><sub_task name='work'>
                 <component name='source' class='sensor'/>{components}
                 <component name='worker' class='computation'/>
               </sub_task></sub_tasks>
               <state_machine initial='working'><state name='working'><run sub_task='work'/></state></state_machine>
               <links><link from='source' to='worker'>{through}</link></links>{exclusion}
               <robots><robot name='R1'><has resource='power' amount='10'/>
                 <instance component='source'/>{instances}
                 <instance component='worker'>{}</instance>
               </robot></robots>
               <quality functional_threshold='0.1' non_functional_threshold='0.05'/>
               <generation running='left_out'/>
               <decision confirm='1' dwell='100ms' evaluation_period='5ms' reconfiguration_deadline='100ms'/>
               <running><use component='source' robot='R1'/><use component='worker' robot='R1'/></running>
               {}
             </task_profile>",
            self.worker, self.rest
        )
    }
}

/// A source whose values grow by 1 every 10 ms, a worker that sends them on, and refiners.
fn application(task: &Task, refiners: &[Member]) -> Application {
    let mut application = Application::new().with(&Member::new("source", "counter").priority(9));
    for refiner in refiners {
        application = application.with(refiner);
    }
    let application = application
        .with(&Member::new("worker", "echo").queue("LAST", 1))
        .connect("data", "source.output", "worker.input")
        .rules("<adapt task='task.xml'/>");
    application.write("task.xml", task.text());
    application
}

fn refiner(name: &str, gain: &str) -> Member {
    let refiner = Member::new(name, "refiner").priority(5);
    refiner.queue("LAST", 1).property("gain", gain)
}

fn decisions(outcome: &Outcome) -> Vec<&Value> {
    let events = outcome.all_events().iter();
    events
        .filter(|event| event["event"] == "adaptation")
        .collect()
}

fn rejection(decision: &Value, number: usize) -> &str {
    let reason = &decision["candidates"][number - 1]["rejected_because"];
    reason.as_str().unwrap_or_default()
}

/// Two alternatives: the better one takes its place among the data, and the error is small again.
#[test]
fn a_task_that_fails_is_done_by_the_better_alternative() {
    let task = Task::new()
        .with("rough", "<needs resource='power' amount='1'/>")
        .with("fine", "<needs resource='power' amount='1'/>");
    let refiners = [refiner("rough", "0.5"), refiner("fine", "0.01")];
    let outcome = application(&task, &refiners).simulate("300ms").ended_well();
    let decisions = decisions(&outcome);
    assert_eq!(decisions.len(), 1, "{decisions:#?}");
    let decision = decisions[0];
    assert_eq!(decision["outcome"], "changed", "{decision:#}");
    assert_eq!(
        decision["candidates"][1]["components"],
        serde_json::json!(["R1:source", "R1:fine", "R1:worker"])
    );
    assert_eq!(decision["chosen"], 2);
    assert!(
        rejection(decision, 1).contains("candidate 2"),
        "{decision:#}"
    );
    assert_eq!(outcome.states("rough"), ["READY", "DESTROYED"]);
    assert_eq!(outcome.component("rough")["cycles"], 0);
    assert!(outcome.cycles("fine") > 15);
    assert_eq!(outcome.application()["state"], "ACTIVE");
}

/// Estimators that crash, hang or lie, and one that says nothing: each candidate is out, with the
/// reason on record, and nothing of it disturbs what runs.
#[test]
fn an_estimator_that_misbehaves_puts_its_candidate_out() {
    let own = |scale: &str| format!("<estimator port='expected' field='value' cycles='{scale}'/>");
    let task = Task::new()
        .with("crasher", "")
        .with("hanger", "")
        .with("mute", &own("2"))
        .with("liar", &own("1"))
        .with("boaster", &own("1"))
        .with("fine", &own("3"));
    let misbehaving = |name: &str, how: &str| {
        let refiner = refiner(name, "0.01").property("misbehaves_in", "1");
        refiner.property("how", how)
    };
    let refiners = [
        misbehaving("crasher", "panics"),
        misbehaving("hanger", "hangs"),
        misbehaving("mute", "is_silent"),
        refiner("liar", "0.01").property("expects", "NaN"),
        refiner("boaster", "0.01").property("expects", "-1"),
        refiner("fine", "0.01"),
    ];
    let outcome = application(&task, &refiners).simulate("200ms").ended_well();
    let decisions = decisions(&outcome);
    let decision = decisions[0];
    assert_eq!(decision["chosen"], 6, "{decision:#}");
    for (number, words) in [
        (1, "'crasher': panic in onExecute: told to"),
        (2, "'hanger': hang in onExecute"),
        (3, "'mute' wrote nothing to 'expected'"),
        (4, "an estimate of R1:liar is not a number"),
        (5, "an estimate of R1:boaster is negative"),
    ] {
        let reason = rejection(decision, number);
        assert!(reason.contains(words), "{number}: {reason}");
        assert_eq!(decision["candidates"][number - 1]["feasible"], false);
    }
    for name in ["crasher", "hanger", "mute", "liar", "boaster"] {
        assert_eq!(outcome.states(name), ["READY", "DESTROYED"], "{name}");
        assert_eq!(outcome.component(name)["faults"], 0, "{name}");
    }
    assert_eq!(outcome.cycles("source"), 20);
    assert_eq!(outcome.cycles("worker"), 20);
}

/// The best one fails after the change: what ran goes on meanwhile, and the next best is taken.
#[test]
fn a_candidate_that_fails_after_the_change_is_taken_back() {
    for (how, words) in [
        ("panics", "'best' failed: panic in onExecute"),
        ("fails", "'best' failed: error_return in onExecute"),
        ("makes_worse", "it was not done after 100ms"),
    ] {
        let task = Task::new().with("best", "").with("second", "");
        let best = refiner("best", "0.01").property("misbehaves_in", "2");
        let refiners = [best.property("how", how), refiner("second", "0.1")];
        let outcome = application(&task, &refiners).simulate("400ms").ended_well();
        let decisions = decisions(&outcome);
        assert_eq!(decisions[0]["chosen"], 2, "{how}: {:#}", decisions[0]);
        let reason = rejection(decisions[0], 1);
        assert!(reason.contains(words), "{how}: {reason}");
        assert_ne!(outcome.component("best")["state"], "ACTIVE", "{how}");
        assert_eq!(outcome.component("second")["state"], "ACTIVE", "{how}");
    }
}

/// Nothing helps: what runs goes on, and the nearest candidate is named with what it lacks.
#[test]
fn where_no_candidate_will_do_what_runs_goes_on() {
    let task = Task::new()
        .with("weak", "<needs resource='power' amount='1'/>")
        .with("greedy", "<needs resource='power' amount='11'/>");
    let refiners = [refiner("weak", "1"), refiner("greedy", "0.01")];
    let outcome = application(&task, &refiners).simulate("150ms").ended_well();
    let decisions = decisions(&outcome);
    let decision = decisions[0];
    assert_eq!(decision["outcome"], "no_candidate", "{decision:#}");
    let reason = rejection(decision, 2);
    assert!(reason.contains("R1 has 10 of power, 11 needed"), "{reason}");
    assert!(decision["nearest"][1].is_string(), "{decision:#}");
    assert_eq!(outcome.cycles("worker"), 15);
    assert_eq!(outcome.states("weak"), ["READY", "DESTROYED"]);
}

/// A component of the task crashes again and again: when resets are used up the task goes on
/// without it.
#[test]
fn the_last_rung_of_a_rule_is_to_go_on_without_the_component() {
    let task = Task::new().with("filter", "").with("other", "");
    let text = task.text();
    let text = text.replace(
        "<use component='source' robot='R1'/>",
        "<use component='source' robot='R1'/><use component='filter' robot='R1'/>",
    );
    let crashing = refiner("filter", "0.01").property("misbehaves_in", "3");
    let application = Application::new()
        .with(&Member::new("source", "counter").priority(9))
        .with(&crashing.property("how", "panics"))
        .with(&refiner("other", "0.02"))
        .with(&Member::new("worker", "echo").queue("LAST", 1))
        .connect("data", "source.output", "filter.input")
        .connect("data", "filter.output", "worker.input")
        .rules(
            "<component name='filter'><fault retry_max='1'><severity>global</severity></fault>\
             <adapt task='task.xml'/></component>",
        );
    application.write("task.xml", text);
    let outcome = application.simulate("300ms").ended_well();
    assert_eq!(
        outcome.actions(),
        ["reset filter: done", "do the task without filter: done"]
    );
    let decisions = decisions(&outcome);
    assert_eq!(decisions[0]["trigger"], "lost", "{:#}", decisions[0]);
    assert_eq!(decisions[0]["outcome"], "changed");
    assert_eq!(outcome.component("filter")["state"], "ERROR");
    assert_eq!(outcome.component("worker")["state"], "ACTIVE");
}

/// The same in real time, where the adaptation has a thread of its own.
#[test]
fn a_task_is_done_in_another_way_in_real_time_too() {
    let task = Task::new().with("fine", "<measured resource='power' by='processor_load'/>");
    let refiners = [refiner("fine", "0.01")];
    let outcome = application(&task, &refiners).run_really("2s").ended_well();
    let decisions = decisions(&outcome);
    assert_eq!(decisions[0]["outcome"], "changed", "{:#}", decisions[0]);
    assert_eq!(outcome.component("fine")["state"], "ACTIVE");
}

/// A task that names what the application does not have is refused before anything runs.
#[test]
fn a_task_that_does_not_fit_its_application_is_refused() {
    let task = Task::new().with("missing", "");
    let outcome = application(&task, &[]).simulate("50ms");
    outcome.was_refused(
        4,
        &["the application has no component 'missing'", "there are"],
    );
}
