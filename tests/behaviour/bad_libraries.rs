//! Libraries that cannot be used, and components that say no: nothing is started by halves.

use tests::{Application, Member, artifacts};

const LIBRARY: i32 = 3;
const CONNECTION: i32 = 4;
const COMPONENT: i32 = 5;

/// A component with this library, beside one that is in order.
fn beside_a_good_one(library: &str) -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("bad", library))
}

#[test]
fn missing() {
    let member = Member::new("bad", "no_such_library").ports("");
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&member)
        .simulate("1s")
        .was_refused(
            LIBRARY,
            &[
                "'bad'",
                "'no_such_library' was not found",
                "libno_such_library.so",
                "--library-path",
            ],
        );
}

#[test]
fn outside_the_search_path() {
    let path = artifacts().join("libcounter.so");
    for library in [path.to_str().expect("a path of text"), "../counter.so"] {
        let member = Member::new("bad", library).ports("");
        Application::new()
            .with(&member)
            .simulate("1s")
            .was_refused(LIBRARY, &["'bad'", "outside the search path"]);
    }
}

#[test]
fn no_library_at_all() {
    let application = beside_a_good_one("text");
    application.write("text.so", "This is no library.");
    application
        .with(&Member::new("bad", "text").ports(""))
        .simulate("1s")
        .was_refused(1, &["bad"]);
    let application = Application::new().with(&Member::new("bad", "text").ports(""));
    application.write("text.so", "This is no library.");
    application
        .simulate("1s")
        .was_refused(LIBRARY, &["text.so is no shared library"]);
}

#[test]
fn a_library_that_is_cut_off() {
    let whole = std::fs::read(artifacts().join("libcounter.so")).expect("it was built");
    for length in [4096, 64, 0] {
        let application = Application::new().with(&Member::new("bad", "half").ports(""));
        application.write("half.so", &whole[..length]);
        application
            .simulate("1s")
            .was_refused(LIBRARY, &["half.so"]);
    }
}

#[test]
fn no_component() {
    beside_a_good_one("no_component")
        .simulate("1s")
        .was_refused(
            LIBRARY,
            &["no component", "steadfast_component", "export_component!"],
        );
}

#[test]
fn an_older_contract() {
    beside_a_good_one("old_abi").simulate("1s").was_refused(
        LIBRARY,
        &["component ABI 0.0", "this container has 1.0", "rebuild"],
    );
}

#[test]
fn another_layout() {
    beside_a_good_one("wrong_layout")
        .simulate("1s")
        .was_refused(LIBRARY, &["other table layouts", "rebuild"]);
}

#[test]
fn a_crash_in_a_constructor() {
    beside_a_good_one("crashes_when_loaded")
        .simulate("1s")
        .was_refused(LIBRARY, &["cannot be loaded safely", "signal 11"]);
}

/// All of them are named, not only the first.
#[test]
fn several_at_once() {
    Application::new()
        .with(&Member::new("old", "old_abi"))
        .with(&Member::new("nothing", "no_component"))
        .with(&Member::new("missing", "no_such_library").ports(""))
        .simulate("1s")
        .was_refused(LIBRARY, &["'old'", "'nothing'", "'missing'"]);
}

#[test]
fn a_profile_that_does_not_fit_its_library() {
    let port = |element: &str, name: &str, usage: &str, data_type: &str| {
        format!(
            "<{element}><name>{name}</name><usage>{usage}</usage>\
             <data_type>{data_type}</data_type></{element}>"
        )
    };
    for (ports, words) in [
        (
            port("data_port", "output", "output", "Speed"),
            "carries 'Speed'",
        ),
        (
            port("data_port", "output", "input", "Sample"),
            "faces the other way",
        ),
        (
            port("event_port", "output", "output", "Sample"),
            "it is a data port",
        ),
        (
            port("data_port", "outlet", "output", "Sample"),
            "no such port",
        ),
    ] {
        let outcome = Application::new()
            .with(&Member::new("bad", "counter").ports(&ports))
            .simulate("1s");
        outcome.was_refused(CONNECTION, &["bad.xml:", words, "'output'"]);
    }
}

#[test]
fn an_unplugged_serial_line() {
    let outcome = Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("driver", "diary").property("device", "/dev/ttyNotThere0"))
        .simulate("1s");
    outcome.was_refused(
        COMPONENT,
        &["'driver'", "onInitialize", "/dev/ttyNotThere0"],
    );
    let logged = &outcome.logs("driver")[2];
    assert!(logged.contains("is it plugged in"), "{logged}");
}

#[test]
fn a_simulated_device_without_a_world() {
    let outcome = Application::new()
        .with(&Member::new("driver", "diary").property("device", "simulated:motion_board"))
        .simulate("1s");
    outcome.was_refused(COMPONENT, &["'driver'", "simulated:motion_board"]);
    let logged = &outcome.logs("driver")[2];
    assert!(logged.contains("no <world>"), "{logged}");
}

/// A property that the component cannot use; what was initialised before is put away in order.
#[test]
fn a_wrong_property() {
    let outcome = Application::new()
        .with(&Member::new("diary", "diary"))
        .with(&Member::new("counter", "counter").property("burst", "many"))
        .simulate("1s");
    outcome.was_refused(COMPONENT, &["'counter'", "property 'burst' is 'many'"]);
    assert_eq!(outcome.states("diary"), ["READY", "DESTROYED"]);
}
