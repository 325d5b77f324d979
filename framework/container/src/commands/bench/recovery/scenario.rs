//! What is measured: each kind of fault with each way of handling it.

use serde::{Deserialize, Serialize};

/// Where the component runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Tier {
    /// In the container, behind the guard.
    Guarded,
    /// In a host process of its own.
    Process,
}

/// What goes wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Fault {
    /// A null pointer.
    Trap,
    /// A panic.
    Panic,
    /// A callback that does not return; counted from its deadline.
    Hang,
    /// A callback that returns a failure.
    ErrorReturn,
    /// A datum out of its range; counted from when it is written.
    OutOfRange,
    /// Its host process is killed by another one while a callback runs; counted from just before.
    HostKilled,
}

/// What is done about it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Handling {
    /// Reset, without its memory.
    Reset,
    /// Reset, with 4 KiB restored from the checkpoint.
    ResetCheckpoint,
    /// As before, by a warm standby of the component itself.
    StandbyWarm,
    /// A secondary takes its place, of which nothing was prepared; with the checkpoint.
    SecondaryCold,
    /// The same, its library loaded and the instance created.
    SecondaryLoaded,
    /// The same, initialised.
    SecondaryWarm,
    /// Emergency stop, until the actuator has worked on its safe command.
    EmergencyStop,
}

impl Tier {
    /// The word of the rules and of the report.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Guarded => "guarded",
            Self::Process => "process",
        }
    }
}

impl Fault {
    /// All of them, in the order of the report.
    const ALL: [Self; 6] = [
        Self::Trap,
        Self::Panic,
        Self::Hang,
        Self::ErrorReturn,
        Self::OutOfRange,
        Self::HostKilled,
    ];

    /// The word of the report.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Trap => "trap",
            Self::Panic => "panic",
            Self::Hang => "hang",
            Self::ErrorReturn => "error_return",
            Self::OutOfRange => "out_of_range",
            Self::HostKilled => "host_killed",
        }
    }

    /// Whether the instance can still be called: then a reset is done in place, and no standby of
    /// its own is asked for.
    fn leaves_instance(self) -> bool {
        matches!(self, Self::ErrorReturn | Self::OutOfRange)
    }
}

impl Handling {
    /// All that bring the component back.
    const RECOVERIES: [Self; 6] = [
        Self::Reset,
        Self::ResetCheckpoint,
        Self::StandbyWarm,
        Self::SecondaryCold,
        Self::SecondaryLoaded,
        Self::SecondaryWarm,
    ];

    /// The word of the report.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Reset => "reset",
            Self::ResetCheckpoint => "reset_checkpoint",
            Self::StandbyWarm => "standby_warm",
            Self::SecondaryCold => "secondary_cold",
            Self::SecondaryLoaded => "secondary_loaded",
            Self::SecondaryWarm => "secondary_warm",
            Self::EmergencyStop => "emergency_stop",
        }
    }

    /// Grade of the secondaries, where these handle the fault.
    pub(super) fn secondary_preload(self) -> Option<&'static str> {
        match self {
            Self::SecondaryCold => Some("cold"),
            Self::SecondaryLoaded => Some("loaded"),
            Self::SecondaryWarm => Some("warm"),
            _ => None,
        }
    }
}

/// Rows that are measured in one application, side by side: they have the fault in common, which
/// hits one component at a time.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Group {
    /// Where the components run.
    pub(super) tier: Tier,
    /// What happens to them.
    pub(super) fault: Fault,
    /// One row each.
    pub(super) handlings: Vec<Handling>,
}

impl Group {
    /// Cycles, which are milliseconds, from a fault that is handled so to the next one, of another
    /// component. Handling takes a tenth of one; what is left is other work that disturbs the caches,
    /// and time for another standby, which is prepared by whoever has no other work: of an instance
    /// behind the guard that takes about one, of a host several, and more beside a load. An emergency
    /// stop is looked at before it is cleared, and a reset for bad data ends in the next cycle.
    pub(super) fn cycles(&self, handling: Handling, load_percent: u8) -> u64 {
        let has_secondaries = handling.secondary_preload().is_some();
        let uses_standby = !has_secondaries && !self.fault.leaves_instance();
        let kills_host = self.fault == Fault::HostKilled;
        match (self.tier, handling) {
            (_, Handling::EmergencyStop) => 3,
            (Tier::Process, _) if uses_standby && kills_host && load_percent > 60 => 20,
            (Tier::Process, Handling::SecondaryCold) => 10,
            (Tier::Process, _) if uses_standby => 10,
            (Tier::Guarded, Handling::SecondaryCold) => 3,
            (Tier::Guarded, _) if uses_standby => match load_percent {
                0..=40 => 2,
                41..=60 => 3,
                _ => 4,
            },
            _ if self.fault == Fault::OutOfRange => 2,
            (Tier::Process, _) => 2,
            (Tier::Guarded, _) => 1,
        }
    }
}

/// The rows; `all` of them, or without those that differ from another one in nothing but detection:
/// what it takes to recover depends on how far who takes over was prepared, on whether there is a
/// checkpoint, and, of prepared ones, on whether the old one is dead (trap) or has to be given up
/// (error return). A host is started for each fault that ends one, which takes many times what is measured; so of these rows
/// there is one for each fault, and more only of hosts that are killed.
///
/// An emergency stop stops everything, so it has an application of its own; how it comes about does
/// not matter to it, nor does the tier, so it is measured for a component that dies; of all rows there
/// is one for bad data, too.
pub(super) fn groups(all: bool) -> Vec<Group> {
    let stop = |fault| Group {
        tier: Tier::Guarded,
        fault,
        handlings: vec![Handling::EmergencyStop],
    };
    let of_tier = |tier| {
        let faults = Fault::ALL.into_iter();
        let possible = faults.filter(move |it| tier == Tier::Process || *it != Fault::HostKilled);
        possible.map(move |fault| recoveries(tier, fault, all))
    };
    let mut groups: Vec<Group> = of_tier(Tier::Guarded).collect();
    let bad_data = all.then_some(Fault::OutOfRange);
    groups.extend([Fault::Trap].into_iter().chain(bad_data).map(stop));
    groups.extend(of_tier(Tier::Process));
    groups
}

fn recoveries(tier: Tier, fault: Fault, all: bool) -> Group {
    let is_possible = |it: &Handling| *it != Handling::StandbyWarm || !fault.leaves_instance();
    let is_wanted = |it: &Handling| all || is_telling(tier, fault, *it);
    let handlings = Handling::RECOVERIES.into_iter().filter(is_possible);
    Group {
        tier,
        fault,
        handlings: handlings.filter(is_wanted).collect(),
    }
}

/// Whether a row differs from others in more than detection.
fn is_telling(tier: Tier, fault: Fault, handling: Handling) -> bool {
    use Handling::{Reset, ResetCheckpoint, SecondaryLoaded, SecondaryWarm, StandbyWarm};
    match (tier, fault) {
        (Tier::Guarded, Fault::Trap) => true,
        (Tier::Guarded, Fault::ErrorReturn) => matches!(handling, ResetCheckpoint | SecondaryWarm),
        (Tier::Guarded, Fault::OutOfRange) => matches!(handling, ResetCheckpoint | SecondaryWarm),
        (Tier::Guarded, _) => handling == StandbyWarm,
        // A reset has a second copy that is loaded, as this secondary is.
        (Tier::Process, Fault::HostKilled) => handling != SecondaryLoaded && handling != Reset,
        (Tier::Process, Fault::Trap | Fault::Panic | Fault::Hang) => handling == StandbyWarm,
        (Tier::Process, _) => handling == ResetCheckpoint,
    }
}
