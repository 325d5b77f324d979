//! Robots that lose each other and meet again: one of them decides, and no actuator obeys two.

use super::forwarder::{Cut, Forwarder};
use super::*;

/// Cycles that tell whom an actuator obeys.
const CYCLES: usize = 50;

/// Who has decided so far for a robot, and in which term.
fn reigns(application: &Application) -> Vec<(String, u64)> {
    let events = application.events_so_far();
    let events = events
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let decided = events.filter(|event| event["event"] == "robot" && event["change"] == "decides");
    let reign = |event: Value| {
        let term = word(&event["message"]).strip_prefix("term ");
        let term = term.and_then(|term| term.parse().ok()).expect("a term");
        (word(&event["robot"]).to_owned(), term)
    };
    decided.map(reign).collect()
}

/// Waits until a robot decides by its own record in a later term than this one; returns that. What
/// others know of a term when they begin to follow may be older.
fn wait_for_reign(application: &Application, robot: &str, later_than: u64) -> u64 {
    let reign = || {
        let latest = reigns(application).pop();
        latest.filter(|(decider, term)| decider == robot && *term > later_than)
    };
    application.wait_until(|_events| reign().is_some());
    reign().expect("it was just found").1
}

/// Waits until a robot follows another one.
fn wait_for_decider(application: &Application, robot: &str) {
    application.wait_until(|_events| {
        let latest = reigns(application).pop();
        latest.is_some_and(|(decider, _term)| decider == robot)
    });
}

/// Waits until data of a robot were refused because of another one's in a term.
fn wait_for_refusal(application: &Application, refused: &str, obeyed: &str, term: u64) {
    application.wait_until(|events| {
        events.lines().any(|line| {
            line.contains(&format!("{refused} (term "))
                && line.contains(&format!("is not obeyed: {obeyed} (term {term},"))
        })
    });
}

/// The numbers of the last cycles in which the recorder got something, once there are so many more.
fn next_numbers(application: &Application) -> Vec<u64> {
    let numbers = |events: &str| -> Vec<u64> {
        let got = events
            .lines()
            .filter_map(|line| line.split("\"got ").nth(1));
        let numbers = got.flat_map(|rest| rest.split('"').next().unwrap_or_default().split(' '));
        let numbers = numbers.filter_map(|number| number.split('=').next()?.parse().ok());
        numbers.collect()
    };
    let before = numbers(&application.events_so_far()).len();
    application.wait_until(|events| numbers(events).len() >= before + CYCLES);
    numbers(&application.events_so_far()).split_off(before)
}

/// Both count on by one in each cycle, and the first one is far ahead: who obeys both in turn goes
/// back and forth.
fn obeys_one(application: &Application) {
    let numbers = next_numbers(application);
    let is_one = numbers.windows(2).all(|pair| pair[0] < pair[1]);
    assert!(is_one, "numbers of more than one robot: {numbers:?}");
}

/// `R1` beyond a line; `R2`, and `R3` with the actuator, on this side of it.
fn a_partition_heals(cut: Cut) {
    let _turn = take_turn();
    let (one, other, third) = (free_port(), free_port(), free_port());
    let line = Forwarder::to(one);
    let first = counting(&network("R1", one, &[], OFFER));
    let second = counting(&network("R2", other, &[line.port()], OFFER));
    let sources = from("R1") + &from("R2");
    let actuator = recording(&network("R3", third, &[line.port(), other], &sources));
    let _first = start(&first);
    let before = wait_for_reign(&first, "R1", 0);
    let (_second, _actuator) = (start(&second), start(&actuator));
    wait_for_decider(&second, "R1");
    wait_for_decider(&actuator, "R1");
    wait_for_refusal(&actuator, "R2", "R1", before);
    obeys_one(&actuator);

    line.cut(cut);
    let apart = wait_for_reign(&second, "R2", before);
    wait_for_decider(&actuator, "R2");
    wait_for(&first, "R2 died", 1);
    wait_for(&first, "R3 died", 1);
    obeys_one(&actuator);
    let alone = reigns(&first).pop();
    assert_eq!(alone, Some(("R1".to_owned(), before)), "who decides beyond");

    line.heal();
    let again = wait_for_reign(&first, "R1", apart);
    wait_for_decider(&second, "R1");
    wait_for_decider(&actuator, "R1");
    wait_for_refusal(&actuator, "R2", "R1", again);
    obeys_one(&actuator);
    assert_eq!(reigns(&first).last(), Some(&("R1".to_owned(), again)));
    assert!(
        reigns(&second)
            .iter()
            .filter(|(decider, _)| decider == "R2")
            .count()
            == 1
    );
}

#[test]
fn after_a_partition_that_ended_connections_one_is_obeyed() {
    a_partition_heals(Cut::Closed);
}

#[test]
fn after_a_partition_that_swallowed_everything_one_is_obeyed() {
    a_partition_heals(Cut::Silent);
}

#[test]
fn a_robot_that_comes_back_is_taken_back() {
    let _turn = take_turn();
    let (one, other, third) = (free_port(), free_port(), free_port());
    let first = counting(&network("R1", one, &[], OFFER));
    let second = counting(&network("R2", other, &[one], OFFER));
    let sources = from("R1") + &from("R2");
    let actuator = recording(&network("R3", third, &[one, other], &sources));
    let killed = start(&first);
    let (_second, _actuator) = (start(&second), start(&actuator));
    let before = wait_for_reign(&first, "R1", 0);
    wait_for_decider(&actuator, "R1");
    wait_for_decider(&second, "R1");
    wait_for_data(&actuator);
    killed.signal(Signal::KILL);
    drop(killed);
    let meanwhile = wait_for_reign(&second, "R2", before);
    wait_for_data(&actuator);
    let _again = start(&first);
    wait_for(&actuator, "R1 appeared", 2);
    let again = wait_for_reign(&first, "R1", meanwhile);
    wait_for_refusal(&actuator, "R2", "R1", again);
    wait_for_data(&actuator);
}

#[test]
fn a_feeder_that_does_not_decide_is_replaced_as_well() {
    let _turn = take_turn();
    let (zero, one, other) = (free_port(), free_port(), free_port());
    let sources = from("R1") + &from("R2");
    let actuator = recording(&network("R0", zero, &[], &sources));
    let first = counting(&network("R1", one, &[zero], OFFER));
    let second = counting(&network("R2", other, &[zero, one], OFFER));
    let _actuator = start(&actuator);
    let (killed, _second) = (start(&first), start(&second));
    let reign = wait_for_reign(&actuator, "R0", 0);
    wait_for_refusal(&actuator, "R2", "R1", reign);
    killed.signal(Signal::KILL);
    wait_for(&actuator, "R1 died", 1);
    wait_for_data(&actuator);
    assert_eq!(reigns(&actuator), [("R0".to_owned(), reign)]);
}
