//! The two clocks.

use std::time::Duration;

use tests::{Application, Member};

/// Components of every kind, some of which fail and are recovered again and again, until the
/// application goes on without them.
fn lively() -> Application {
    let expendable = |name: &str| {
        format!(
            "<component name='{name}'><fault><retry_max>9</retry_max>\
             <severity>ignore</severity></fault></component>"
        )
    };
    Application::new()
        .rules(
            &["panics", "writes_null", "overflows", "lost"]
                .map(expendable)
                .concat(),
        )
        .with(
            &Member::new("counter", "counter")
                .period(7)
                .property("burst", "3"),
        )
        .with(&Member::new("echo", "echo").kind("aperiodic"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .with(&Member::new("herald", "herald").period(13))
        .with(&Member::new("listener", "listener").kind("passive"))
        .with(
            &Member::new("asker", "asker")
                .period(9)
                .property("method", "note"),
        )
        .with(&Member::new("adder", "adder").kind("aperiodic"))
        .with(&Member::new("panics", "panics"))
        .with(&Member::new("writes_null", "writes_null").kind("periodic-shared"))
        .with(&Member::new("overflows", "overflows_stack").kind("periodic-shared"))
        .with(&Member::new("lost", "crashes_in_libc"))
        .connect("data", "counter.output", "echo.input")
        .connect("data", "echo.output", "recorder.input")
        .connect("event", "herald.news", "listener.news")
        .connect("service", "asker.arithmetic", "adder.arithmetic")
}

#[test]
fn simulated_runs_are_the_same_byte_for_byte() {
    let application = lively();
    let first = application.simulate("2s").ended_well();
    assert!(
        first.raw_events().lines().count() > 500,
        "there is something to compare"
    );
    for _ in 0..3 {
        let again = application.simulate("2s").ended_well();
        assert!(
            first.raw_events() == again.raw_events(),
            "events differ from run to run"
        );
    }
}

#[test]
fn simulated_time_does_not_wait() {
    let outcome = Application::new()
        .with(&Member::new("counter", "counter").period(1000))
        .simulate("24h")
        .ended_well();
    assert_eq!(outcome.cycles("counter"), 24 * 3600);
    assert_eq!(outcome.application()["time_s"], 86_400.0);
    assert_eq!(outcome.application()["ended_by"], "duration_elapsed");
    assert_eq!(outcome.application()["clock"], "simulated");
}

/// Nothing ever happens in it, but it ends when it should.
#[test]
fn an_idle_application_ends_too() {
    for clock in ["simulated", "real"] {
        let outcome = Application::new()
            .with(&Member::new("passive", "diary").kind("passive"))
            .run(&["--clock", clock, "--for", "200ms"])
            .ended_well();
        let time = outcome.application()["time_s"].as_f64().expect("a number");
        assert!(time >= 0.2, "{clock}: {time}");
    }
}

#[test]
fn real_time_is_kept() {
    let outcome = Application::new()
        .with(&Member::new("diary", "diary").period(20))
        .run_really("300ms")
        .ended_well();
    let time = outcome.application()["time_s"].as_f64().expect("a number");
    assert!(time >= 0.3, "{time}");
    // Never earlier than it should be, however busy the machine.
    let starts: Vec<u64> = outcome
        .events("log", "diary")
        .iter()
        .filter(|event| {
            event["message"]
                .as_str()
                .is_some_and(|text| text.starts_with("onExecute"))
        })
        .map(|event| event["t_ns"].as_u64().expect("a time"))
        .collect();
    assert!(!starts.is_empty());
    // Those that followed between the judgement and the stop do not count.
    let in_time = starts
        .iter()
        .filter(|start| Duration::from_nanos(**start).as_secs_f64() <= time);
    let cycles = in_time.count();
    #[allow(clippy::cast_precision_loss)] // a handful
    let cycles = cycles as f64;
    // One at the start.
    assert!(
        cycles <= time / 0.02 + 1.0,
        "no more cycles than fit: {cycles} in {time} s"
    );
    assert!(starts.is_sorted());
}
