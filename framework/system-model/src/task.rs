//! Tasks of one or more robots, for self-adaptation: what has to be done, which components could do
//! it on which robot, and by what a way of doing it is judged. Section 3 of the ReFrESH paper.
//!
//! Names have been resolved: components, robots and resources are numbered as their lists in
//! [`TaskSpecification`] are.

mod attachment;
mod options;

pub use attachment::{
    Attachment, ContainerFigure, DEFAULT_EVALUATION_PERIOD, Estimator, Evaluator, LinkPorts,
    QualityAttribute, ResourceSensor,
};
pub use options::{
    DEFAULT_CANDIDATE_LIMIT, DecisionOptions, GenerationOptions, HopCount, QualityPreferences,
};

use crate::profile::Located;

/// Position in [`TaskSpecification::components`].
pub type ComponentIndex = usize;
/// Position in [`TaskSpecification::robots`].
pub type RobotIndex = usize;
/// Position in [`TaskSpecification::resources`].
pub type ResourceIndex = usize;

/// Definition 3, Equation (1): T = (T_sub, SM, R_i : SS, R_i : AS, R_i : Re).
#[derive(Debug, Clone, PartialEq)]
pub struct TaskSpecification {
    /// The task's name.
    pub name: String,
    /// T_sub: what has to be done, in the order of the file.
    pub sub_tasks: Vec<SubTask>,
    /// SM: which sub-tasks are at work when.
    pub state_machine: StateMachine,
    /// All components that the task may use, in the order in which data flow through them.
    pub components: Vec<TaskComponent>,
    /// Which component gives its output to which.
    pub links: Vec<TaskLink>,
    /// Of the components of one exclusion at most one is used.
    pub exclusions: Vec<Vec<ComponentIndex>>,
    /// What robots have and components use up; an open list.
    pub resources: Vec<TaskResource>,
    /// R_i with what they can sense and do (SS, AS) and have (Re).
    pub robots: Vec<TaskRobot>,
    /// Weights and thresholds of Definition 6.
    pub quality: QualityPreferences,
    /// How candidates are generated.
    pub generation: GenerationOptions,
    /// When and how it is decided.
    pub decision: DecisionOptions,
    /// T_cur: what runs when nothing has been decided yet; each essential component is in it once.
    pub running: Option<Vec<Placement>>,
}

/// A part of the task: a purpose that some components serve together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SubTask {
    /// Its name.
    pub name: String,
    /// Its components.
    pub components: Vec<ComponentIndex>,
}

/// Which sub-tasks are at work when.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StateMachine {
    /// The states; the first one is that in which the task begins.
    pub states: Vec<TaskState>,
    /// What leads from one to another.
    pub transitions: Vec<Transition>,
}

/// A state of the task.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskState {
    /// Its name.
    pub name: String,
    /// Positions in [`TaskSpecification::sub_tasks`] of those that are at work.
    pub sub_tasks: Vec<usize>,
}

/// A change of state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Transition {
    /// Position in [`StateMachine::states`].
    pub from: usize,
    /// Position in [`StateMachine::states`].
    pub to: usize,
    /// Name of the event.
    pub event: String,
}

/// What a component deals with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ComponentClass {
    /// SS: with a sensor, so that it matters on which robot it runs.
    Sensor,
    /// AS: with an actuator; likewise.
    Actuator,
    /// CS: with data only, so that it does the same on every robot.
    Computation,
}

impl ComponentClass {
    /// Whether it is bound to hardware: two instances on two robots are not the same then.
    pub fn is_bound(self) -> bool {
        self != Self::Computation
    }
}

/// A component that the task may use, whichever robot it runs on.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskComponent {
    /// Its name.
    pub name: String,
    /// What it deals with.
    pub class: ComponentClass,
    /// Whether every way to do the task needs it (Definition 4) or it may be added (Definition 5).
    pub is_essential: bool,
    /// P_th of Equation (3): the largest functional error that is acceptable, 0 or more, in the unit
    /// of the estimates.
    pub threshold: f64,
}

/// A connection of two essential components.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TaskLink {
    /// Whose output.
    pub from: ComponentIndex,
    /// Whose input.
    pub to: ComponentIndex,
    /// Components that are put in between where they are used, in this order; none is essential.
    pub through: Vec<ComponentIndex>,
    /// Its ports in a running application.
    pub ports: LinkPorts,
}

/// A resource, such as processor time, memory, battery power or area of an accelerator.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskResource {
    /// Its name.
    pub name: String,
    /// Unit of all amounts of it, for people; may be empty.
    pub unit: String,
    /// β_j of Equation (4): how much it matters, 0 or more.
    pub weight: f64,
}

/// A robot of the team.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskRobot {
    /// Its name.
    pub name: String,
    /// Re_i: what the task may use of each resource, by [`ResourceIndex`]; 0 where it has none.
    pub available: Vec<f64>,
    /// Resources of which a port of its application tells how much it has.
    pub sensors: Vec<Located<ResourceSensor>>,
    /// What can run on it, each component once.
    pub instances: Vec<TaskInstance>,
}

/// A component on a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct TaskInstance {
    /// Which component.
    pub component: ComponentIndex,
    /// What it needs of each resource, by [`ResourceIndex`], 0 or more.
    pub demand: Vec<f64>,
    /// P_cf where it is known beforehand; the first whose conditions hold counts.
    pub estimates: Vec<GivenEstimate>,
    /// What it is in a running application.
    pub attachment: Attachment,
}

/// A functional error that is known beforehand.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenEstimate {
    /// The error, in the unit of the component's threshold: 0 is perfect.
    pub functional: f64,
    /// What else has to be in use; always, if there is nothing here.
    pub with: Vec<Condition>,
}

/// That a component is in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Condition {
    /// Which component.
    pub component: ComponentIndex,
    /// On which robot; on any, if there is none.
    pub robot: Option<RobotIndex>,
}

/// A component in use on a robot that has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Placement {
    /// Which component.
    pub component: ComponentIndex,
    /// On which robot.
    pub robot: RobotIndex,
}

impl TaskSpecification {
    /// A component's instance on a robot, if that robot has it.
    pub fn instance(&self, placement: Placement) -> Option<&TaskInstance> {
        let robot = self.robots.get(placement.robot)?;
        let mut instances = robot.instances.iter();
        instances.find(|instance| instance.component == placement.component)
    }

    /// The robots that have a component, in the order of the file.
    pub fn robots_with(&self, component: ComponentIndex) -> Vec<RobotIndex> {
        let has = |robot: &usize| {
            let robot = *robot;
            let placement = Placement { component, robot };
            self.instance(placement).is_some()
        };
        (0..self.robots.len()).filter(has).collect()
    }

    /// A placement as people and reports name it: `R1:Cam_reader`.
    pub fn placement_name(&self, placement: Placement) -> String {
        let robot = self.robots.get(placement.robot);
        let component = self.components.get(placement.component);
        format!(
            "{}:{}",
            robot.map_or("?", |robot| &robot.name),
            component.map_or("?", |component| &component.name)
        )
    }
}
