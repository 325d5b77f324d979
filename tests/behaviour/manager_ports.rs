//! The fault manager as a component: it is told of faults by events, and raises events of its own.

use serde_json::Value;
use tests::{Application, Member, Outcome};

/// A sentry that hears everything, and a diary whose faults are given to it.
fn application(reports_at: u64) -> Application {
    let sentry = Member::new("sentry", "sentry").property("reports_at", &reports_at.to_string());
    Application::new()
        .with(&sentry)
        .with(&Member::new("counter", "counter"))
        .connect("event", "fault_manager.fault", "sentry.fault")
        .connect(
            "event",
            "fault_manager.emergency_stop",
            "sentry.emergency_stop",
        )
        .connect("event", "sentry.alarm", "fault_manager.fault")
}

const SIMULATED: [&str; 4] = ["--clock", "simulated", "--for", "1s"];

/// Runs it with a counter that panics at half a second, and that much severity.
fn run(severity: &str) -> Outcome {
    let application = application(0);
    let rules = format!(
        "<fault_rules application='application'>
           <component name='counter'><severity>{severity}</severity></component>
         </fault_rules>"
    );
    let rules = application.write("rules.xml", rules).display().to_string();
    let inject = application.write(
        "injections.xml",
        "<fault_injections application='application'>
           <inject at='500ms' component='counter' fault='panic'/>
         </fault_injections>",
    );
    let inject = inject.display().to_string();
    let files = ["--rules", &rules, "--inject", &inject];
    application
        .run(&[&SIMULATED[..], &files].concat())
        .ended_well()
}

/// The last verdict about the component.
fn last_verdict<'run>(outcome: &'run Outcome, component: &str) -> Option<&'run Value> {
    outcome.events("verdict", component).into_iter().last()
}

#[test]
fn a_confirmed_fault_is_raised_once() {
    let outcome = run("reset");
    assert!(last_verdict(&outcome, "counter").is_some());
    assert_eq!(outcome.logs("sentry"), ["a fault"]);
    let heard = outcome.events("log", "sentry")[0]["t_ns"].as_u64();
    assert!(
        heard.is_some_and(|time| (500_000_000..=510_000_000).contains(&time)),
        "in the next cycle: {heard:?}"
    );
}

#[test]
fn an_emergency_stop_is_raised_too() {
    let mut logs = run("emergency").logs("sentry");
    logs.sort();
    assert_eq!(logs, ["a fault", "an emergency stop"]);
}

#[test]
fn an_event_that_reaches_the_fault_manager_is_a_fault_of_its_sender() {
    let application = application(30);
    let outcome = application.run(&SIMULATED).ended_well();
    let verdict = last_verdict(&outcome, "sentry").expect("it is judged");
    assert_eq!(verdict["kind"], "reported");
    assert_eq!(verdict["cause"], "root");
    assert!(
        verdict["evidence"].to_string().contains("alarm"),
        "{verdict}"
    );
    assert!(verdict["rule"].is_null(), "by the default");
    assert_eq!(outcome.component("counter")["faults"], 0);
    let rules = application.write(
        "rules.xml",
        "<fault_rules application='application'>
           <component name='sentry'>
             <fault_event port='alarm' name='alarm' severity='ignore'/>
           </component>
         </fault_rules>",
    );
    let rules = rules.display().to_string();
    let outcome = application
        .run(&[&SIMULATED[..], &["--rules", &rules]].concat())
        .ended_well();
    let judged = last_verdict(&outcome, "sentry").expect("it is judged");
    assert_eq!(judged["severity"], "ignore");
    assert!(
        judged["rule"]
            .as_str()
            .is_some_and(|rule| rule.contains("rules.xml"))
    );
    assert_eq!(outcome.component("sentry")["incarnation"], 1);
}

#[test]
fn connections_that_the_fault_manager_does_not_have_are_refused() {
    let herald = Member::new("herald", "herald");
    for (kind, source, target, words) in [
        (
            "event",
            "herald.news",
            "fault_manager.fault",
            "carries `Sample`",
        ),
        (
            "event",
            "fault_manager.smoke",
            "sentry.fault",
            "no output `smoke`",
        ),
        (
            "event",
            "sentry.alarm",
            "fault_manager.emergency_stop",
            "no input `emergency_stop`",
        ),
        (
            "data",
            "fault_manager.fault",
            "sentry.fault",
            "port_type=\"event\"",
        ),
        (
            "event",
            "fault_manager.fault",
            "sentry.alarm",
            "an output event port",
        ),
        (
            "event",
            "fault_manager.fault",
            "fault_manager.fault",
            "needs no telling",
        ),
        (
            "event",
            "sentry.alarm",
            "fault_manager.fault",
            "already made",
        ),
    ] {
        let application = application(0).with(&herald).connect(kind, source, target);
        application.run(&SIMULATED).was_refused(1, &[words]);
    }
    let taken = Application::new().with(&Member::new("fault_manager", "counter"));
    taken
        .run(&SIMULATED)
        .was_refused(1, &["the fault manager's own name"]);
}
