//! One reader for each kind of profile: element in, typed profile out, problems in the log.

mod application;
pub(crate) mod behavior_tree;
mod component;
mod data_type;
mod execution;
mod header;
pub(crate) mod injection;
mod mission;
mod network;
mod ports;
mod process_model;
mod project;
pub(crate) mod rules;
mod service_type;
mod system;
mod task;
mod world;

use system_model::profile::Profile;

use crate::document::Document;

pub use process_model::{ProcessModelOutcome, load_process_model};
pub use task::{TaskOutcome, load_task};
pub use world::{WorldOutcome, load_world};

/// The roots that [`read_profile`] understands.
pub const PROFILE_ROOTS: [&str; 14] = [
    "component_profile",
    "package_profile",
    "application_profile",
    "composite_component_profile",
    "service_port_type_profile",
    "data_type",
    "system_config",
    "system_profile",
    "OPRoSProject",
    world::WORLD_ROOT,
    process_model::MODEL_ROOT,
    task::TASK_ROOT,
    rules::RULES_ROOT,
    injection::INJECTIONS_ROOT,
];

/// Rules of a component that may stand inline in its profile or where an application uses it. They
/// are read together with the rule files, not here; so are those below.
pub(crate) const COMPONENT_RULES: [&str; 21] = [
    "actuator",
    "adapt",
    "confirm",
    "dependency",
    "estimator",
    "evaluator",
    "exception",
    "fault",
    "fault_event",
    "handle",
    "heartbeat",
    "isolation",
    "memory",
    "overrun",
    "process_model",
    "recovery",
    "resurrect",
    "severity",
    "standby",
    "voting",
    "watchdog",
];

/// As [`COMPONENT_RULES`], of a port.
pub(crate) const PORT_RULES: [&str; 5] = [
    "freshness",
    "rate_of_change",
    "stuck",
    "validation",
    "validity",
];

/// As [`COMPONENT_RULES`], of an application.
pub(crate) const APPLICATION_RULES: [&str; 3] = ["dependency", "fault", "heartbeat"];

/// Makes a document typed. A profile with errors is still returned, as far as it could be
/// understood; ask [`Document::has_errors`] before it is used. A world is looked through for its
/// problems, but it is no profile; [`load_world`] returns it. So is a reference model
/// ([`load_process_model`]), a task ([`load_task`]), and a rule file, whose rules mean something only together with their
/// application; [`load_rules`](crate::load_rules) returns them, and
/// [`load_injections`](crate::load_injections) those of an injection file.
pub fn read_profile(document: &Document) -> Option<Profile> {
    let root = document.root(&PROFILE_ROOTS)?;
    if root.name() == world::WORLD_ROOT {
        let _looked_through = world::read(&root);
        root.finish();
        return None;
    }
    if root.name() == process_model::MODEL_ROOT {
        let _looked_through = process_model::read(&root);
        root.finish();
        return None;
    }
    if root.name() == task::TASK_ROOT {
        let _looked_through = task::read(&root);
        root.finish();
        return None;
    }
    if root.name() == rules::RULES_ROOT {
        let _looked_through = rules::read(&root);
        return None;
    }
    if root.name() == injection::INJECTIONS_ROOT {
        let _looked_through = injection::read(&root);
        return None;
    }
    let profile = match root.name() {
        "component_profile" => Profile::Component(Box::new(component::read(&root))),
        "composite_component_profile" => Profile::Composite(application::read_composite(&root)),
        "service_port_type_profile" => Profile::ServiceTypes(service_type::read(&root)),
        "data_type" => Profile::DataTypes(data_type::read(&root)),
        "system_config" | "system_profile" => Profile::System(system::read(&root)),
        "OPRoSProject" => Profile::Project(project::read(&root)),
        _ => Profile::Application(application::read(&root)),
    };
    root.finish();
    Some(profile)
}
