//! Hosts that are killed, hit and stopped from outside, by the machine's clock.

use std::time::Duration;

use rustix::process::Signal;
use serde_json::Value;
use tests::{Application, Host, Member, Outcome, until};

use super::{healthy, healthy_missed_nothing, recovered};

/// What is done to a host, and what the container makes of it.
const BLOWS: [(Signal, &str); 3] = [
    (Signal::KILL, "host_ended"),
    (Signal::SEGV, "host_ended"),
    (Signal::STOP, "hang"),
];

/// A process that was killed is gone at once; a busy machine gets more.
const LIMIT: Duration = Duration::from_secs(30);

/// Somebody beside the healthy chain who is going to be hit.
fn with_victim(victim: &Member) -> Application {
    healthy().with(victim).in_hosts()
}

/// Hits the victim's host `times` as soon as it works, and waits until it works again.
fn hit(application: &Application, signal: Signal, times: usize) -> Outcome {
    hit_until(application, signal, times, "")
}

/// As [`hit`], and waits until `words` stand among the events: how a process ended is known later
/// than that it did.
fn hit_until(application: &Application, signal: Signal, times: usize, words: &str) -> Outcome {
    let run = application.start(&[]);
    application.wait_until(|events| events.matches("got ").count() > 5);
    for time in 1..=times {
        let host = run.host_of("victim");
        assert!(host.signal(signal), "it is there");
        application.wait_until(|events| recovered(events, "victim", time));
        assert!(host.is_gone(), "{host:?} is left over");
    }
    application.wait_until(|events| events.contains(words));
    application.interrupt(run).ended_well()
}

fn kinds(outcome: &Outcome) -> Vec<String> {
    let faults = outcome.faults("victim").into_iter();
    faults.map(|(kind, _)| kind).collect()
}

#[test]
fn a_host_that_is_hit_is_a_fault_of_its_component_alone() {
    for (signal, kind) in BLOWS {
        let application = with_victim(&Member::new("victim", "counter"));
        let outcome = hit(&application, signal, 3);
        assert_eq!(kinds(&outcome), [kind; 3], "{signal:?}");
        assert_eq!(outcome.actions(), ["reset victim: done"; 3], "{signal:?}");
        let victim = outcome.component("victim");
        assert_eq!(victim["incarnation"], 4, "{signal:?}: {victim}");
        assert_eq!(victim["state"], "ACTIVE", "{signal:?}: {victim}");
        healthy_missed_nothing(&outcome, &format!("{signal:?}"));
    }
}

/// It says how the process ended.
#[test]
fn the_verdict_tells_how_the_host_ended() {
    for (signal, words) in [(Signal::KILL, "signal: 9"), (Signal::SEGV, "signal: 11")] {
        let application = with_victim(&Member::new("victim", "counter"));
        let outcome = hit_until(&application, signal, 1, words);
        let verdicts = outcome.verdicts();
        let verdict = verdicts.first().expect("there is one");
        assert_eq!(verdict["cause"], "root", "{verdict}");
        assert!(verdict.to_string().contains(words), "{verdict}");
        for time in ["detection_us", "decision_us", "handling_us"] {
            assert!(verdict[time].is_u64(), "{time} of {verdict}");
        }
    }
}

/// Its cycles are so far apart that it is hit between two of them.
#[test]
fn a_host_that_dies_between_two_callbacks_is_replaced_with_the_next() {
    let victim = Member::new("victim", "diary").period(500);
    let application = with_victim(&victim);
    let outcome = {
        let run = application.start(&[]);
        application.wait_until(|events| {
            events.contains(
                "\"component\":\"victim\",\"level\":\"information\",\"message\":\"onUpdated\"",
            )
        });
        assert!(run.host_of("victim").signal(Signal::KILL));
        application.wait_until(|events| recovered(events, "victim", 1));
        application.interrupt(run).ended_well()
    };
    let expected = ("host_ended".to_owned(), "no callback".to_owned());
    assert_eq!(outcome.faults("victim"), [expected]);
    assert_eq!(outcome.actions(), ["reset victim: done"]);
    healthy_missed_nothing(&outcome, "between two callbacks");
}

/// Nobody calls it, and nobody is going to: whoever reaps the process lets its executor look.
#[test]
fn a_host_that_dies_while_nobody_calls_it_is_missed_at_once() {
    for kind in ["aperiodic", "passive"] {
        let victim = Member::new("victim", "listener").kind(kind);
        let outcome = hit(&with_victim(&victim), Signal::KILL, 2);
        let expected = ("host_ended".to_owned(), "no callback".to_owned());
        assert_eq!(
            outcome.faults("victim"),
            [expected.clone(), expected],
            "{kind}"
        );
        assert_eq!(outcome.actions(), ["reset victim: done"; 2], "{kind}");
        healthy_missed_nothing(&outcome, kind);
    }
}

/// The standby dies first, the component right after it: what is dead takes no place.
#[test]
fn a_dead_standby_takes_no_place() {
    for preload in ["loaded", "warm"] {
        let application = with_victim(&Member::new("victim", "counter"))
            .with_profile(&Member::new("second", "counter"))
            .rules(&format!(
                "<component name='victim'><fault><retry_max>0</retry_max>\
                 <secondary preload='{preload}'><reference>second.xml</reference></secondary>\
                 </fault></component>"
            ));
        let run = application.start(&[]);
        application.wait_until(|events| events.matches("got ").count() > 5);
        let hosts = run.hosts().into_iter();
        let hosts: Vec<Host> = hosts.filter(|host| host.runs("victim")).collect();
        let [present, standbys @ ..] = hosts.as_slice() else {
            panic!("nobody runs it");
        };
        assert!(
            !standbys.is_empty(),
            "who stands by has a process of its own"
        );
        for standby in standbys {
            assert!(standby.signal(Signal::KILL));
            assert!(until(LIMIT, || standby.is_gone()), "{standby:?}");
        }
        assert!(present.signal(Signal::KILL));
        application.wait_until(|events| recovered(events, "victim", 1));
        let outcome = application.interrupt(run).ended_well();
        assert_eq!(outcome.actions(), ["replace victim by second: done"]);
        assert_eq!(kinds(&outcome), ["host_ended"], "{preload}");
        assert_eq!(outcome.component("victim")["state"], "ACTIVE");
        healthy_missed_nothing(&outcome, preload);
    }
}

/// All of them at once: everyone comes back.
#[test]
fn all_hosts_die_at_once() {
    let application = healthy().in_hosts();
    let run = application.start(&[]);
    application.wait_until(|events| events.matches("got ").count() > 5);
    for host in run.hosts() {
        assert!(host.signal(Signal::KILL));
    }
    let both = |events: &str| recovered(events, "counter", 1) && recovered(events, "recorder", 1);
    application.wait_until(both);
    let outcome = application.interrupt(run).ended_well();
    for component in ["counter", "recorder"] {
        let status: &Value = outcome.component(component);
        assert_eq!(status["state"], "ACTIVE", "{status}");
        let faults = outcome.faults(component);
        // Who stood by was hit, too; while it dies it may still be taken, and is replaced as well.
        assert!((1..=2).contains(&faults.len()), "{faults:?}");
        assert_eq!(status["incarnation"], faults.len() + 1, "{status}");
        assert!(
            faults.iter().all(|fault| fault.0 == "host_ended"),
            "{faults:?}"
        );
    }
}
