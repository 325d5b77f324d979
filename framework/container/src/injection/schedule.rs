//! Which injections are open: a state machine for each, driven by time and by the cycles of
//! components.

use std::time::Duration;

use rand::RngExt;
use rand_pcg::Pcg64;
use system_model::injection::{
    CallbackName, ContainerFailure, InjectedFault, Injection, Interval, MAX_INJECTIONS,
    Misbehaviour, Trigger,
};

use super::{Purpose, stream};

/// The injections of a run and where each of them stands.
///
/// [`Schedule::advance`] opens and closes them; between two calls it does nothing. What goes wrong
/// is asked at each opportunity: a call of a callback, a datum, a load or recovery.
#[derive(Debug)]
pub struct Schedule {
    entries: Vec<Entry>,
    seed: u64,
}

/// What happened to an injection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// It is open from now on. One that is open already and begins again is not reported.
    Begins,
    /// Its time is over. One that happens once ends when it strikes, and that is not reported.
    Ends,
}

/// More than [`MAX_INJECTIONS`] were asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("there are {MAX_INJECTIONS} injections already; a run takes no more")]
pub struct TooManyInjections;

#[derive(Debug)]
struct Entry {
    injection: Injection,
    /// When it begins next.
    due: Option<Due>,
    /// How often it may still begin; `None`: without end.
    beginnings_left: Option<u32>,
    open: Option<Open>,
    chance: Pcg64,
}

#[derive(Debug, Clone, Copy)]
enum Due {
    At(Duration),
    AtCycle { component: usize, cycle: u64 },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Open {
    /// Until its next opportunity.
    Once,
    /// Until this time; `None`: for ever.
    Until(Option<Duration>),
}

impl Schedule {
    /// The injections of a run; times count from its start. Their order is that of their numbers.
    ///
    /// # Errors
    /// If there are more than [`MAX_INJECTIONS`].
    pub fn new(
        injections: impl IntoIterator<Item = Injection>,
        seed: u64,
    ) -> Result<Self, TooManyInjections> {
        let mut schedule = Self::empty(seed);
        for injection in injections {
            schedule.add(injection, Duration::ZERO)?;
        }
        Ok(schedule)
    }

    /// A run without injections so far.
    pub fn empty(seed: u64) -> Self {
        Self {
            entries: Vec::new(),
            seed,
        }
    }

    /// Adds an injection whose times count from `now`, and returns its number.
    ///
    /// # Errors
    /// If there are [`MAX_INJECTIONS`] already.
    pub fn add(&mut self, injection: Injection, now: Duration) -> Result<usize, TooManyInjections> {
        let number = self.len();
        if number >= MAX_INJECTIONS {
            return Err(TooManyInjections);
        }
        let due = match injection.trigger {
            Trigger::At(after) => Due::At(now.saturating_add(after)),
            Trigger::AtCycle { component, cycle } => Due::AtCycle { component, cycle },
        };
        self.entries.push(Entry {
            due: Some(due),
            beginnings_left: injection
                .repetition
                .map_or(Some(1), |repetition| repetition.times),
            open: None,
            chance: stream(self.seed, number, Purpose::Chance),
            injection,
        });
        Ok(number)
    }

    /// How many there are: the number of the next one.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The injection of a number.
    pub fn injection(&self, number: usize) -> Option<&Injection> {
        self.entries.get(number).map(|entry| &entry.injection)
    }

    /// Whether an injection is open.
    #[cfg(test)]
    fn is_open(&self, number: usize) -> bool {
        let entry = self.entries.get(number);
        entry.is_some_and(|entry| entry.open.is_some())
    }

    /// Whether nothing is open and nothing will begin any more.
    #[cfg(test)]
    fn is_over(&self) -> bool {
        let mut entries = self.entries.iter();
        entries.all(|entry| entry.due.is_none() && entry.open.is_none())
    }

    /// Opens and closes injections: it is `now`, and if `cycle` is given a component (by index) is
    /// about to begin its n-th `onExecute`, counted from 1. Calls `changed` with the number of each
    /// injection that something happened to, those that end before those that begin.
    pub fn advance(
        &mut self,
        now: Duration,
        cycle: Option<(usize, u64)>,
        mut changed: impl FnMut(usize, Change),
    ) {
        for (number, entry) in self.entries.iter_mut().enumerate() {
            if entry.close(now) {
                changed(number, Change::Ends);
            }
        }
        for (number, entry) in self.entries.iter_mut().enumerate() {
            if entry.begin(now, cycle) {
                changed(number, Change::Begins);
            }
        }
    }

    /// Whether an open injection strikes at this opportunity of it. One that happens once is over
    /// with that.
    pub fn strikes(&mut self, number: usize) -> bool {
        let entry = self.entries.get_mut(number);
        entry.is_some_and(Entry::strike)
    }

    /// What this call of a callback is made to do, in the order of the injections: everything that
    /// lasts, and of all that a callback can do but once in its life, the first.
    pub fn misbehave(
        &mut self,
        component: usize,
        callback: CallbackName,
        mut with: impl FnMut(usize, Misbehaviour),
    ) {
        let mut ended = false;
        for (number, entry) in self.entries.iter_mut().enumerate() {
            let InjectedFault::Callback {
                component: of,
                callback: called,
                misbehaviour,
            } = entry.injection.what
            else {
                continue;
            };
            let lasts = entry.injection.what.lasts();
            if (of, called) != (component, callback) || (ended && !lasts) || !entry.strike() {
                continue;
            }
            ended |= !lasts;
            with(number, misbehaviour);
        }
    }

    /// The number of the injection that makes this load, restoration or recovery of a component
    /// fail, if one does.
    pub fn fails(&mut self, component: usize, failure: ContainerFailure) -> Option<usize> {
        let wanted = InjectedFault::Container { component, failure };
        self.entries
            .iter_mut()
            .position(|entry| entry.injection.what == wanted && entry.strike())
    }
}

impl Entry {
    /// Closes it if its time is over.
    fn close(&mut self, now: Duration) -> bool {
        let over = matches!(self.open, Some(Open::Until(Some(until))) if until <= now);
        if over {
            self.open = None;
        }
        over
    }

    /// Opens it if it is due; whether it was not open before.
    fn begin(&mut self, now: Duration, cycle: Option<(usize, u64)>) -> bool {
        let due = match (self.due, cycle) {
            (Some(Due::At(time)), _) => time <= now,
            (Some(Due::AtCycle { component, cycle }), Some((running, number))) => {
                running == component && cycle <= number
            }
            _ => false,
        };
        if !due {
            return false;
        }
        self.beginnings_left = self.beginnings_left.map(|left| left.saturating_sub(1));
        self.due = self.next_due(now, cycle);
        let lasting = self.injection.lasting;
        let stays = self.injection.what.lasts() || self.injection.probability.is_some();
        let open = match lasting {
            Some(lasting) => Open::Until(Some(now.saturating_add(lasting))),
            None if stays => Open::Until(None),
            None => Open::Once,
        };
        self.open.replace(open).is_none()
    }

    /// When it begins after the beginning that is due now. Beginnings that nobody was there for are
    /// left out: the next one lies ahead.
    fn next_due(&self, now: Duration, cycle: Option<(usize, u64)>) -> Option<Due> {
        if self.beginnings_left == Some(0) {
            return None;
        }
        match (self.due?, self.injection.repetition?.every) {
            (Due::At(due), Interval::Time(every)) => {
                let late = now.saturating_sub(due);
                let missed = late.as_nanos().checked_div(every.as_nanos())?;
                let missed = u32::try_from(missed).unwrap_or(u32::MAX);
                let ahead = every.saturating_mul(missed.saturating_add(1));
                Some(Due::At(due.saturating_add(ahead)))
            }
            (Due::AtCycle { component, .. }, Interval::Cycles(every)) => {
                let (_, running) = cycle?;
                Some(Due::AtCycle {
                    component,
                    cycle: running.saturating_add(every),
                })
            }
            // No reader makes these; they would never begin again.
            (Due::At(_), Interval::Cycles(_)) | (Due::AtCycle { .. }, Interval::Time(_)) => None,
        }
    }

    fn strike(&mut self) -> bool {
        let Some(open) = self.open else {
            return false;
        };
        let strikes = match self.injection.probability {
            Some(probability) => self.chance.random_bool(probability.clamp(0.0, 1.0)),
            None => true,
        };
        if strikes && open == Open::Once {
            self.open = None;
        }
        strikes
    }
}

#[cfg(test)]
mod tests;
