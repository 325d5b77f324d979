//! An application that is assembled in the test's own process, without a fault manager: for what
//! only the container's library can show.

use std::path::Path;
use std::sync::Arc;

use container::adaptation::AdaptationRequests;
use container::assembly::{Assembly, LibraryOptions, assemble};
use container::clock::Clock;
use container::component::Environment;
use container::event_log::{EventLog, EventWriter};
use container::injection::Injections;
use container::library::LibrarySearch;
use container::schedule::BusyTime;
use container::supervision::{Observations, Scenes};
use container::world::Worlds;
use system_model::rules::FaultRules;
use system_profile::{LoadOptions, load_application};

/// What components share in simulated time, without a world and without an event file.
///
/// # Panics
/// If the system refuses the thread that writes events.
pub fn environment() -> (Arc<Environment>, EventWriter) {
    let (events, writer) = EventLog::open(None, true, None).expect("an event log");
    let environment = Environment {
        clock: Clock::simulated(),
        events,
        observations: Observations::default(),
        scenes: Scenes::default(),
        injections: Injections::default(),
        worlds: Worlds::default(),
        score: None,
        adaptation_requests: AdaptationRequests::default(),
        busy: BusyTime::default(),
    };
    (Arc::new(environment), writer)
}

/// An application with its libraries from this folder, and the rules that are in its profiles.
///
/// # Panics
/// If it is not sound.
pub fn assembled(application: &Path, libraries: &Path, environment: &Arc<Environment>) -> Assembly {
    let loaded = load_application(application, &LoadOptions::default());
    let specification = loaded.specification.expect("a sound application");
    let options = LibraryOptions {
        search: LibrarySearch::new(vec![libraries.to_owned()]),
        executable: None,
    };
    let rules = FaultRules::default();
    assemble(&specification, &rules, &options, environment)
        .unwrap_or_else(|problems| panic!("{problems:?}"))
}
