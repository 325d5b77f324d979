//! `task_profile`: a task of one or more robots, for self-adaptation.
//!
//! ```xml
//! <task_profile name="follow">
//!   <resources><resource name="cpu" unit="cores" weight="1"/></resources>
//!   <sub_tasks>
//!     <sub_task name="see">
//!       <component name="camera" class="sensor" threshold="0.5"/>
//!       <component name="filter" class="computation" essential="false"/>
//!     </sub_task>
//!     <sub_task name="move"><component name="motor" class="actuator"/></sub_task>
//!   </sub_tasks>
//!   <state_machine initial="following">
//!     <state name="following"><run sub_task="see"/><run sub_task="move"/></state>
//!   </state_machine>
//!   <links><link from="camera" to="motor"><through component="filter"/></link></links>
//!   <robots>
//!     <robot name="R1">
//!       <has resource="cpu" amount="2"/>
//!       <instance component="camera"><needs resource="cpu" amount="0.2"/><estimate functional="0.1"/></instance>
//!       <instance component="motor"/>
//!     </robot>
//!   </robots>
//! </task_profile>
//! ```
//!
//! Components stand in the order in which data flow through them: candidates are numbered by it.

mod attachment;
mod names;
mod preferences;
mod robots;
mod states;
mod structure;

use std::path::Path;

use system_model::task::TaskSpecification;

use crate::document::Document;
use crate::node::Node;
use crate::problem::Problem;
use names::Names;

/// The outermost element of a task file.
pub(super) const TASK_ROOT: &str = "task_profile";

/// What came of loading a task.
#[derive(Debug)]
pub struct TaskOutcome {
    /// The task, if its file has no error.
    pub task: Option<TaskSpecification>,
    /// All problems of the file, sorted by place.
    pub problems: Vec<Problem>,
    /// Whether the file could be opened and decoded.
    pub is_readable: bool,
}

/// Loads a task. All its names are resolved, amounts are finite and not negative.
pub fn load_task(path: &Path) -> TaskOutcome {
    load(&Document::open(path))
}

fn load(document: &Document) -> TaskOutcome {
    let task = document.root(&[TASK_ROOT]).and_then(|root| {
        let task = read(&root);
        root.finish();
        task
    });
    TaskOutcome {
        task: task.filter(|_| !document.has_errors()),
        problems: document.problems(),
        is_readable: document.is_readable(),
    }
}

/// Reads a task; none if a part of it is missing. What else is wrong with it has been reported.
pub(super) fn read(root: &Node<'_>) -> Option<TaskSpecification> {
    let name = root.required_attribute("name");
    let resources = preferences::resources(root);
    let resource_names = Names::of("resource", resources.iter().map(|it| &it.name));
    let structure = structure::read(root);
    let component_names = Names::of("component", structure.components.iter().map(|it| &it.name));
    let state_machine = states::read(root, &structure.sub_tasks);
    let links = structure::links(root, &structure.components, &component_names);
    let exclusions = structure::exclusions(root, &structure.components, &component_names);
    let known = robots::Known {
        resources: &resource_names,
        components: &component_names,
    };
    let robots = robots::read(root, &known);
    let quality = preferences::quality(root);
    let generation = preferences::generation(root);
    let decision = preferences::decision(root);
    root.pass_over(&["description", "version", "copyright"]);
    let mut task = TaskSpecification {
        name: name?.as_str().to_owned(),
        sub_tasks: structure.sub_tasks,
        state_machine: state_machine?,
        components: structure.components,
        links,
        exclusions,
        resources,
        robots,
        quality: quality?,
        generation: generation?,
        decision: decision?,
        running: None,
    };
    let running = root.child("running");
    task.running = running.map(|node| robots::running(&node, &task, &component_names));
    robots::warn_of_missing(root, &task);
    Some(task)
}

#[cfg(test)]
mod tests;
