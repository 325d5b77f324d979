//! The fault manager's threads where time is real: one that looks after time, one that reads
//! backtraces, and a lane on which standbys are prepared, because that runs code of components.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use crossbeam::channel::Receiver;

use super::Supervisor;
use super::refill::Refills;
use crate::guard::loss::LostThread;
use crate::lane::{Crew, Lane, Work};
use crate::outer_supervision::Supervised;
use crate::scheduling;

/// The longest sleep of the thread that looks after time, so that it notices its end.
const LONGEST_SLEEP: Duration = Duration::from_millis(100);

/// How often those that wait for work look for it, and whether they are to end.
const LOOK_PERIOD: Duration = Duration::from_millis(100);

/// The threads, once started.
#[derive(Default)]
pub struct ManagerThreads {
    stopping: Arc<AtomicBool>,
    clock: Option<JoinHandle<()>>,
    backtraces: Option<JoinHandle<()>>,
    preparation: Option<Arc<Lane>>,
}

impl ManagerThreads {
    /// Starts all three. `above`: the highest priority of real-time executors, if there are any:
    /// the thread that looks after time goes before them, because what it holds they need in a
    /// recovery, and because their own work is what it watches. `all_are_real_time`: there are no
    /// other executors. A parent that supervises hears from the thread that looks after time.
    ///
    /// # Errors
    /// If the system refuses a thread.
    pub fn start(
        &mut self,
        supervisor: &Arc<Supervisor>,
        crew: &Arc<Crew>,
        wanted: Receiver<usize>,
        above: Option<u8>,
        all_are_real_time: bool,
        supervised: Option<Arc<Supervised>>,
    ) -> io::Result<()> {
        let (stopping, clocked) = (Arc::clone(&self.stopping), Arc::clone(supervisor));
        let thread = std::thread::Builder::new()
            .name("fault-manager".to_owned())
            .spawn(move || {
                if let Some(priority) = above {
                    scheduling::outrank(priority);
                }
                look_after_time(&clocked, supervised.as_deref(), &stopping);
            })?;
        self.clock = Some(thread);
        let (stopping, reader) = (Arc::clone(&self.stopping), Arc::clone(supervisor));
        let thread = std::thread::Builder::new()
            .name("backtraces".to_owned())
            .spawn(move || find_backtraces(&reader, &stopping))?;
        self.backtraces = Some(thread);
        let work = Preparation {
            supervisor: Arc::clone(supervisor),
            wanted,
            refills: Refills::default(),
            at: None,
        };
        let lane = Lane::new("standbys", Box::new(work));
        crew.start(&lane, move || scheduling::stay_behind(all_are_real_time))?;
        self.preparation = Some(lane);
        Ok(())
    }

    /// Ends them. A standby that hangs while it is prepared is left behind.
    pub fn stop(&mut self, supervisor: &Supervisor) {
        self.stopping.store(true, Ordering::Release);
        supervisor.rouse();
        for thread in [self.clock.take(), self.backtraces.take()]
            .into_iter()
            .flatten()
        {
            // It ends within one look; a panic in it has been printed.
            let _panicked = thread.join();
        }
        supervisor.record_backtraces();
        if let Some(lane) = self.preparation.take() {
            lane.stop();
            let _left_behind = lane.wait(2 * LOOK_PERIOD);
        }
    }
}

fn look_after_time(
    supervisor: &Supervisor,
    supervised: Option<&Supervised>,
    stopping: &AtomicBool,
) {
    while !stopping.load(Ordering::Acquire) {
        look(supervisor, supervised);
        supervisor.sleep_until_due(LONGEST_SLEEP);
    }
}

/// One look, which goes through all that the fault manager is made of: a parent hears of it only
/// while none of it stands still.
fn look(supervisor: &Supervisor, supervised: Option<&Supervised>) {
    supervisor.tick();
    if let Some(supervised) = supervised {
        // Behind the lock that a recovery holds.
        let _locked = supervisor.due_ns();
        supervised.beat();
    }
}

fn find_backtraces(supervisor: &Supervisor, stopping: &AtomicBool) {
    while !stopping.load(Ordering::Acquire) {
        if !supervisor.environment().scenes.look_at_one() {
            std::thread::sleep(LOOK_PERIOD);
        }
    }
    // Those that are left belong to verdicts on record.
    while supervisor.environment().scenes.look_at_one() {}
}

/// Prepares standbys in place of those that were used, behind everybody else.
struct Preparation {
    supervisor: Arc<Supervisor>,
    wanted: Receiver<usize>,
    refills: Refills,
    /// The component that it is at.
    at: Option<usize>,
}

impl Preparation {
    fn now(&self) -> Duration {
        self.supervisor.environment().clock.now()
    }

    fn ended(&mut self, component: usize, result: Result<(), String>) {
        let now = self.now();
        let succeeded = result.is_ok();
        if self.refills.attempted(component, succeeded, now)
            && let Err(reason) = result
        {
            self.supervisor.notice(&reason);
        }
    }
}

impl Work for Preparation {
    fn run(&mut self, lane: &Lane) {
        while !lane.is_stopping() {
            if let Ok(component) = self.wanted.recv_timeout(LOOK_PERIOD) {
                self.refills.want(component, self.now());
            }
            while let Some(component) = self.refills.next(self.now()) {
                self.at = Some(component);
                let result = self.supervisor.prepare_standbys(component, lane.loss());
                self.at = None;
                self.ended(component, result);
            }
        }
    }

    /// The standby that was being prepared is lost with the thread.
    fn after_loss(&mut self, _lost: &LostThread) {
        if let Some(component) = self.at.take() {
            let reason = "a standby's thread was lost in the C library while it was prepared";
            self.ended(component, Err(reason.to_owned()));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;
    use std::os::unix::net::UnixStream;

    use fault_manager::FaultManager;

    use super::*;
    use crate::adaptation::AdaptationRequests;
    use crate::clock::Clock;
    use crate::component::Environment;
    use crate::event_log::EventLog;
    use crate::injection::Injections;
    use crate::schedule::BusyTime;
    use crate::supervision::{Emergency, Monitors, Observations, Scenes};
    use crate::world::Worlds;

    fn supervisor() -> Supervisor {
        let (events, _writer) = EventLog::open(None, false, None).unwrap();
        let environment = Environment {
            clock: Clock::real(),
            events,
            observations: Observations::default(),
            scenes: Scenes::default(),
            injections: Injections::default(),
            worlds: Worlds::default(),
            score: None,
            adaptation_requests: AdaptationRequests::default(),
            busy: BusyTime::default(),
        };
        let (supervisor, _wanted) = Supervisor::new(
            Arc::new(environment),
            FaultManager::new(Vec::new()),
            Vec::new(),
            Vec::new(),
            Vec::new(),
            Emergency::new(Vec::new()),
            Monitors::default(),
        );
        supervisor
    }

    #[test]
    fn a_fault_manager_that_stands_still_is_not_heard() {
        let supervisor = supervisor();
        let (mut parent, container) = UnixStream::pair().unwrap();
        let supervised = Supervised::running_over(container);
        std::thread::scope(|scope| {
            // Somebody is in it and does not come out.
            let inside = supervisor.lock();
            let looking = scope.spawn(|| look(&supervisor, Some(&supervised)));
            parent
                .set_read_timeout(Some(Duration::from_millis(200)))
                .unwrap();
            assert!(parent.read(&mut [0]).is_err(), "a sign of life");
            drop(inside);
            looking.join().unwrap();
            assert_eq!(parent.read(&mut [0]).unwrap(), 1, "now it is heard");
        });
    }
}
