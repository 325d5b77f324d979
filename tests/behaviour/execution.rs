//! Executors: who runs when, and with whom.

use tests::{Application, Member, Outcome};

/// Components in the order of their lines that contain `what`.
fn order(outcome: &Outcome, what: &str) -> Vec<String> {
    outcome
        .all_events()
        .iter()
        .filter(|event| {
            event["message"]
                .as_str()
                .is_some_and(|text| text.contains(what))
        })
        .map(|event| event["component"].as_str().unwrap_or_default().to_owned())
        .collect()
}

#[test]
fn cycles_are_exact() {
    let outcome = Application::new()
        .with(&Member::new("fast", "diary").period(1))
        .with(&Member::new("slow", "diary").period(250))
        .with(
            &Member::new("exclusive", "diary")
                .kind("periodic-exclusive")
                .period(20),
        )
        .with(&Member::new("passive", "diary").kind("passive"))
        .with(&Member::new("aperiodic", "diary").kind("aperiodic"))
        .simulate("1s")
        .ended_well();
    for (component, cycles) in [
        ("fast", 1000),
        ("slow", 4),
        ("exclusive", 50),
        ("passive", 0),
        ("aperiodic", 0),
    ] {
        assert_eq!(outcome.cycles(component), cycles, "{component}");
        assert_eq!(outcome.component(component)["overruns"], 0, "{component}");
    }
}

#[test]
fn equal_times_go_by_priority_then_name() {
    let outcome = Application::new()
        .with(&Member::new("b", "diary").priority(5))
        .with(&Member::new("c", "diary").priority(50))
        .with(&Member::new("a", "diary").priority(5))
        .simulate("20ms")
        .ended_well();
    assert_eq!(order(&outcome, "onExecute"), ["c", "a", "b", "c", "a", "b"]);
}

/// Components that share an executor are all executed before any is updated.
#[test]
fn shared_executors_update_after_all_have_executed() {
    let shared = |name: &str| Member::new(name, "diary").kind("periodic-shared");
    let outcome = Application::new()
        .with(&shared("b"))
        .with(&shared("a"))
        .with(&shared("other").period(20))
        .simulate("10ms")
        .ended_well();
    assert_eq!(order(&outcome, "on"), {
        let start = ["b", "b", "a", "a", "other", "other", "b", "a", "other"];
        let cycle = ["b", "a", "b", "a", "other", "other"];
        let stop = ["other", "a", "b", "other", "a", "b"];
        [start.as_slice(), &cycle, &stop].concat()
    });
}

/// A fault in a shared executor does not cost the others a cycle.
#[test]
fn a_fault_in_a_shared_executor() {
    let shared = |name: &str, library: &str| Member::new(name, library).kind("periodic-shared");
    for misbehaviour in ["panics", "writes_null", "crashes_in_libc"] {
        let outcome = Application::new()
            .with(&shared("before", "counter"))
            .with(&shared("faulty", misbehaviour))
            .with(&shared("after", "recorder"))
            .connect("data", "before.output", "after.input")
            .not_recovered(&["faulty"])
            .simulate("1s")
            .ended_well();
        assert_eq!(outcome.component("faulty")["state"], "ERROR");
        assert_eq!(outcome.cycles("before"), 100, "{misbehaviour}");
        assert_eq!(outcome.cycles("after"), 100, "{misbehaviour}");
        assert_eq!(outcome.logs("after"), ["received 100, last 100, gaps 0"]);
    }
}

/// The source runs only in cycles after its target has run.
#[test]
fn coordination() {
    let outcome = Application::new()
        .with(&Member::new("follower", "diary").period(10).priority(1))
        .with(&Member::new("leader", "diary").period(40).priority(2))
        .element("<coordination><depends source='follower' target='leader'/></coordination>")
        .simulate("80ms")
        .ended_well();
    assert_eq!(outcome.cycles("leader"), 2);
    assert_eq!(outcome.cycles("follower"), 2);
    assert_eq!(
        order(&outcome, "onExecute"),
        ["leader", "follower", "leader", "follower"]
    );
}

/// Aperiodic components run when something arrives, and only then.
#[test]
fn aperiodic_components_run_on_data() {
    let chain = |period| {
        Application::new()
            .with(&Member::new("counter", "counter").period(period))
            .with(&Member::new("echo", "echo").kind("aperiodic"))
            .with(
                &Member::new("recorder", "recorder")
                    .kind("aperiodic")
                    .property("verbose", "true"),
            )
            .connect("data", "counter.output", "echo.input")
            .connect("data", "echo.output", "recorder.input")
    };
    let outcome = chain(100).simulate("1s").ended_well();
    for component in ["counter", "echo", "recorder"] {
        assert_eq!(outcome.cycles(component), 10, "{component}");
    }
    let logs = outcome.logs("recorder");
    assert_eq!(logs[10..], ["received 10, last 10, gaps 0"]);
    let some = |events: &str| events.matches("got ").count() > 10;
    let outcome = chain(20).run_until(some).ended_well();
    let logs = outcome.logs("recorder");
    let last = logs.last().map(String::as_str).unwrap_or_default();
    assert!(last.ends_with("gaps 0"), "{logs:?}");
    let (counter, echo) = (outcome.cycles("counter"), outcome.cycles("echo"));
    assert!(
        echo <= counter + 1,
        "no busy loop: {echo} cycles for {counter} data"
    );
}

/// A composite's members run as if the application had named them.
#[test]
fn composites_are_flattened() {
    let application = Application::new()
        .with(&Member::new("echo", "echo"))
        .with(&Member::new("counter", "counter").priority(9))
        .with(&Member::new("recorder", "recorder").priority(0))
        .with_reference("outer", "outer.xml")
        .connect("data", "counter.output", "outer.in")
        .connect("data", "outer.out", "recorder.input");
    let composite = |name: &str, members: [(&str, &str); 2], ports: [&str; 2]| {
        let [(first, first_file), (second, second_file)] = members;
        let [input, output] = ports;
        format!(
            "<composite_component_profile><name>{name}</name><subcomponents>\
             <subcomponent><name>{first}</name><reference>{first_file}</reference></subcomponent>\
             <subcomponent><name>{second}</name><reference>{second_file}</reference></subcomponent>\
             </subcomponents><port_connections><port_connection port_type='data'>\
             <source component_name='{first}' port_name='{output}'/>\
             <target component_name='{second}' port_name='{input}'/></port_connection>\
             </port_connections><export_ports>\
             <export_port><component_name>{first}</component_name><port_name>{input}</port_name>\
             <port_type>data</port_type><port_dir>input</port_dir>\
             <export_port_name>in</export_port_name></export_port>\
             <export_port><component_name>{second}</component_name><port_name>{output}</port_name>\
             <port_type>data</port_type><port_dir>output</port_dir>\
             <export_port_name>out</export_port_name></export_port>\
             </export_ports></composite_component_profile>"
        )
    };
    let members = [("one", "echo.xml"), ("two", "echo.xml")];
    application.write(
        "inner.xml",
        composite("inner", members, ["input", "output"]),
    );
    let members = [("one", "inner.xml"), ("two", "inner.xml")];
    application.write("outer.xml", composite("outer", members, ["in", "out"]));
    let outcome = application.simulate("1s").ended_well();
    for member in [
        "outer/one/one",
        "outer/one/two",
        "outer/two/one",
        "outer/two/two",
    ] {
        assert_eq!(outcome.cycles(member), 100, "{member}");
    }
    assert_eq!(outcome.logs("recorder"), ["received 100, last 100, gaps 0"]);
}

#[test]
fn standard_output_has_the_result_alone_where_it_is_for_programs() {
    let outcome = Application::new()
        .with(&Member::new("counter", "counter"))
        .run(&["--clock", "simulated", "--for", "50ms", "--format", "json"])
        .ended_well();
    let printed: serde_json::Value =
        serde_json::from_str(&outcome.finished().stdout).expect("one JSON object");
    assert_eq!(&printed, outcome.summary());
    assert!(
        outcome
            .finished()
            .stderr
            .contains("counter: READY -> ACTIVE")
    );
}
