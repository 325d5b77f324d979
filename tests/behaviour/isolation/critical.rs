//! Critical memory of a component in a host: checkpoints of it survive whatever the host dies of.

use rustix::process::Signal;
use tests::{Application, Member, Outcome};

use super::recovered;

/// A counter that remembers its number, with a checkpoint every cycle.
fn application() -> Application {
    Application::new()
        .with(&Member::new("counter", "counter").property("remembers", "true"))
        .with(&Member::new("recorder", "recorder").property("verbose", "true"))
        .connect("data", "counter.output", "recorder.input")
        .rules(
            "<component name='counter'><resurrect><reset>true</reset><backup>10</backup>\
             </resurrect></component>",
        )
        .in_hosts()
}

/// Numbers that were received, in order.
fn numbers(outcome: &Outcome) -> Vec<u64> {
    let logs = outcome.logs("recorder");
    let got = logs.iter().filter_map(|line| line.strip_prefix("got "));
    let numbers = got.flat_map(|line| line.split(' ').filter_map(|it| it.split('=').next()));
    numbers.map(|it| it.parse().expect("a number")).collect()
}

#[test]
fn after_a_trap_the_numbers_go_on() {
    for fault in ["segfault", "abort", "stack_overflow", "exit", "panic"] {
        let outcome = application()
            .injections(&format!(
                "<inject at='300ms' component='counter' fault='{fault}'/>"
            ))
            .simulate("500ms")
            .ended_well();
        assert_eq!(
            outcome.notes(),
            ["by a fresh instance, checkpoint 30 restored"],
            "{fault}"
        );
        assert_eq!(numbers(&outcome), (1..=50).collect::<Vec<_>>(), "{fault}");
    }
}

/// What was sent since the last checkpoint may come again; nothing begins anew.
#[test]
fn after_a_kill_the_numbers_go_on() {
    const KILLS: usize = 3;
    let application = application();
    let run = application.start(&[]);
    application.wait_until(|events| events.matches("got ").count() > 20);
    for kill in 1..=KILLS {
        assert!(run.host_of("counter").signal(Signal::KILL));
        application.wait_until(|events| recovered(events, "counter", kill));
    }
    let outcome = application.interrupt(run).ended_well();
    assert_eq!(outcome.actions(), ["reset counter: done"; KILLS]);
    let notes = outcome.notes();
    assert!(
        notes.iter().all(|note| note.ends_with(" restored")),
        "{notes:?}"
    );
    let numbers = numbers(&outcome);
    assert!(numbers.last() > Some(&60), "it goes on: {numbers:?}");
    for step in numbers.windows(2) {
        assert!(
            step[1] + 1 >= step[0] && step[1] <= step[0] + 2,
            "{step:?} in {numbers:?}"
        );
    }
}
