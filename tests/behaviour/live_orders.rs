//! `steadfast status` and `steadfast component`: an operator looks at a running application, and has
//! components reset, replaced and stopped.

use std::time::Duration;

use serde_json::{Value, json};
use tests::{Application, Member, Operator, until};

/// A counter with a secondary, whose numbers are recorded. The recorder needs the counter.
fn application() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .with_profile(&Member::new("spare", "counter"))
        .connect("data", "counter.output", "recorder.input")
        .rules(
            "<component name='counter'>
               <fault><secondary preload='warm'><reference>spare.xml</reference></secondary></fault>
             </component>
             <dependency><name>recorder</name><reference>counter</reference></dependency>",
        )
}

/// One component, as `status` has it.
fn component(operator: &Operator, name: &str) -> Value {
    operator.json(&["status"])["status"]["components"][name].clone()
}

#[test]
fn a_status_tells_how_components_and_container_are() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    operator.socket();
    let measured = || component(&operator, "counter")["rate_hz"].as_f64() > Some(1.0);
    assert!(until(Duration::from_secs(60), measured), "it has no rate");
    let status = operator.json(&["status"])["status"].clone();
    let container = &status["container"];
    assert_eq!(container["process"], json!(run.id().as_raw_nonzero().get()));
    assert!(container["threads"].as_u64() > Some(3), "{container}");
    assert_eq!(container["restarts"], 0);
    let counter = &status["components"]["counter"];
    for (key, expected) in [
        ("application", json!("application")),
        ("level", json!("OK")),
        ("state", json!("ACTIVE")),
        ("tier", json!("guarded")),
        ("condition", json!("working")),
        ("open_faults", json!(0)),
        ("executor", json!("counter")),
        ("execution", json!("periodic")),
        ("incarnation", json!(1)),
        (
            "standbys",
            json!([{"of": "spare", "preload": "warm", "ready": true}]),
        ),
    ] {
        assert_eq!(counter[key], expected, "{key}");
    }
    let period_ms = counter["period_ms"].as_f64().expect("it has a period");
    let load_percent = counter["load_percent"].as_f64().expect("it has a load");
    assert!(
        period_ms > 0.0 && (0.0..100.0).contains(&load_percent),
        "{counter}"
    );
    let text = operator.run(&["status"]);
    assert_eq!(text.code, Some(0), "{text}");
    assert!(text.stdout.contains("counter    OK     ACTIVE"), "{text}");
    let info = operator.json(&["component", "info", "recorder"])["component"].clone();
    assert_eq!(info["ports"][0]["connected"], json!(["counter.output"]));
    assert!(
        info["library"]
            .as_str()
            .is_some_and(|it| it.ends_with(".so")),
        "{info}"
    );
    let listed = operator.json(&["component", "list"])["components"].clone();
    assert_eq!(listed.as_object().map(serde_json::Map::len), Some(2));
    let _outcome = application.interrupt(run).ended_well();
}

#[test]
fn orders_are_carried_out_and_leave_verdicts() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    operator.socket();
    let order = |arguments: &[&str]| operator.json(&[&["component"], arguments].concat());
    let done = order(&["reset", "counter"]);
    assert_eq!(done["outcome"], "done");
    assert_eq!(done["fault"]["kind"], "operator_order");
    assert_eq!(done["fault"]["evidence"]["order"]["order"], "reset counter");
    assert_eq!(component(&operator, "counter")["incarnation"], 2);
    order(&["replace", "counter", "--with", "spare"]);
    let counter = component(&operator, "counter");
    assert_eq!(
        (&counter["incarnation"], &counter["runs"]),
        (&json!(3), &json!("spare"))
    );
    let stopped = order(&["stop", "counter"]);
    let actions = stopped["fault"]["actions"].as_array().map(Vec::len);
    assert_eq!(actions, Some(2), "the recorder needs it: {stopped}");
    for name in ["counter", "recorder"] {
        let one = component(&operator, name);
        assert_eq!(
            (&one["state"], &one["level"]),
            (&json!("INACTIVE"), &json!("STALE"))
        );
    }
    order(&["reset", "counter"]);
    order(&["reset", "recorder"]);
    for name in ["counter", "recorder"] {
        assert_eq!(component(&operator, name)["level"], "OK", "{name}");
    }
    let outcome = application.interrupt(run).ended_well();
    let on_record =
        |event: &&Value| event["event"] == "verdict" && event["kind"] == "operator_order";
    let ids = outcome.all_events().iter().filter(on_record);
    let ids: std::collections::BTreeSet<u64> = ids.filter_map(|it| it["id"].as_u64()).collect();
    assert_eq!(ids, (1..=5).collect());
    assert_eq!(
        outcome.component("counter")["faults"],
        0,
        "an order is no fault"
    );
}

#[test]
fn orders_that_make_no_sense_are_refused_with_a_reason() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    operator.socket();
    operator.json(&["component", "stop", "recorder"]);
    operator.json(&["component", "stop", "counter"]);
    for (arguments, reason) in [
        (
            &["reset", "countre"][..],
            "there is no component 'countre'; there are: counter",
        ),
        (&["info", "countre"], "there is no component 'countre'"),
        (&["stop", "counter"], "counter is stopped already"),
        (
            &["reset", "recorder"],
            "recorder needs counter; reset that first",
        ),
        (
            &["replace", "counter", "--with", "other"],
            "there are: spare",
        ),
        (&["replace", "recorder"], "no secondary"),
    ] {
        let finished = operator.run(&[&["component"], arguments].concat());
        assert_eq!(finished.code, Some(1), "{finished}");
        assert!(finished.stderr.contains(reason), "{reason}: {finished}");
    }
    let _outcome = application.interrupt(run).ended_well();
    let gone = operator.run(&["status"]);
    assert_eq!(gone.code, Some(2), "{gone}");
    assert!(gone.stderr.contains("no application is running"), "{gone}");
}
