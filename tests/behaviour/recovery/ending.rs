//! Where recovery ends: stops of exactly what depends, emergency stops, and rules that are refused.

use tests::{Application, Member, Outcome};

/// Components in a line of dependencies, `reader` on `counter` and `last` on `reader`, and two that
/// nobody mentions.
fn line(dependencies: &str) -> Outcome {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("reader", "recorder"))
        .with(&Member::new("last", "diary"))
        .with(&Member::new("other", "counter"))
        .with(&Member::new("its_reader", "recorder"))
        .connect("data", "counter.output", "reader.input")
        .connect("data", "other.output", "its_reader.input")
        .rules("<component name='counter'><severity>stop</severity></component>")
        .rules(dependencies)
        .injections("<inject at='500ms' component='counter' fault='panic'/>")
        .simulate("1s")
        .ended_well()
}

#[test]
fn exactly_what_depends_is_stopped() {
    let depends = |on: &str, severity: &str, name: &str| {
        format!("<dependency{severity}><name>{name}</name>{on}</dependency>")
    };
    let counter = "<reference>counter</reference>";
    let reader = "<reference>reader</reference>";
    let either = "<reference>counter</reference><reference>other</reference>";
    for (dependencies, reader_state, last_state) in [
        (String::new(), "ACTIVE", "ACTIVE"),
        (depends(counter, "", "reader"), "INACTIVE", "ACTIVE"),
        (
            depends(counter, "", "reader") + &depends(reader, "", "last"),
            "INACTIVE",
            "INACTIVE",
        ),
        (
            depends(counter, " severity='destroy'", "reader") + &depends(reader, "", "last"),
            "DESTROYED",
            "INACTIVE",
        ),
        (
            depends(counter, " severity='ignore'", "reader") + &depends(reader, "", "last"),
            "ACTIVE",
            "ACTIVE",
        ),
        (depends(either, " need='1'", "reader"), "ACTIVE", "ACTIVE"),
        (depends(either, " need='2'", "reader"), "INACTIVE", "ACTIVE"),
    ] {
        let outcome = line(&dependencies);
        let state = |name: &str| outcome.component(name)["state"].clone();
        assert_eq!(state("reader"), reader_state, "{dependencies}");
        assert_eq!(state("last"), last_state, "{dependencies}");
        for untouched in ["other", "its_reader"] {
            assert_eq!(outcome.cycles(untouched), 100, "{dependencies}");
            assert_eq!(state(untouched), "ACTIVE", "{dependencies}");
        }
    }
}

/// An actuator that gets a number every 10 ms, and something that fails at half a second.
fn emergency(category: &str) -> Outcome {
    Application::new()
        .with(&Member::new("counter", "counter").priority(1))
        .with(&Member::new("actuator", "recorder").property("verbose", "true"))
        .with(&Member::new("diary", "diary"))
        .connect("data", "counter.output", "actuator.input")
        .rules(&format!(
            "<component name='actuator'><actuator stop_category='{category}'>\
             <command port='input' safe_value='0'/></actuator></component>\
             <component name='diary'><severity>emergency</severity></component>"
        ))
        .injections("<inject at='505ms' component='diary' fault='error_return' code='503'/>")
        .simulate("2s")
        .ended_well()
}

#[test]
fn an_emergency_stops_actuators_by_their_category_and_is_latched() {
    for (category, inactive_ms) in [("0", Some(510)), ("1", Some(1510)), ("2", None)] {
        let outcome = emergency(category);
        let verdict = outcome.verdicts()[0];
        assert_eq!(verdict["severity"], "emergency", "{category}");
        assert_eq!(verdict["state"], "CONFIRMED", "{category}: latched");
        assert_eq!(outcome.actions()[0], "emergency stop: done", "{category}");
        let stopped = outcome
            .events("state", "actuator")
            .into_iter()
            .find(|event| event["to"] == "INACTIVE")
            .filter(|event| event["t_ns"].as_u64() < Some(2_000_000_000))
            .and_then(|event| event["t_ns"].as_u64());
        let stopped_ms = stopped.map(|time_ns| time_ns / 1_000_000);
        assert_eq!(stopped_ms, inactive_ms, "{category}");
        // From the moment of the decision it reads nothing but the safe command.
        let (before, after) = commands(&outcome);
        assert!(
            before
                .iter()
                .all(|got| !got.contains("0=0 ") && got != "0=0")
        );
        assert!(!after.is_empty(), "{category}: it was told at once");
        assert!(
            after.iter().all(|got| got == "0=0"),
            "{category}: {after:?}"
        );
        assert_eq!(outcome.cycles("counter"), 200, "{category}");
    }
}

/// What the actuator read before and after the first verdict.
fn commands(outcome: &Outcome) -> (Vec<String>, Vec<String>) {
    let events = outcome.all_events();
    let decided = events.iter().position(|event| event["event"] == "verdict");
    let (before, after) = events.split_at(decided.expect("there is a verdict"));
    let got = |events: &[serde_json::Value]| {
        let own = events
            .iter()
            .filter(|event| event["component"] == "actuator");
        let messages = own.filter_map(|event| event["message"].as_str());
        let got = messages.filter_map(|message| message.strip_prefix("got "));
        got.map(str::to_owned).collect()
    };
    (got(before), got(after))
}

fn with_rules(rules: &str) -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .connect("data", "counter.output", "recorder.input")
        .rules(rules)
}

#[test]
fn files_that_contradict_each_other_are_refused_with_both_places() {
    let application =
        with_rules("<component name='counter'><severity>reset</severity></component>");
    let other = application.write(
        "other.xml",
        "<fault_rules application='application'>\
         <component name='counter'><severity>stop</severity></component></fault_rules>",
    );
    let other = other.display().to_string();
    application
        .run(&["--for", "1s", "--rules", &other])
        .was_refused(1, &["other.xml", "rules.xml", "counter", "severity"]);
}

#[test]
fn rules_that_do_not_fit_are_refused() {
    for (rules, code, words) in [
        (
            "<component name='nobody'><severity>stop</severity></component>",
            1,
            &["nobody"][..],
        ),
        (
            "<component name='counter'><port name='output'><validity field='colour'>\
             <min>0</min></validity></port></component>",
            4,
            &["colour", "number, value"],
        ),
        (
            "<component name='counter'><port name='nowhere'><validity><min>0</min></validity>\
             </port></component>",
            1,
            &["nowhere"],
        ),
        (
            "<component name='counter'><fault><secondary><reference>missing.xml</reference>\
             </secondary></fault></component>",
            1,
            &["missing.xml"],
        ),
    ] {
        with_rules(rules)
            .run(&["--for", "1s", "--clock", "simulated"])
            .was_refused(code, words);
    }
}

/// Nobody can know before it has been started.
#[test]
fn a_backup_of_a_component_that_registers_nothing_is_refused() {
    with_rules(
        "<component name='counter'><resurrect><reset>true</reset><backup>20</backup>\
         </resurrect></component>",
    )
    .run(&["--for", "1s", "--clock", "simulated"])
    .was_refused_after(5, &["'counter' registered no memory", "backup"]);
}

/// The last resort without any rule: three resets, then the application stops in order.
#[test]
fn without_rules_three_resets_and_then_a_stop() {
    let outcome = Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("diary", "diary"))
        .injections(
            "<inject at='100ms' repeat='4' every='100ms' component='counter' fault='panic'/>",
        )
        .simulate("1s")
        .ended_well();
    assert_eq!(outcome.actions()[..3], ["reset counter: done"; 3]);
    assert_eq!(outcome.component("diary")["state"], "INACTIVE");
    assert_eq!(outcome.component("counter")["incarnation"], 4);
    let diary = outcome.logs("diary");
    assert!(
        diary.contains(&"onStop".to_owned()),
        "it is stopped in order"
    );
}
