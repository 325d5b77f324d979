//! Whatever is killed whenever: nothing is left that lives, is dead and not reaped, lies about in
//! shared memory, or hinders the next start.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use rustix::process::Signal;
use tests::{Application, Member, Watched, processes_that_mention, until, zombies};

use super::chance::Chance;

/// Random kills in all.
const KILLS: u32 = 200;

/// One in so many hits the container, the others hosts of it.
const CONTAINER_EVERY: u32 = 4;

/// Kills come within so many milliseconds after each other: while it loads, while hosts start,
/// while they are recovered, while it runs.
const LONGEST_PAUSE_MS: u64 = 100;

/// Processes that lose what they depend on end at once; a busy machine gets more.
const LIMIT: Duration = Duration::from_secs(30);

/// Small components in processes of their own that are recovered however often they die.
fn application() -> Application {
    let expendable = |name: &&str| {
        format!(
            "<component name='{name}'><fault window='1s' backoff='0'><retry_max>100</retry_max>\
             </fault></component>"
        )
    };
    Application::new()
        .with(&Member::new("counter", "counter").property("remembers", "true"))
        .with(&Member::new("recorder", "recorder"))
        .with(&Member::new("listener", "listener").kind("aperiodic"))
        .connect("data", "counter.output", "recorder.input")
        .rules(
            &["counter", "recorder", "listener"]
                .iter()
                .map(expendable)
                .collect::<String>(),
        )
        .in_hosts()
}

/// Files in shared memory.
fn shared_memory() -> BTreeSet<String> {
    let entries = std::fs::read_dir("/dev/shm")
        .into_iter()
        .flatten()
        .flatten();
    entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect()
}

/// Nothing of a killed run is left that lives.
#[track_caller]
fn nothing_lives(application: &Application) {
    let folder = application.folder().display().to_string();
    let mut left = Vec::new();
    let all_gone = || {
        left = processes_that_mention(&folder);
        left.is_empty()
    };
    assert!(until(LIMIT, all_gone), "still there: {left:?}");
}

/// Hits hosts of a run until it is the container's turn, or it has ended because one of its hosts
/// did not come up; how many blows that took.
fn kill_hosts(run: &mut Watched, kills: u32, chance: &mut Chance) -> u32 {
    let mut done = 0;
    while done < kills && run.is_running() {
        std::thread::sleep(Duration::from_millis(chance.below(LONGEST_PAUSE_MS)));
        let hosts = run.hosts();
        if hosts.is_empty() {
            continue;
        }
        let chosen = chance.index(hosts.len());
        // One that ended meanwhile was not killed.
        done += u32::from(hosts[chosen].signal(Signal::KILL));
    }
    done
}

#[test]
fn two_hundred_random_kills_leave_nothing() {
    let mut chance = Chance::new(0);
    let application = application();
    let before = shared_memory();
    let began = Instant::now();
    let mut kills = 0;
    while kills < KILLS {
        let mut run = application.start(&[]);
        let of_hosts = u32::try_from(chance.below(2 * u64::from(CONTAINER_EVERY))).unwrap_or(0);
        kills += kill_hosts(&mut run, of_hosts, &mut chance);
        std::thread::sleep(Duration::from_millis(chance.below(LONGEST_PAUSE_MS)));
        if run.is_running() {
            run.signal(Signal::KILL);
            kills += 1;
        }
        let finished = run.wait(LIMIT);
        // Killed; or refused, because what it had started to load or run something in was killed.
        let refused = finished.code.is_some_and(|code| (1..=6).contains(&code));
        assert!(finished.code.is_none() || refused, "{finished}");
        nothing_lives(&application);
    }
    println!("{kills} kills in {:?}", began.elapsed());
    // Those of tests beside this one are reaped soon; what is left would stay.
    let all_reaped = until(LIMIT, || zombies() == 0);
    assert!(all_reaped, "dead children were left to the caller");
    let new: Vec<String> = shared_memory().difference(&before).cloned().collect();
    let ours = |name: &&String| name.contains("steadfast") || name.contains("component");
    assert_eq!(new.iter().find(ours), None, "{new:?}");
    next_start_works(&application);
}

/// In the same folders, without anything having been cleaned; and what dead runs had left is gone.
#[track_caller]
fn next_start_works(application: &Application) {
    let operator = application.operator();
    let run = application.start(&[]);
    let socket = operator.socket();
    assert_eq!(
        operator.sockets(),
        [socket],
        "sockets of dead runs are gone"
    );
    application.wait_until(|events| events.matches("\"to\":\"ACTIVE\"").count() == 3);
    let outcome = application.interrupt(run).ended_well();
    for component in ["counter", "recorder", "listener"] {
        assert_eq!(outcome.component(component)["state"], "ACTIVE");
        assert_eq!(outcome.component(component)["incarnation"], 1);
    }
    assert!(operator.sockets().is_empty(), "it took its socket away");
    nothing_lives(application);
}
