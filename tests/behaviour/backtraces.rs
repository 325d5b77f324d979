//! A component that was taken off leaves evidence: the functions of its library that were being
//! called, in the verdict.

use tests::{Application, Member};

/// The backtrace of a component that fails in this way in its first cycle.
fn backtrace(way: &str, clock: &str) -> Vec<String> {
    let faulty = Member::new("faulty", way).property("at_cycle", "1");
    let application = Application::new().with(&faulty).not_recovered(&["faulty"]);
    let outcome = match clock {
        "simulated" => application.simulate("2s"),
        // A thread that has time finds it later.
        _ => application.run_until(|events| events.contains("\"backtrace\":[\"")),
    };
    let outcome = outcome.ended_well();
    let verdicts = outcome.verdicts();
    let lines = verdicts[0]["evidence"]["exception"]["backtrace"].as_array();
    let lines = lines.unwrap_or_else(|| panic!("{way}: {verdicts:#?}"));
    let text = |line: &serde_json::Value| line.as_str().expect("a text").to_owned();
    lines.iter().map(text).collect()
}

#[test]
fn name_the_functions_of_the_component() {
    for way in [
        "writes_null",
        "bus_error",
        "illegal_instruction",
        "divides_by_zero",
        "hangs",
        // In the C library, below the component's own code.
        "crashes_in_libc",
        "hangs_asleep",
    ] {
        for clock in ["simulated", "real"] {
            let lines = backtrace(way, clock);
            let own = format!("tests/faulty-components/{way}/src/lib.rs:");
            let misbehave = |line: &String| line.contains("misbehave") && line.contains(&own);
            let first = lines.iter().position(misbehave);
            let first = first.unwrap_or_else(|| panic!("{way}: {lines:#?}"));
            // Outside it are the functions that had called it, up to where the container came in.
            for (function, file) in [
                ("strike_if_due", "tests/parts/src/faulty.rs:"),
                ("on_execute", "component-sdk/src/export.rs:"),
            ] {
                let named = |line: &String| line.contains(function) && line.contains(file);
                assert!(lines[first..].iter().any(named), "{way}: {lines:#?}");
            }
            assert!(lines.iter().all(|line| !line.contains("0x")), "{lines:#?}");
        }
    }
}

#[test]
fn of_an_endless_recursion_are_bounded() {
    let lines = backtrace("overflows_stack", "simulated");
    assert_eq!(lines.len(), 32, "{lines:#?}");
    let recursion = |line: &&String| line.starts_with("overflows_stack::descend at ");
    assert!(lines.iter().filter(recursion).count() > 25, "{lines:#?}");
}
