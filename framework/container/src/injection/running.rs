//! The injections of a running system, reachable from every thread. Without any, each question costs
//! the look at a flag.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use robot_simulation::{Fault as RobotFault, Side};
use system_model::data_type::DataType;
use system_model::injection::{
    CallbackName, ContainerFailure, InjectedFault, Injection, Misbehaviour, RobotSide, WorldFault,
};

use super::{Change, DistortionError, Passage, PortDistortion, Schedule, TooManyInjections};
use crate::guard;
use crate::port::Datum;
use crate::world::Worlds;

/// All injections, where each of them stands, and what they have done to the world.
#[derive(Debug, Default)]
pub struct Injections {
    armed: AtomicBool,
    inner: OnceLock<Mutex<Inner>>,
    /// Names of the components.
    names: OnceLock<Box<[String]>>,
    seed: AtomicU64,
}

#[derive(Debug)]
struct Inner {
    schedule: Schedule,
    ports: Vec<PortInjection>,
}

#[derive(Debug)]
struct PortInjection {
    number: usize,
    component: usize,
    port: usize,
    distortion: PortDistortion,
}

/// An injection that has begun or ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Changed {
    /// Its KIND.
    pub fault: &'static str,
    /// The component that it is about; none for a fault of the world.
    pub component: Option<String>,
    /// Whether it has begun; else it has ended.
    pub begins: bool,
}

impl Injections {
    /// For an application of components with these names, with the seed of the run.
    pub fn prepare(&self, names: impl IntoIterator<Item = String>, seed: u64) {
        self.seed.store(seed, Ordering::Relaxed);
        // Once a run; a second time changes nothing.
        let _prepared = self.names.set(names.into_iter().collect());
    }

    /// Whether there are any.
    #[inline]
    pub fn is_armed(&self) -> bool {
        self.armed.load(Ordering::Relaxed)
    }

    /// Adds one whose times count from `now`, and returns its number. A distortion of a port needs
    /// the port's number and type.
    ///
    /// # Errors
    /// If there are too many, or a distortion does not fit its port; then nothing is added.
    pub fn add(
        &self,
        injection: Injection,
        now: Duration,
        port: Option<(usize, &DataType)>,
    ) -> Result<usize, InjectionError> {
        let mut inner = self.inner().lock().unwrap_or_else(PoisonError::into_inner);
        let number = inner.schedule.len();
        let of_port = match (&injection.what, port) {
            (
                InjectedFault::Port {
                    component,
                    field,
                    distortion,
                    ..
                },
                Some((port, data_type)),
            ) => {
                let (seed, field) = (self.seed.load(Ordering::Relaxed), field.as_deref());
                Some(PortInjection {
                    number,
                    component: *component,
                    port,
                    distortion: PortDistortion::new(data_type, field, *distortion, seed, number)?,
                })
            }
            _ => None,
        };
        inner.schedule.add(injection, now)?;
        inner.ports.extend(of_port);
        drop(inner);
        self.armed.store(true, Ordering::Release);
        Ok(number)
    }

    /// It is `now`: what begins and what ends. Faults of the world are put into it and taken away.
    pub fn advance(&self, now: Duration, worlds: &Worlds) -> Vec<Changed> {
        self.go_on(now, None, worlds)
    }

    /// A component is about to begin its n-th `onExecute`, counted from 1 over all incarnations;
    /// one that did not complete does not count.
    pub fn begin_execution(
        &self,
        component: usize,
        cycle: u64,
        now: Duration,
        worlds: &Worlds,
    ) -> Vec<Changed> {
        self.go_on(now, Some((component, cycle)), worlds)
    }

    /// What a component does in this call of a callback: what ends it, or else what lasts.
    pub fn misbehaviour(
        &self,
        component: usize,
        callback: CallbackName,
    ) -> Option<guard::Misbehaviour> {
        let mut found: Option<Misbehaviour> = None;
        self.lock()?
            .schedule
            .misbehave(component, callback, |_, misbehaviour| {
                let lasts =
                    |it: Misbehaviour| matches!(it, Misbehaviour::Slow(_) | Misbehaviour::Leak(_));
                if found.is_none_or(lasts) {
                    found = Some(misbehaviour);
                }
            });
        found.map(in_callback)
    }

    /// Distorts a datum on its way through a port.
    pub fn distort(
        &self,
        component: usize,
        port: usize,
        datum: &mut Datum,
        now: Duration,
    ) -> Passage {
        let Some(mut inner) = self.lock() else {
            return Passage::Deliver;
        };
        let Inner { schedule, ports } = &mut *inner;
        let of_port = ports
            .iter_mut()
            .filter(|one| (one.component, one.port) == (component, port));
        let mut passage = Passage::Deliver;
        for one in of_port {
            if passage != Passage::Withhold && schedule.strikes(one.number) {
                passage = one.distortion.apply(datum, now);
            }
        }
        passage
    }

    /// The next delayed datum of a port whose time has come.
    pub fn due(&self, component: usize, port: usize, now: Duration) -> Option<Datum> {
        let mut inner = self.lock()?;
        let mut of_port = inner
            .ports
            .iter_mut()
            .filter(|one| (one.component, one.port) == (component, port));
        of_port.find_map(|one| one.distortion.due(now))
    }

    /// Whether something of the container's own handling of a component is to fail this time.
    pub fn fails(&self, component: usize, failure: ContainerFailure) -> bool {
        self.is_armed()
            && self
                .lock()
                .is_some_and(|mut inner| inner.schedule.fails(component, failure).is_some())
    }

    fn go_on(&self, now: Duration, cycle: Option<(usize, u64)>, worlds: &Worlds) -> Vec<Changed> {
        let Some(mut inner) = self.lock() else {
            return Vec::new();
        };
        let mut changes = Vec::new();
        inner
            .schedule
            .advance(now, cycle, |number, change| changes.push((number, change)));
        let Inner { schedule, ports } = &mut *inner;
        let mut changed = Vec::new();
        for (number, change) in changes {
            let Some(injection) = schedule.injection(number) else {
                continue;
            };
            let begins = change == Change::Begins;
            if let InjectedFault::World { component, fault } = injection.what {
                set(worlds, component, fault, begins);
            }
            for one in ports.iter_mut().filter(|one| one.number == number) {
                one.distortion.restart();
            }
            changed.push(Changed {
                fault: injection.what.name(),
                component: injection.what.component().map(|index| {
                    let name = self.names.get().and_then(|names| names.get(index));
                    name.cloned().unwrap_or_default()
                }),
                begins,
            });
        }
        changed
    }

    fn inner(&self) -> &Mutex<Inner> {
        self.inner.get_or_init(|| {
            let seed = self.seed.load(Ordering::Relaxed);
            Mutex::new(Inner {
                schedule: Schedule::empty(seed),
                ports: Vec::new(),
            })
        })
    }

    fn lock(&self) -> Option<MutexGuard<'_, Inner>> {
        let inner = self.inner.get()?;
        Some(inner.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Why an injection cannot be added.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum InjectionError {
    /// There are too many.
    #[error(transparent)]
    TooMany(#[from] TooManyInjections),
    /// It does not fit its port.
    #[error(transparent)]
    Distortion(#[from] DistortionError),
}

fn set(worlds: &Worlds, component: Option<usize>, fault: WorldFault, present: bool) {
    let world = match component {
        Some(component) => worlds.of_component(component),
        None => worlds.first(),
    };
    let Some(world) = world else { return };
    let side = |side| match side {
        RobotSide::Left => Side::Left,
        RobotSide::Right => Side::Right,
    };
    let fault = match fault {
        WorldFault::UnplugSonar(index) => RobotFault::UnplugSonar(index),
        WorldFault::MotorDriverOff(of) => RobotFault::MotorDriverOff(side(of)),
        WorldFault::EncoderDead(of) => RobotFault::EncoderDead(side(of)),
        WorldFault::CameraSmoke(density) => RobotFault::CameraSmoke(density),
    };
    world.set_fault(fault, present);
}

/// The guard's word for it.
fn in_callback(misbehaviour: Misbehaviour) -> guard::Misbehaviour {
    use guard::Misbehaviour as Guard;
    match misbehaviour {
        Misbehaviour::Panic => Guard::Panic,
        Misbehaviour::Segfault => Guard::Segfault,
        Misbehaviour::BusError => Guard::BusError,
        Misbehaviour::DivideByZero => Guard::DivideByZero,
        Misbehaviour::IllegalInstruction => Guard::IllegalInstruction,
        Misbehaviour::Abort => Guard::Abort,
        Misbehaviour::StackOverflow => Guard::StackOverflow,
        Misbehaviour::Exit(_) => Guard::Exit,
        Misbehaviour::Hang => Guard::Hang,
        Misbehaviour::Slow(time) => Guard::Slow(time),
        Misbehaviour::Leak(bytes) => Guard::Leak(usize::try_from(bytes).unwrap_or(usize::MAX)),
        Misbehaviour::ErrorReturn(status) => Guard::ErrorReturn(status),
    }
}
