//! Callbacks in the order of OPRoS, and what a component is told.

use tests::{Application, Member};

#[test]
fn callbacks_of_one_component() {
    let outcome = Application::new()
        .with(&Member::new("diary", "diary"))
        .simulate("20ms")
        .ended_well();
    assert_eq!(
        outcome.logs("diary"),
        [
            "onPeriodChanged to 10 ms",
            "onInitialize",
            "onStart",
            "onExecute at 0 ms",
            "onUpdated",
            "onExecute at 10 ms",
            "onUpdated",
            "onStop",
            "onDestroy",
        ]
    );
    assert_eq!(
        outcome.states("diary"),
        ["READY", "ACTIVE", "INACTIVE", "DESTROYED"]
    );
}

/// All are initialised before any is started and stopped before any is destroyed, last first.
#[test]
fn components_in_document_order_and_back() {
    let outcome = Application::new()
        .with(&Member::new("zeta", "diary").kind("passive"))
        .with(&Member::new("alpha", "diary").kind("passive"))
        .simulate("10ms")
        .ended_well();
    let order: Vec<String> = outcome
        .all_events()
        .iter()
        .filter(|event| event["event"] == "log")
        .map(|event| format!("{} {}", event["component"], event["message"]).replace('"', ""))
        .filter(|line| !line.contains("onPeriodChanged"))
        .collect();
    assert_eq!(
        order,
        [
            "zeta onInitialize",
            "alpha onInitialize",
            "zeta onStart",
            "alpha onStart",
            "alpha onStop",
            "zeta onStop",
            "alpha onDestroy",
            "zeta onDestroy",
        ]
    );
}

/// A failure that the component returns: `onError` is called, and it is destroyed in order.
#[test]
fn a_failing_component_is_told() {
    let outcome = Application::new()
        .with(&Member::new("diary", "diary").property("fails", "yes"))
        .not_recovered(&["diary"])
        .simulate("50ms")
        .ended_well();
    assert_eq!(
        outcome.logs("diary")[3..],
        ["onExecute at 0 ms", "onError", "onDestroy"]
    );
    assert_eq!(
        outcome.states("diary"),
        ["READY", "ACTIVE", "ERROR", "DESTROYED"]
    );
    let fault = outcome.events("fault", "diary")[0];
    assert_eq!(fault["message"], "asked to (502 INTERNAL_FAULT)");
}

#[test]
fn properties() {
    let outcome = Application::new()
        .with(
            &Member::new("diary", "diary")
                .kind("passive")
                .property("show", "own,overridden,twice,text,empty,missing")
                .property("own", "from the profile")
                .property("overridden", "from the profile")
                .property("twice", "first")
                .property("twice", "second")
                .property("text", "&lt;grün&gt; &amp; 빨강")
                .property("empty", "")
                .own_property("overridden", "from the application"),
        )
        .simulate("10ms")
        .ended_well();
    let logs = outcome.logs("diary");
    let shown: Vec<&String> = logs.iter().filter(|line| line.contains(" is ")).collect();
    assert_eq!(
        shown,
        [
            "own is Some(\"from the profile\")",
            "overridden is Some(\"from the application\")",
            "twice is Some(\"second\")",
            "text is Some(\"<grün> & 빨강\")",
            "empty is Some(\"\")",
            "missing is None",
        ]
    );
}

/// A component without a period is told so.
#[test]
fn periods() {
    for (kind, told) in [
        ("periodic", "onPeriodChanged to 40 ms"),
        ("periodic-shared", "onPeriodChanged to 40 ms"),
        ("passive", "onPeriodChanged to 0 ms"),
        ("aperiodic", "onPeriodChanged to 0 ms"),
    ] {
        let outcome = Application::new()
            .with(&Member::new("diary", "diary").kind(kind).period(40))
            .simulate("10ms")
            .ended_well();
        assert_eq!(outcome.logs("diary")[0], told, "{kind}");
    }
}
