//! Behaviour trees that belong to an application: when they are ticked, and what it entails if one of
//! them fails.

use std::time::Duration;

use crate::rules::ComponentSeverity;
use crate::specification::Place;

/// Ten ticks a second are what behaviour trees of robots are commonly ticked with.
pub const DEFAULT_TICK: Duration = Duration::from_millis(100);

/// A tick of a tree of a thousand nodes takes microseconds; what takes longer than this has hung.
pub const DEFAULT_TICK_DEADLINE: Duration = Duration::from_millis(20);

/// A mission that failed is begun anew so often within a minute, where the integrator wants that.
pub const DEFAULT_TREE_RETRIES: u32 = 1;

/// The container looks at trees as often as at its monitors; a shorter tick could not be kept.
pub const SHORTEST_TICK: Duration = Duration::from_millis(1);

/// A tree as an application declares it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeclaredTree {
    /// By what rules, records and operators mean it; no component has this name.
    pub name: String,
    /// When it begins.
    pub starts: TreeStart,
    /// From one tick to the next.
    pub tick: Duration,
    /// How long one tick may take.
    pub tick_deadline: Duration,
    /// What it entails that the tree fails: `reset` begins it anew, `stop` halts it for good.
    pub severity: ComponentSeverity,
    /// How often it is begun anew within a minute, before the emergency stop.
    pub retry_max: u32,
    /// Where it is declared.
    pub place: Place,
}

/// When a tree begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum TreeStart {
    /// When all components have been started.
    #[default]
    WithApplication,
    /// When a fault rule asks for it, by `<handle tree="..."/>`.
    ByFault,
}

impl TreeStart {
    /// Both, as files write them.
    pub const ALL: [(&'static str, Self); 2] = [
        ("with_application", Self::WithApplication),
        ("by_fault", Self::ByFault),
    ];
}
