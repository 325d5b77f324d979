//! An operator beside a running application: faults are listed, shown, cleared and injected, and
//! whatever a client does, the application goes on.

use std::io::Write as _;
use std::os::unix::net::UnixStream;

use serde_json::{Value, json};
use tests::{Application, Member, Outcome};

/// A counter whose numbers are recorded.
fn application() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("recorder", "recorder"))
        .connect("data", "counter.output", "recorder.input")
}

/// Time of the first event for which this holds, in nanoseconds.
#[track_caller]
fn time_of(outcome: &Outcome, what: &str, holds: impl Fn(&Value) -> bool) -> u64 {
    let event = outcome.all_events().iter().find(|event| holds(event));
    let time = event.and_then(|event| event["t_ns"].as_u64());
    time.unwrap_or_else(|| panic!("{what} is not on record"))
}

#[test]
fn an_injected_fault_is_listed_shown_and_cleared() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    let socket = operator.socket();
    assert!(operator.faults().is_empty());
    let accepted = operator.answer(&["inject", "<inject component='counter' fault='panic'/>"]);
    assert_eq!(accepted["injection"], 0);
    operator.wait_for("recovered", |faults| {
        faults.iter().any(|fault| fault["state"] == "HEALED")
    });
    let shown = operator.answer(&["show", "1"]);
    assert_eq!(shown["fault"]["kind"], "panic");
    assert_eq!(shown["fault"]["component"], "counter");
    assert_eq!(shown["fault"]["actions"][0]["outcome"], "done");
    assert_eq!(operator.answer(&["clear", "1"])["cleared"], json!([1]));
    assert_eq!(operator.faults()[0]["state"], "CLEARED");
    assert_eq!(operator.answer(&["clear", "1"])["cleared"], json!([]));
    let status = operator.status();
    assert_eq!(status["applications"], json!({"application": "ACTIVE"}));
    assert_eq!(status["clock"], "real");
    assert_eq!(status["emergency_stop"], false);
    assert_eq!(status["components"]["counter"]["state"], "ACTIVE");
    assert_eq!(status["components"]["counter"]["incarnation"], 2);
    assert_eq!(status["components"]["counter"]["tier"], "guarded");
    let outcome = application.interrupt(run).ended_well();
    let path = socket.display().to_string();
    assert!(outcome.finished().stdout.contains(&path), "{path}");
    assert!(operator.sockets().is_empty(), "it is taken away");
    assert_eq!(outcome.events("injection", "counter").len(), 1);
}

#[test]
fn what_cannot_be_done_is_refused_with_a_reason() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    operator.socket();
    for (arguments, reason) in [
        (vec!["show", "7"], "there is no fault 7"),
        (vec!["clear", "7"], "there is no fault 7"),
        (
            vec!["inject", "<inject component='countre' fault='panic'/>"],
            "did you mean `counter`",
        ),
        (
            vec![
                "inject",
                "<inject component='counter' port='output' field='speed' fault='stuck'/>",
            ],
            "speed",
        ),
        (
            vec!["inject", "<inject fault='camera_smoke' density='1'/>"],
            "no simulated world",
        ),
        (vec!["inject", "reboot"], "not well-formed"),
    ] {
        let finished = operator.fault(&arguments);
        assert_eq!(finished.code, Some(1), "{finished}");
        assert!(finished.stderr.contains(reason), "{reason}: {finished}");
    }
    let outcome = application.interrupt(run).ended_well();
    let injected = |event: &&Value| event["event"] == "injection";
    assert_eq!(outcome.all_events().iter().filter(injected).count(), 0);
    assert_eq!(outcome.component("counter")["faults"], 0);
}

#[test]
fn data_of_a_port_that_no_rule_watches_can_be_distorted() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    operator.socket();
    operator.answer(&[
        "inject",
        "<inject component='recorder' port='input' fault='drop' for='100ms'/>",
    ]);
    let ended = |text: &str| text.contains("\"change\":\"ends\"");
    let events = application.folder().join("events.jsonl");
    let over = tests::until(std::time::Duration::from_secs(60), || {
        ended(&std::fs::read_to_string(&events).unwrap_or_default())
    });
    assert!(over, "the injection does not end");
    let outcome = application.interrupt(run).ended_well();
    let logs = outcome.logs("recorder");
    let report = logs.last().expect("the recorder says what came");
    assert!(report.ends_with("gaps 1"), "{report}");
}

#[test]
fn a_hostile_client_changes_nothing() {
    let application = application();
    let run = application.start(&[]);
    let operator = application.operator();
    let socket = operator.socket();
    let idle: Vec<UnixStream> = (0..4)
        .map(|_| UnixStream::connect(&socket).expect("it listens"))
        .collect();
    for garbage in [
        b"\0\xff\xfe\n".to_vec(),
        b"{\"request\":\"reboot\"}\n".to_vec(),
        b"{\"request\":\"fault_clear\",\"id\":".to_vec(),
        vec![b'['; 1 << 20],
        b"{\"request\":\"fault_list\"}\n".repeat(1000),
    ] {
        let mut stream = UnixStream::connect(&socket).expect("it listens");
        // The server may hang up in the middle of it.
        let _hung_up = stream.write_all(&garbage);
    }
    let cycles = |status: &Value| status["components"]["counter"]["cycles"].as_u64();
    let before = cycles(&operator.status());
    let goes_on = tests::until(std::time::Duration::from_secs(60), || {
        cycles(&operator.status()) > before
    });
    assert!(goes_on, "the counter stands still");
    assert!(operator.faults().is_empty());
    drop(idle);
    let outcome = application.interrupt(run).ended_well();
    let report = outcome.logs("recorder").pop().expect("what came");
    assert!(report.ends_with("gaps 0"), "{report}");
}

/// Numbers are commands: `echo` moves something, and `recorder` sees it move. The numbers stop for a
/// while before the operator ends the emergency.
#[test]
fn after_an_emergency_an_actuator_waits_for_a_fresh_command() {
    const SILENCE: &str =
        "<inject component='counter' port='output' fault='drop' at='100ms' for='4s'/>";
    let application = Application::new()
        .with(&Member::new("counter", "counter"))
        .with(&Member::new("echo", "echo"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .with(&Member::new("diary", "diary"))
        .connect("data", "counter.output", "echo.input")
        .connect("data", "echo.output", "recorder.input");
    let rules = application.write(
        "rules.xml",
        "<fault_rules application='application'>
           <component name='echo'>
             <actuator stop_category='2'><command port='input' safe_value='-1'/></actuator>
           </component>
           <component name='diary'><severity>emergency</severity></component>
         </fault_rules>",
    );
    let run = application.start(&["--rules", &rules.display().to_string()]);
    let operator = application.operator();
    operator.socket();
    operator.answer(&[
        "inject",
        "<inject component='diary' fault='error_return' code='500'/>",
    ]);
    operator.wait_for("confirmed", |faults| {
        faults.iter().any(|fault| fault["state"] == "CONFIRMED")
    });
    assert_eq!(operator.status()["emergency_stop"], true);
    operator.answer(&["inject", SILENCE]);
    let is_silent = |text: &str| text.contains("\"fault\":\"drop\"");
    let events = application.folder().join("events.jsonl");
    let events = || std::fs::read_to_string(&events).unwrap_or_default();
    let minute = std::time::Duration::from_secs(60);
    assert!(tests::until(minute, || is_silent(&events())));
    assert_eq!(operator.status()["emergency_stop"], true, "latched");
    assert_eq!(operator.answer(&["clear", "--all"])["cleared"], json!([1]));
    assert_eq!(operator.status()["emergency_stop"], false);
    assert!(tests::until(minute, || events().contains("\"ends\"")));
    let moves = |text: &str| {
        text.rsplit_once("\"ends\"")
            .is_some_and(|it| it.1.contains("got"))
    };
    assert!(tests::until(minute, || moves(&events())));
    let outcome = application.interrupt(run).ended_well();
    no_jump(&outcome);
}

/// Between the emergency and the end of the silence nothing but the safe command was carried out,
/// and the first one afterwards was given afterwards.
fn no_jump(outcome: &Outcome) {
    const SAFE: &str = "=-1";
    let drop = |change: &'static str| {
        move |event: &Value| event["fault"] == "drop" && event["change"] == change
    };
    let cleared = time_of(outcome, "the operator's reset", |event| {
        event["event"] == "verdict" && event["state"] == "CLEARED"
    });
    let silent = time_of(outcome, "the silence", drop("begins"));
    let heard = time_of(outcome, "the end of the silence", drop("ends"));
    assert!(silent < cleared && cleared < heard);
    let moves = |from: u64, to: u64| {
        let events = outcome.events("log", "recorder").into_iter();
        let between = events.filter(move |event| {
            let time = event["t_ns"].as_u64().unwrap_or_default();
            (from..to).contains(&time)
        });
        between.map(|event| event["message"].as_str().unwrap_or_default().to_owned())
    };
    let during: Vec<String> = moves(silent, heard).collect();
    assert!(!during.is_empty());
    for words in &during {
        let commands = words.split_whitespace().filter(|word| word.contains('='));
        for command in commands {
            assert!(command.ends_with(SAFE), "{words}");
        }
    }
    let resumed = moves(heard, u64::MAX).find(|words| !words.ends_with(SAFE));
    assert!(resumed.is_some(), "it resumes with a fresh command");
}
