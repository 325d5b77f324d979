//! What is left of an injection in a run that has lasted for a while.

use std::time::Duration;

use system_model::injection::{Injection, Interval, Repetition, Trigger};

/// The injection as a container makes it that comes into a run after `run_time`: what is over is not
/// made again, what lasts is. Cycles are counted anew by each container, and injections by them with
/// them. None if nothing is left.
pub fn still_to_come(injection: &Injection, run_time: Duration) -> Option<Injection> {
    let Trigger::At(begins) = injection.trigger else {
        return Some(injection.clone());
    };
    if begins >= run_time {
        return Some(injection.clone());
    }
    let late = run_time - begins;
    match injection.repetition {
        Some(repetition) => repeated(injection, begins, late, repetition),
        None => once(injection, run_time, late),
    }
}

fn once(injection: &Injection, run_time: Duration, late: Duration) -> Option<Injection> {
    let lasting = match injection.lasting {
        Some(lasting) => Some(lasting.checked_sub(late).filter(|left| !left.is_zero())?),
        None if injection.what.lasts() || injection.probability.is_some() => None,
        None => return None,
    };
    Some(Injection {
        trigger: Trigger::At(run_time),
        lasting,
        ..injection.clone()
    })
}

/// The beginning before is left as it is: the next one comes soon enough.
fn repeated(
    injection: &Injection,
    begins: Duration,
    late: Duration,
    repetition: Repetition,
) -> Option<Injection> {
    let Interval::Time(every) = repetition.every else {
        return None;
    };
    let passed = late.as_nanos().checked_div(every.as_nanos())? + 1;
    let passed = u32::try_from(passed).unwrap_or(u32::MAX);
    let times = match repetition.times {
        Some(times) => Some(times.checked_sub(passed).filter(|left| *left > 0)?),
        None => None,
    };
    Some(Injection {
        trigger: Trigger::At(begins.saturating_add(every.saturating_mul(passed))),
        repetition: Some(Repetition {
            times,
            ..repetition
        }),
        ..injection.clone()
    })
}

#[cfg(test)]
mod tests {
    use system_model::injection::{CallbackName, InjectedFault, Misbehaviour, WorldFault};
    use system_model::specification::Place;

    use super::*;

    fn seconds(number: u64) -> Duration {
        Duration::from_secs(number)
    }

    fn injection(trigger: Trigger, lasting: Option<u64>, every: Option<(u64, u32)>) -> Injection {
        Injection {
            trigger,
            lasting: lasting.map(seconds),
            repetition: every.map(|(every, times)| Repetition {
                times: Some(times),
                every: Interval::Time(seconds(every)),
            }),
            probability: None,
            what: InjectedFault::Callback {
                component: 0,
                callback: CallbackName::Execute,
                misbehaviour: Misbehaviour::Panic,
            },
            place: Place::default(),
        }
    }

    /// Begins, lasts, repeats how often at what distance; what is left of it after 10 s.
    #[test]
    fn what_is_over_is_not_made_again() {
        type Times = (u64, Option<u64>, Option<(u64, u32)>);
        for (before, left) in [
            ((11, None, None), Some((11, None, None))),
            ((10, None, None), Some((10, None, None))),
            ((9, None, None), None),
            ((9, Some(5), None), Some((10, Some(4), None))),
            ((9, Some(1), None), None),
            ((1, None, Some((4, 5))), Some((13, None, Some((4, 2))))),
            ((2, None, Some((4, 3))), None),
            (
                (9, Some(5), Some((2, 9))),
                Some((11, Some(5), Some((2, 8)))),
            ),
        ] {
            let make = |(begins, lasting, every): Times| {
                injection(Trigger::At(seconds(begins)), lasting, every)
            };
            let found = still_to_come(&make(before), seconds(10));
            assert_eq!(found, left.map(make), "{before:?}");
        }
    }

    #[test]
    fn what_lasts_for_ever_is_made_again_and_so_is_what_counts_cycles() {
        let sonar = Injection {
            what: InjectedFault::World {
                component: None,
                fault: WorldFault::UnplugSonar(1),
            },
            ..injection(Trigger::At(seconds(1)), None, None)
        };
        let left = still_to_come(&sonar, seconds(10)).map(|left| left.trigger);
        assert_eq!(left, Some(Trigger::At(seconds(10))));
        let cycle = Trigger::AtCycle {
            component: 0,
            cycle: 3,
        };
        let by_cycle = injection(cycle, None, None);
        assert_eq!(still_to_come(&by_cycle, seconds(10)), Some(by_cycle));
    }
}
