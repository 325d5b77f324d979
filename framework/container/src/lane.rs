//! Lanes: threads that run components, and what happens when one is lost inside a component.
//!
//! All that a lane is doing lies in memory of its own, not on the thread's stack. When the trap
//! handler has to stop a thread for ever, a spare thread takes the lane over and goes on with the
//! next step.
#![allow(unsafe_code)] // the hand-over of a lane's work between threads

use std::cell::{RefCell, UnsafeCell};
use std::io;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, OnceLock, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use crate::guard::Guarded;
use crate::guard::loss::{Loss, LostThread, losses, wait_for_loss, wake_spare};
use crate::scheduling::{be_ordinary, outrank_components};
use crate::watchdog;

/// The token under which components are entered while they are assembled, before any lane runs.
pub const SETUP_TOKEN: u32 = 1;

/// What a lane does.
pub trait Work: Send {
    /// Works until it is done or [`Lane::is_stopping`]. May be called again after a loss, and then
    /// goes on with the step after the one that was lost.
    fn run(&mut self, lane: &Lane);

    /// The thread was lost inside these components.
    fn after_loss(&mut self, lost: &LostThread);

    /// Makes `run` look at [`Lane::is_stopping`] soon.
    fn waker(&self) -> Option<Arc<crate::wake::Wake>> {
        None
    }
}

/// One lane.
pub struct Lane {
    name: String,
    token: u32,
    loss: Loss,
    stopping: AtomicBool,
    waker: Option<Arc<crate::wake::Wake>>,
    work: UnsafeCell<Box<dyn Work>>,
    /// What a thread does first that works for it.
    prepare: OnceLock<Box<dyn Fn() + Send + Sync>>,
    done: Mutex<bool>,
    done_changed: Condvar,
}

// SAFETY: `work` is touched only by the lane's one thread: the one that `Crew::start` made, or,
// after that was lost for ever, the one that took over.
unsafe impl Sync for Lane {}

thread_local! {
    static CURRENT: RefCell<Option<Arc<Lane>>> = const { RefCell::new(None) };
}

/// The lane that the calling thread works for.
pub fn current() -> Option<Arc<Lane>> {
    CURRENT.with_borrow(Clone::clone)
}

impl Lane {
    /// A lane that has not begun.
    pub fn new(name: impl Into<String>, work: Box<dyn Work>) -> Arc<Self> {
        static NEXT_TOKEN: AtomicU32 = AtomicU32::new(SETUP_TOKEN + 1);
        Arc::new(Self {
            name: name.into(),
            token: NEXT_TOKEN.fetch_add(1, Ordering::Relaxed),
            loss: Loss::default(),
            stopping: AtomicBool::new(false),
            waker: work.waker(),
            work: UnsafeCell::new(work),
            prepare: OnceLock::new(),
            done: Mutex::new(false),
            done_changed: Condvar::new(),
        })
    }

    /// Its name, for people.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Names this lane when it enters components; the same before and after a loss.
    pub fn token(&self) -> u32 {
        self.token
    }

    /// Where its thread leaves word when it is lost.
    pub fn loss(&self) -> &Loss {
        &self.loss
    }

    /// Asks it to end.
    pub fn stop(&self) {
        self.stopping.store(true, Ordering::Release);
        if let Some(waker) = &self.waker {
            waker.wake();
        }
    }

    /// Whether it was asked to end.
    pub fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::Acquire)
    }

    /// Waits until it has ended, at most `limit`; whether it has.
    pub fn wait(&self, limit: Duration) -> bool {
        let done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        let result = self
            .done_changed
            .wait_timeout_while(done, limit, |done| !*done);
        match result {
            Ok((done, _timeout)) => *done,
            Err(poisoned) => *poisoned.into_inner().0,
        }
    }

    /// Whether it has ended.
    fn is_done(&self) -> bool {
        *self.done.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Works on the calling thread.
    fn drive(self: &Arc<Self>, lost: Option<&LostThread>) {
        if let Some(prepare) = self.prepare.get() {
            prepare();
        }
        self.loss.watch().attach();
        CURRENT.set(Some(Arc::clone(self)));
        // SAFETY: this thread is the lane's only one; see the `Sync` argument.
        let work = unsafe { &mut *self.work.get() };
        if let Some(lost) = lost {
            work.after_loss(lost);
        }
        work.run(self);
        self.loss.watch().detach();
        CURRENT.set(None);
        *self.done.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.done_changed.notify_all();
    }
}

/// The lanes of an application, the spare thread that stands by for them, and the watchdog.
#[derive(Default)]
pub struct Crew {
    /// Those that have not ended.
    lanes: Mutex<Vec<Arc<Lane>>>,
    started: AtomicUsize,
    dismissed: AtomicBool,
}

/// How often the spare looks for losses if no word reached it.
const SPARE_PERIOD: Duration = Duration::from_millis(500);

impl Crew {
    /// A crew with its spare thread standing by, watched over.
    ///
    /// # Errors
    /// If the system refuses a thread.
    pub fn new() -> io::Result<Arc<Self>> {
        let crew = Arc::new(Self::default());
        crew.spawn_spare()?;
        let watched = Arc::clone(&crew);
        std::thread::Builder::new()
            .name("watchdog".to_owned())
            .spawn(move || watchdog::watch_over(&watched))?;
        Ok(crew)
    }

    /// Starts a lane on a thread of its own. `prepare` runs first on that thread, and on every one
    /// that takes over from it (priorities).
    ///
    /// # Errors
    /// If the system refuses the thread.
    pub fn start(
        self: &Arc<Self>,
        lane: &Arc<Lane>,
        prepare: impl Fn() + Send + Sync + 'static,
    ) -> io::Result<()> {
        // A lane is started once.
        let _prepared_before = lane.prepare.set(Box::new(prepare));
        let mut lanes = self.lanes();
        lanes.retain(|lane| !lane.is_done());
        lanes.push(Arc::clone(lane));
        drop(lanes);
        self.started.fetch_add(1, Ordering::Release);
        let lane = Arc::clone(lane);
        std::thread::Builder::new()
            .name(lane.name.clone())
            .spawn(move || match Guarded::prepare_thread() {
                Ok(()) => lane.drive(None),
                Err(_refused) => lane.stop(),
            })?;
        Ok(())
    }

    /// Sends the spare home; lanes that are lost from now on stay lost.
    pub fn dismiss(&self) {
        self.dismissed.store(true, Ordering::Release);
        wake_spare();
    }

    /// Whether the crew was sent home.
    pub(crate) fn is_dismissed(&self) -> bool {
        self.dismissed.load(Ordering::Acquire)
    }

    /// How many lanes have been started.
    pub(crate) fn lanes_started(&self) -> usize {
        self.started.load(Ordering::Acquire)
    }

    /// Shows the lanes that have not ended, and says how many had been started at least; `None` if
    /// somebody else looks at them now.
    pub(crate) fn with_lanes(&self, look: impl FnOnce(&[Arc<Lane>])) -> Option<usize> {
        let started = self.lanes_started();
        let lanes = match self.lanes.try_lock() {
            Ok(lanes) => lanes,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return None,
        };
        look(&lanes);
        Some(started)
    }

    fn lanes(&self) -> std::sync::MutexGuard<'_, Vec<Arc<Lane>>> {
        self.lanes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn spawn_spare(self: &Arc<Self>) -> io::Result<()> {
        let crew = Arc::clone(self);
        std::thread::Builder::new()
            .name("spare".to_owned())
            .spawn(move || {
                if Guarded::prepare_thread().is_ok() {
                    // A lane that is lost may be of any priority; whoever takes it over has its
                    // own from then on.
                    outrank_components();
                    crew.stand_by();
                }
            })?;
        Ok(())
    }

    /// Waits for a loss, takes that lane over; another spare takes this one's place.
    fn stand_by(self: &Arc<Self>) {
        while !self.is_dismissed() {
            let seen = losses();
            let lost = self
                .lanes()
                .iter()
                .find_map(|lane| lane.loss.take().map(|lost| (Arc::clone(lane), lost)));
            if let Some((lane, lost)) = lost {
                // Without another spare the next loss ends its lane; this one still goes on.
                let _no_more_spares = self.spawn_spare();
                // If that were refused, the lane would only run too soon.
                let _keeps_its_rank = be_ordinary();
                lane.drive(Some(&lost));
                return;
            }
            wait_for_loss(seen, SPARE_PERIOD);
        }
    }
}

/// Time that is left until `deadline`.
pub fn remaining(deadline: Instant) -> Duration {
    deadline.saturating_duration_since(Instant::now())
}
