//! What a lane's thread is in, published so that a watchdog can tell a hang. A callback costs its
//! thread four stores to memory of its own and the processor's counter, and no look at a clock.

use std::sync::atomic::{AtomicI32, AtomicU32, AtomicU64, Ordering};
use std::time::Duration;

use super::ticks::ticks;

/// How long a callback may take: a multiple of 100 us, at most seven hours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct CallLimit(u32);

/// Unit of a limit: a tenth of the watchdog's period, so that rounding does not count.
const UNIT: Duration = Duration::from_micros(100);

/// Bits of a limit; more would not leave room for depth and generation in one word.
const LIMIT_BITS: u32 = 28;
const LIMIT_MASK: u64 = (1 << LIMIT_BITS) - 1;

/// Bits of the depth: [`super::loss::DEEPEST_CALL_CHAIN`] fits.
const DEPTH_BITS: u32 = 4;
const DEPTH_MASK: u64 = (1 << DEPTH_BITS) - 1;

const GENERATION_SHIFT: u32 = LIMIT_BITS + DEPTH_BITS;

impl CallLimit {
    /// The callback is not watched.
    pub const NONE: Self = Self(0);

    /// The limit as a duration; zero if there is none.
    pub fn duration(self) -> Duration {
        UNIT * self.0
    }
}

impl From<Duration> for CallLimit {
    /// Rounded up; zero is no limit.
    fn from(limit: Duration) -> Self {
        let units = limit.as_nanos().div_ceil(UNIT.as_nanos());
        let most = u128::from(LIMIT_MASK);
        Self(u32::try_from(units.min(most)).unwrap_or(u32::MAX))
    }
}

/// What a thread is in at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Inside {
    /// Of this lane's callbacks the how many-th; comes round after 2^32.
    pub generation: u32,
    /// How many callbacks one inside the other, by service calls; 0: in none.
    pub depth: usize,
    /// Of the innermost; none also while the container answers a request on its own stack, where
    /// every wait has a deadline.
    pub limit: CallLimit,
}

impl Inside {
    fn from_word(word: u64) -> Self {
        let low = |bits: u64| u32::try_from(bits).unwrap_or(u32::MAX);
        Self {
            generation: low(word >> GENERATION_SHIFT),
            depth: low((word >> LIMIT_BITS) & DEPTH_MASK) as usize,
            limit: CallLimit(low(word & LIMIT_MASK)),
        }
    }
}

/// Being inside a callback.
#[derive(Debug)]
pub(crate) struct Watched {
    own: u64,
    outer: u64,
}

/// Written by the lane's one thread and read by the watchdog, except where it says otherwise.
#[derive(Debug, Default)]
pub struct Watch {
    /// Generation, depth, limit: one word, so that they are never of different callbacks.
    inside: AtomicU64,
    /// The processor's counter when the thread came there; never before `inside` was so.
    since_ticks: AtomicU64,
    /// Of all limits so far; 0: there was none.
    shortest: AtomicU32,
    generation: AtomicU32,
    /// The lane's thread as the kernel numbers it; 0: none.
    thread: AtomicI32,
    /// Generation that is to be broken off, with a mark in bit 32. Written by the watchdog.
    condemned: AtomicU64,
    /// How often a condemned callback was met where it cannot be taken off, weighted.
    refusals: AtomicU32,
    /// A limit for every callback while somebody waits for the lane; 0: nobody does.
    hurry: AtomicU32,
}

const CONDEMNED: u64 = 1 << 32;

impl Watch {
    /// Says that the calling thread is the lane's from now on.
    pub fn attach(&self) {
        let thread = rustix::thread::gettid().as_raw_nonzero().get();
        self.thread.store(thread, Ordering::Release);
    }

    /// Says that the lane has no thread any more.
    pub fn detach(&self) {
        self.thread.store(0, Ordering::Release);
    }

    /// The lane's thread, for [`super::interrupt`].
    pub fn thread(&self) -> Option<i32> {
        let thread = self.thread.load(Ordering::Acquire);
        (thread != 0).then_some(thread)
    }

    /// What the thread is in now.
    pub fn inside(&self) -> Inside {
        let mut inside = Inside::from_word(self.inside.load(Ordering::Acquire));
        let hurry = self.hurry.load(Ordering::Relaxed);
        if hurry > 0 && inside.limit > CallLimit(hurry) {
            inside.limit = CallLimit(hurry);
        }
        inside
    }

    /// The processor's counter when the thread came into what it is in, or later: to be asked after
    /// [`Self::inside`].
    pub(crate) fn since_ticks(&self) -> u64 {
        self.since_ticks.load(Ordering::Acquire)
    }

    /// The shortest limit of a callback that the lane has been in; none if none had one.
    pub(crate) fn shortest_limit(&self) -> CallLimit {
        CallLimit(self.shortest.load(Ordering::Relaxed))
    }

    /// From now on no callback may take longer than this: the fault manager waits for the lane,
    /// because one of its components has not worked for at least that long. [`CallLimit::NONE`]
    /// takes that back.
    pub fn hurry(&self, limit: CallLimit) {
        self.hurry.store(limit.0, Ordering::Relaxed);
    }

    /// The limit for as long as somebody waits; [`CallLimit::NONE`] if nobody does.
    pub fn hurry_limit(&self) -> CallLimit {
        CallLimit(self.hurry.load(Ordering::Relaxed))
    }

    /// Lets the handler break this generation off; called by the watchdog.
    pub fn condemn(&self, generation: u32) {
        let condemned = CONDEMNED | u64::from(generation);
        if self.condemned.swap(condemned, Ordering::AcqRel) != condemned {
            self.refusals.store(0, Ordering::Relaxed);
        }
    }

    /// What the thread is in, if just that is condemned. Called inside the handler.
    pub(super) fn condemned(&self) -> Option<Inside> {
        let inside = self.inside();
        let condemned = self.condemned.load(Ordering::Acquire);
        let is_meant = inside.depth > 0 && condemned == CONDEMNED | u64::from(inside.generation);
        is_meant.then_some(inside)
    }

    /// Adds the weight of a refusal; the sum of those before. Called inside the handler.
    pub(super) fn refuse(&self, weight: u32) -> u32 {
        self.refusals.fetch_add(weight, Ordering::Relaxed)
    }

    #[inline]
    pub(crate) fn enter(&self, limit: CallLimit) -> Watched {
        let generation = self.generation.load(Ordering::Relaxed).wrapping_add(1);
        self.generation.store(generation, Ordering::Relaxed);
        let outer = self.inside.load(Ordering::Relaxed);
        let depth = ((outer >> LIMIT_BITS) + 1) & DEPTH_MASK;
        let own = (u64::from(generation) << GENERATION_SHIFT)
            | (depth << LIMIT_BITS)
            | u64::from(limit.0);
        // One below zero is the longest of all.
        if limit.0.wrapping_sub(1) < self.shortest.load(Ordering::Relaxed).wrapping_sub(1) {
            self.shortest.store(limit.0, Ordering::Relaxed);
        }
        self.begin(own);
        Watched { own, outer }
    }

    /// In this from now on. The time is there first: it is never too early for what is read with it.
    #[inline]
    fn begin(&self, inside: u64) {
        self.since_ticks.store(ticks(), Ordering::Release);
        self.inside.store(inside, Ordering::Release);
    }

    #[inline]
    pub(super) fn pause(&self, watched: &Watched) {
        self.inside
            .store(watched.own & !LIMIT_MASK, Ordering::Relaxed);
    }

    #[inline]
    pub(super) fn resume(&self, watched: &Watched) {
        self.begin(watched.own);
    }

    #[inline]
    pub(crate) fn leave(&self, watched: Watched) {
        self.inside.store(watched.outer, Ordering::Relaxed);
    }

    /// In nothing, after a loss: the callbacks that the lost thread was in never end.
    pub(super) fn reset(&self) {
        self.inside.store(0, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_rounded_up_and_bounded() {
        for (asked_us, is_us) in [(0, 0), (1, 100), (100, 100), (30_000, 30_000)] {
            let limit = CallLimit::from(Duration::from_micros(asked_us));
            assert_eq!(limit.duration(), Duration::from_micros(is_us));
        }
        let longest = CallLimit::from(Duration::MAX).duration();
        assert!(longest > Duration::from_secs(7 * 3600));
    }

    #[test]
    fn a_callee_hides_its_caller_until_it_returns() {
        let watch = Watch::default();
        let limit = |ms| CallLimit::from(Duration::from_millis(ms));
        let seen = || {
            let inside = watch.inside();
            (inside.generation, inside.depth, inside.limit)
        };
        let outer = watch.enter(limit(3));
        assert_eq!(seen(), (1, 1, limit(3)));
        watch.pause(&outer);
        assert_eq!(seen(), (1, 1, CallLimit::NONE));
        let inner = watch.enter(limit(7));
        assert_eq!(seen(), (2, 2, limit(7)));
        watch.leave(inner);
        assert_eq!(seen(), (1, 1, CallLimit::NONE));
        watch.resume(&outer);
        assert_eq!(seen(), (1, 1, limit(3)));
        watch.leave(outer);
        assert_eq!(watch.inside().depth, 0);
        let next = watch.enter(limit(3));
        assert_eq!(seen(), (3, 1, limit(3)), "no generation comes twice");
        watch.leave(next);
    }

    #[test]
    fn somebody_who_waits_shortens_the_limit() {
        let watch = Watch::default();
        let limit = |ms| CallLimit::from(Duration::from_millis(ms));
        let inside = watch.enter(limit(30));
        for (hurry, expected) in [(50, 30), (20, 20), (0, 30)] {
            watch.hurry(limit(hurry));
            assert_eq!(watch.inside().limit, limit(expected), "{hurry} ms");
        }
        watch.leave(inside);
    }

    #[test]
    fn only_the_condemned_generation_is_broken_off() {
        let watch = Watch::default();
        watch.condemn(0);
        assert_eq!(watch.condemned(), None, "in nothing");
        let first = watch.enter(CallLimit::NONE);
        watch.condemn(1);
        assert_eq!(watch.refuse(20), 0);
        assert_eq!(watch.refuse(1), 20);
        let nested = watch.enter(CallLimit::NONE);
        assert_eq!(watch.condemned(), None, "its callee is not meant");
        watch.leave(nested);
        watch.condemn(1);
        assert_eq!(watch.condemned().map(|inside| inside.generation), Some(1));
        assert_eq!(watch.refuse(1), 21, "the same sentence again");
        watch.leave(first);
        let _second = watch.enter(CallLimit::NONE);
        assert_eq!(watch.condemned(), None);
        watch.condemn(3);
        assert_eq!(watch.refuse(1), 0, "a new sentence");
    }
}
