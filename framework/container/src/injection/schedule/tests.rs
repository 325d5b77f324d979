//! Injections in cycles of 20 ms, the first one at 0.

use system_model::injection::{Repetition, WorldFault};
use system_model::specification::Place;

use super::*;

const CYCLE: Duration = Duration::from_millis(20);
const COMPONENT: usize = 3;

const fn ms(number: u64) -> Duration {
    Duration::from_millis(number)
}

fn callback(misbehaviour: Misbehaviour) -> InjectedFault {
    InjectedFault::Callback {
        component: COMPONENT,
        callback: CallbackName::Execute,
        misbehaviour,
    }
}

fn injection(trigger: Trigger, what: InjectedFault) -> Injection {
    Injection {
        trigger,
        lasting: None,
        repetition: None,
        probability: None,
        what,
        place: Place::default(),
    }
}

const fn at_cycle(cycle: u64) -> Trigger {
    Trigger::AtCycle {
        component: COMPONENT,
        cycle,
    }
}

const fn at(time_ms: u64) -> Trigger {
    Trigger::At(ms(time_ms))
}

/// In which of `cycles` cycles the callback misbehaves.
fn struck(schedule: &mut Schedule, cycles: u32) -> Vec<u32> {
    let mut struck = Vec::new();
    for cycle in 1..=cycles {
        let now = CYCLE * (cycle - 1);
        schedule.advance(now, Some((COMPONENT, u64::from(cycle))), |_, _| ());
        schedule.misbehave(COMPONENT, CallbackName::Execute, |_, _| struck.push(cycle));
    }
    struck
}

const fn time(times: Option<u32>, every_ms: u64) -> Option<Repetition> {
    let every = Interval::Time(ms(every_ms));
    Some(Repetition { times, every })
}

const fn cycles(times: Option<u32>, every: u64) -> Option<Repetition> {
    let every = Interval::Cycles(every);
    Some(Repetition { times, every })
}

/// When and how often, and the cycles that are struck.
struct Case(
    Trigger,
    Option<Duration>,
    Option<Repetition>,
    &'static [u32],
);

/// Of a panic, which happens once.
const ONCE: [Case; 10] = [
    Case(at(0), None, None, &[1]),
    Case(at(50), None, None, &[4]),
    Case(at_cycle(6), None, None, &[6]),
    Case(at(40), Some(ms(60)), None, &[3, 4, 5]),
    // Shorter than a cycle.
    Case(at(45), Some(ms(5)), None, &[4]),
    Case(at(20), None, time(Some(3), 60), &[2, 5, 8]),
    // Each a little late, as 30, 80 and 130 ms lie between two cycles.
    Case(at(30), None, time(Some(3), 50), &[3, 5, 8]),
    // More often than there are cycles.
    Case(at(0), None, time(Some(3), 1), &[1, 2, 3]),
    Case(at_cycle(2), None, cycles(None, 4), &[2, 6, 10]),
    Case(at_cycle(2), None, cycles(Some(2), 3), &[2, 5]),
];

/// Of slowness, which lasts.
const LASTING: [Case; 2] = [
    Case(at_cycle(9), None, None, &[9, 10, 11, 12]),
    Case(at(0), Some(ms(40)), time(Some(2), 100), &[1, 2, 6, 7]),
];

#[test]
fn callbacks_are_struck_in_the_cycles_that_the_tables_say() {
    let slow = Misbehaviour::Slow(ms(5));
    for (misbehaviour, cases) in [(Misbehaviour::Panic, &ONCE[..]), (slow, &LASTING)] {
        for (number, Case(trigger, lasting, repetition, expected)) in cases.iter().enumerate() {
            let injection = Injection {
                lasting: *lasting,
                repetition: *repetition,
                ..injection(*trigger, callback(misbehaviour))
            };
            let mut schedule = Schedule::new([injection], 1).unwrap();
            let found = struck(&mut schedule, 12);
            assert_eq!(found, *expected, "{misbehaviour:?}, case {number}");
        }
    }
}

#[test]
fn beginnings_and_ends_are_reported_once() {
    let smoke = |from, lasting, every| Injection {
        lasting: Some(ms(lasting)),
        repetition: Some(Repetition {
            times: Some(2),
            every: Interval::Time(ms(every)),
        }),
        ..injection(
            Trigger::At(ms(from)),
            InjectedFault::World {
                component: None,
                fault: WorldFault::CameraSmoke(0.5),
            },
        )
    };
    // The second one is open when it begins again, and then stays longer.
    let mut schedule = Schedule::new([smoke(10, 10, 30), smoke(10, 30, 20)], 1).unwrap();
    let mut changes = Vec::new();
    for now in (0..100).step_by(10) {
        schedule.advance(ms(now), None, |number, change| {
            changes.push((now, number, change));
        });
    }
    use Change::{Begins, Ends};
    let expected = [
        (10, 0, Begins),
        (10, 1, Begins),
        (20, 0, Ends),
        (40, 0, Begins),
        (50, 0, Ends),
        (60, 1, Ends),
    ];
    assert_eq!(changes, expected);
    assert!(schedule.is_over());
}

#[test]
fn cycles_of_others_and_other_callbacks_do_not_count() {
    let mut schedule = Schedule::new([injection(at_cycle(2), callback(Misbehaviour::Hang))], 1)
        .expect("room for one");
    schedule.advance(ms(0), Some((COMPONENT + 1, 2)), |_, _| panic!());
    schedule.advance(ms(20), Some((COMPONENT, 1)), |_, _| panic!());
    schedule.advance(ms(40), None, |_, _| panic!());
    schedule.advance(ms(60), Some((COMPONENT, 2)), |_, _| ());
    schedule.misbehave(COMPONENT + 1, CallbackName::Execute, |_, _| panic!());
    schedule.misbehave(COMPONENT, CallbackName::Stop, |_, _| panic!());
    assert!(schedule.is_open(0));
    let mut struck = 0;
    schedule.misbehave(COMPONENT, CallbackName::Execute, |_, _| struck += 1);
    assert_eq!(struck, 1);
    assert!(!schedule.is_open(0) && schedule.is_over());
}

#[test]
fn a_callback_dies_once_and_what_lasts_goes_on() {
    use Misbehaviour::{Abort, Leak, Panic};
    let now = Trigger::At(Duration::ZERO);
    let all = [Panic, Leak(8), Abort].map(|what| injection(now, callback(what)));
    let mut schedule = Schedule::new(all, 1).unwrap();
    let mut calls = Vec::new();
    for cycle in 1..=3 {
        schedule.advance(ms(0), Some((COMPONENT, cycle)), |_, _| ());
        let mut call = Vec::new();
        schedule.misbehave(COMPONENT, CallbackName::Execute, |_, what| call.push(what));
        calls.push(call);
    }
    let expected: [&[Misbehaviour]; 3] = [&[Panic, Leak(8)], &[Leak(8), Abort], &[Leak(8)]];
    assert_eq!(calls, expected);
}

#[test]
fn chance_is_the_seeds() {
    let draw = |probability, seed| {
        let injection = Injection {
            probability: Some(probability),
            ..injection(at_cycle(1), callback(Misbehaviour::Panic))
        };
        struck(&mut Schedule::new([injection], seed).unwrap(), 2000)
    };
    assert_eq!(draw(0.0, 1).len(), 0);
    assert_eq!(draw(1.0, 1).len(), 2000);
    let some = draw(0.1, 1);
    // Ten standard deviations of a binomial distribution to either side.
    assert!((66..=334).contains(&some.len()), "{}", some.len());
    assert_eq!(draw(0.1, 1), some);
    assert_ne!(draw(0.1, 2), some);
}

#[test]
fn the_container_fails_once_or_for_a_while() {
    use ContainerFailure::{CheckpointCorrupt, LibraryMissing, RecoveryFails};
    let fail = |failure, lasting| Injection {
        lasting,
        ..injection(
            Trigger::At(Duration::ZERO),
            InjectedFault::Container {
                component: COMPONENT,
                failure,
            },
        )
    };
    let all = [
        fail(LibraryMissing, None),
        fail(RecoveryFails, Some(ms(50))),
    ];
    let mut schedule = Schedule::new(all, 1).unwrap();
    assert_eq!(schedule.fails(COMPONENT, LibraryMissing), None);
    schedule.advance(ms(0), None, |_, _| ());
    assert_eq!(schedule.fails(COMPONENT + 1, LibraryMissing), None);
    assert_eq!(schedule.fails(COMPONENT, CheckpointCorrupt), None);
    assert_eq!(schedule.fails(COMPONENT, LibraryMissing), Some(0));
    assert_eq!(schedule.fails(COMPONENT, LibraryMissing), None);
    for (now, expected) in [(10, Some(1)), (49, Some(1)), (50, None)] {
        schedule.advance(ms(now), None, |_, _| ());
        assert_eq!(schedule.fails(COMPONENT, RecoveryFails), expected);
    }
}

#[test]
fn what_is_asked_later_counts_from_then_and_there_is_a_limit() {
    let panic = || injection(Trigger::At(ms(100)), callback(Misbehaviour::Panic));
    let mut schedule = Schedule::new([], 1).unwrap();
    assert_eq!(schedule.add(panic(), ms(5000)), Ok(0));
    schedule.advance(ms(5099), None, |_, _| panic!("too early"));
    schedule.advance(ms(5100), None, |_, _| ());
    assert!(schedule.is_open(0));
    let many = std::iter::repeat_with(panic).take(MAX_INJECTIONS + 1);
    assert!(matches!(Schedule::new(many, 1), Err(TooManyInjections)));
}
