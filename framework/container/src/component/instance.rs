//! An instance of a component, wherever it runs: behind the guard in this process, or in a host.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::guard::loss::Loss;
use crate::guard::{self, CallLimit, Callback, Ending, Guarded, HostServices, Misbehaviour, Trap};
use crate::host::{Hosted, RemoteScene};
use crate::replay::Player;
use crate::wake::Wake;

/// An instance, by its isolation tier.
pub enum Instance {
    /// `guarded`: in the container's process.
    Guarded(Guarded),
    /// `process`: in a host.
    Hosted(Box<Hosted>),
    /// Nowhere: a recording is played.
    Played(Box<Player>),
}

/// What happened to an instance while nobody called it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stray {
    /// A thread of its own met this fault.
    Thread(Trap),
    /// The process that it ran in has ended.
    HostEnded,
}

/// Where an instance was when it was taken off.
#[derive(Debug)]
pub enum Scene {
    /// In this process.
    Guarded(guard::Scene),
    /// In a host.
    Hosted(RemoteScene),
}

impl Scene {
    /// The functions of the component that were being called, innermost first. For a thread that
    /// has time.
    pub fn backtrace(&self) -> Vec<String> {
        match self {
            Self::Guarded(scene) => scene.backtrace(),
            Self::Hosted(scene) => scene.backtrace(),
        }
    }
}

impl From<Guarded> for Instance {
    fn from(guarded: Guarded) -> Self {
        Self::Guarded(guarded)
    }
}

impl From<Hosted> for Instance {
    fn from(hosted: Hosted) -> Self {
        Self::Hosted(Box::new(hosted))
    }
}

impl From<Player> for Instance {
    fn from(player: Player) -> Self {
        Self::Played(Box::new(player))
    }
}

impl Instance {
    /// Whether it can still be called.
    #[inline]
    pub fn is_alive(&self) -> bool {
        match self {
            Self::Guarded(guarded) => guarded.is_alive(),
            Self::Hosted(hosted) => hosted.is_alive(),
            Self::Played(_) => true,
        }
    }

    /// Whether it runs in the container's own process.
    pub fn is_guarded(&self) -> bool {
        matches!(self, Self::Guarded(_))
    }

    /// Whose thread calls it from now on: it is woken by what ends the instance while nobody does.
    pub fn run_by(&self, executor: &Arc<Wake>) {
        if let Self::Hosted(hosted) = self {
            hosted.run_by(executor);
        }
    }

    /// Whether it can be called, and what it runs in has not died.
    pub fn is_fit(&self) -> bool {
        match self {
            Self::Guarded(guarded) => guarded.is_alive(),
            Self::Hosted(hosted) => hosted.is_alive() && !hosted.has_lost_host(),
            Self::Played(_) => true,
        }
    }

    /// Runs a callback to its end: see [`Guarded::call`].
    #[inline]
    pub fn call<Services: HostServices>(
        &mut self,
        callback: Callback,
        limit: CallLimit,
        loss: &Loss,
        services: &mut Services,
    ) -> Ending {
        match self {
            Self::Guarded(guarded) => guarded.call(callback, limit, loss, services),
            Self::Hosted(hosted) => hosted.call(callback, limit, loss, services),
            Self::Played(player) => player.call(callback, services),
        }
    }

    /// What happened while nobody called it, once; it cannot be called any more then.
    #[inline]
    pub fn take_stray_fault(&mut self) -> Option<Stray> {
        match self {
            Self::Guarded(guarded) => guarded.take_stray_fault().map(Stray::Thread),
            Self::Hosted(hosted) if hosted.has_lost_host() => {
                hosted.quarantine();
                Some(Stray::HostEnded)
            }
            Self::Hosted(hosted) => hosted.take_stray_fault().map(Stray::Thread),
            Self::Played(_) => None,
        }
    }

    /// Sees to it that its first callbacks need not wait for memory. (A host has its own.)
    pub fn touch_memory(&self) {
        if let Self::Guarded(guarded) = self {
            guarded.touch_memory();
        }
    }

    /// Never call it again.
    pub fn quarantine(&mut self) {
        match self {
            Self::Guarded(guarded) => guarded.quarantine(),
            Self::Hosted(hosted) => hosted.quarantine(),
            Self::Played(_) => {}
        }
    }

    /// Lets it misbehave when its next callback is due; `None` takes that back.
    pub fn inject(&mut self, misbehaviour: Option<Misbehaviour>) {
        match self {
            Self::Guarded(guarded) => guarded.inject(misbehaviour),
            Self::Hosted(hosted) => hosted.inject(misbehaviour),
            Self::Played(_) => {}
        }
    }

    /// When it misbehaved last as it was made to, just before that.
    pub fn misbehaved(&self) -> Option<Instant> {
        match self {
            Self::Guarded(guarded) => guarded.misbehaved(),
            Self::Hosted(hosted) => hosted.misbehaved(),
            Self::Played(_) => None,
        }
    }

    /// From now on what callbacks allocate and do not free is counted. (A host was told when the
    /// instance was made.)
    pub fn count_allocations(&mut self) {
        if let Self::Guarded(guarded) = self {
            guarded.count_allocations();
        }
    }

    /// Bytes that callbacks have allocated and not freed.
    #[inline]
    pub fn allocated_bytes(&self) -> u64 {
        match self {
            Self::Guarded(guarded) => guarded.allocated_bytes(),
            Self::Hosted(hosted) => hosted.allocated_bytes(),
            Self::Played(_) => 0,
        }
    }

    /// What was allocated so far does not count any more.
    pub fn forget_allocations(&mut self) {
        match self {
            Self::Guarded(guarded) => guarded.forget_allocations(),
            Self::Hosted(hosted) => hosted.forget_allocations(),
            Self::Played(_) => {}
        }
    }

    /// Where it was when it ended; once, of an instance in a host.
    pub fn scene(&mut self, trap: Option<&Trap>) -> Option<Scene> {
        match self {
            Self::Guarded(guarded) => guarded.scene(trap?).map(Scene::Guarded),
            Self::Hosted(hosted) => hosted.scene().map(Scene::Hosted),
            Self::Played(_) => None,
        }
    }

    /// How its host ended, in words; waits for that at most `limit`.
    pub fn end_of_host(&self, limit: Duration) -> Option<String> {
        match self {
            Self::Guarded(_) | Self::Played(_) => None,
            Self::Hosted(hosted) => hosted.end_of_host(limit),
        }
    }
}
