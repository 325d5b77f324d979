//! `steadfast run --supervised`: the container dies or hangs, and a parent brings it back.

mod machine;
mod robot;

use std::time::Duration;

use rustix::process::Signal;
use serde_json::Value;
use tests::{Application, Member, Outcome, Supervised, Watched, take_turn, until};

/// What a busy machine gets for what takes a second or two.
const LIMIT: Duration = Duration::from_secs(60);

/// A machine that builds at the same time may not let the container run for a second.
const PATIENT: &str = "10s";

/// A counter whose numbers are recorded.
fn application() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .connect("data", "counter.output", "recorder.input")
}

/// Starts it under a parent, with further arguments.
fn start(application: &Application, arguments: &[&str]) -> Watched {
    let supervised = ["--supervised", "--supervision-timeout", PATIENT];
    application.start(&[&supervised, arguments].concat())
}

/// Waits until a container has come up so many times.
#[track_caller]
fn wait_until_running(application: &Application, times: usize) {
    let runs = || {
        let events = application.events_so_far();
        events.matches("\"to\":\"ACTIVE\"").count() >= 2 * times
            && events.matches("\"event\":\"container_restarted\"").count() == times - 1
    };
    let came = until(LIMIT, runs);
    assert!(came, "{}", application.events_so_far());
}

fn of_kind<'run>(outcome: &'run Outcome, kind: &str) -> Vec<&'run Value> {
    let events = outcome.all_events().iter();
    events.filter(|event| event["event"] == kind).collect()
}

#[test]
fn a_killed_container_comes_back_and_its_end_is_on_record() {
    let application = application();
    let run = start(&application, &[]);
    wait_until_running(&application, 1);
    let processes = Supervised::by(&run);
    let first = processes.container(None);
    Supervised::signal(first, Signal::KILL);
    wait_until_running(&application, 2);
    let second = processes.container(Some(first));
    let operator = application.operator();
    operator.socket();
    assert_eq!(operator.sockets().len(), 1, "that of the dead is gone");
    let outcome = application.interrupt(run).ended_well();
    assert_eq!(outcome.summary()["restarts"], 1);
    assert_eq!(outcome.application()["ended_by"], "stopped");
    assert!(operator.sockets().is_empty());
    Supervised::assert_ends(second);
    let restarted = of_kind(&outcome, "container_restarted");
    let [restarted] = restarted[..] else {
        panic!("{restarted:?}");
    };
    assert_eq!(restarted["restart"], 1);
    assert_eq!(restarted["seen"], "it was ended by signal 9 (SIGKILL)");
    assert!(
        restarted["judged"]
            .as_str()
            .unwrap_or_default()
            .contains("crash")
    );
    let time_us = |name: &str| restarted[name].as_u64().expect("a time");
    let without_us = time_us("without_container_us");
    assert!(time_us("handling_us") <= without_us, "{restarted}");
    let starts = of_kind(&outcome, "run_started");
    let times: Vec<_> = starts.iter().map(|it| it["t_ns"].as_u64()).collect();
    assert!(
        matches!(times[..], [first, second] if first < second),
        "{times:?}"
    );
}

#[test]
fn a_container_that_hangs_is_noticed() {
    let application = application();
    let run = application.start(&["--supervised", "--supervision-timeout", "2s"]);
    wait_until_running(&application, 1);
    let container = Supervised::by(&run).container(None);
    Supervised::signal(container, Signal::STOP);
    let came = until(LIMIT, || {
        application.events_so_far().contains("no sign of life")
    });
    assert!(came, "{}", application.events_so_far());
    let outcome = application.interrupt(run).ended_well();
    let restarted = of_kind(&outcome, "container_restarted");
    let judged = restarted[0]["judged"].as_str().unwrap_or_default();
    assert!(judged.contains("hang"), "{judged}");
    assert!(restarted[0]["detection_us"].as_u64() >= Some(2_000_000));
}

#[test]
fn when_the_restarts_are_used_up_it_gives_up() {
    let application = application();
    let run = start(&application, &["--restarts", "1"]);
    wait_until_running(&application, 1);
    let processes = Supervised::by(&run);
    let first = processes.container(None);
    Supervised::signal(first, Signal::KILL);
    wait_until_running(&application, 2);
    let second = processes.container(Some(first));
    Supervised::signal(second, Signal::SEGV);
    let outcome = application.outcome(run.wait(LIMIT));
    assert_eq!(outcome.finished().code, Some(7), "{}", outcome.finished());
    let said = &outcome.finished().stderr;
    assert!(
        said.contains("all 1 restarts within 60 s are used up"),
        "{said}"
    );
    let last = outcome.all_events().last().expect("events");
    assert_eq!(last["event"], "container_given_up");
    assert_eq!(last["seen"], "it was ended by signal 11 (SIGSEGV)");
    assert!(application.operator().sockets().is_empty());
}

/// At any moment: while it is brought up, while it runs.
#[test]
fn two_hundred_kills_leave_nothing_behind() {
    let _turn = take_turn();
    let application = application();
    let run = start(&application, &["--restarts", "1000"]);
    let processes = Supervised::by(&run);
    wait_until_running(&application, 1);
    let mut container = processes.container(None);
    let open = processes.open_in_parent();
    for kill in 0..200_u64 {
        // From 0 to 97 ms, in no order; bringing up takes about as long.
        std::thread::sleep(Duration::from_millis(kill * 37 % 98));
        Supervised::signal(container, Signal::KILL);
        container = processes.container(Some(container));
    }
    let operator = application.operator();
    operator.socket();
    assert_eq!(operator.sockets().len(), 1);
    assert_eq!(processes.open_in_parent(), open);
    let outcome = application.interrupt(run).ended_well();
    assert_eq!(outcome.summary()["restarts"], 200);
    assert!(operator.sockets().is_empty());
    let profile = application.profile().display().to_string();
    assert_eq!(Supervised::called_with(&profile), []);
}

#[test]
fn a_refused_start_is_not_repeated() {
    let application = Application::new().with(&Member::new("absent", "no_such_library"));
    let outcome = application.run(&["--supervised"]);
    outcome.was_refused(3, &["no_such_library"]);
    assert!(!outcome.finished().stderr.contains("restart"));
    let application = self::application();
    let outcome = application.run(&["--supervised", "--clock", "simulated"]);
    outcome.was_refused(64, &["--supervised", "simulated"]);
    let outcome = application.run(&["--restarts", "3"]);
    outcome.was_refused(64, &["--restarts", "--supervised"]);
}

#[test]
fn the_duration_counts_for_the_run_and_not_for_each_container() {
    let application = application();
    let run = start(&application, &["--for", "12s"]);
    wait_until_running(&application, 1);
    let container = Supervised::by(&run).container(None);
    Supervised::signal(container, Signal::KILL);
    let outcome = application.outcome(run.wait(LIMIT)).ended_well();
    assert_eq!(outcome.application()["ended_by"], "duration_elapsed");
    let time_s = outcome.application()["time_s"].as_f64().expect("a time");
    assert!((12.0..24.0).contains(&time_s), "{time_s}");
    assert_eq!(outcome.summary()["restarts"], 1);
}
