//! What would be done if a component had this fault: the answer of the fault manager itself, without
//! a robot.
//!
//! A stand-in takes the container's place: components that do nothing but complete their cycles and
//! send data, on one thread in simulated time. What goes wrong is told to a real
//! [`FaultManager`](crate::FaultManager), and what that wants done is done, so an answer is right as
//! far as the stand-in behaves as the container does; a long test of the project compares the two for
//! every fault of every component of the reference robot.
//!
//! A stand-in knows only what profiles and rules say. What a component makes of data that are wrong,
//! or do not come, it cannot know: it is taken to cope with them, and [`Answer::reaches`] says who got
//! some. Of whom that is not true can be told by [`Assumptions::passes_on`].

mod answer;
mod query;
mod stand_in;
mod supposition;
mod table;

pub use answer::{Answer, ApplicationEnd, ComponentEnd};
pub use query::{QueryError, find, input_port, parse};
pub use stand_in::BEGIN;
pub use supposition::{
    DELAY, ERROR_CODE, Inapplicable, LEAK_BYTES, SupposedFault, Supposition, slowness,
};
pub use table::{Cell, Row, Table};

use crate::graph::{Graph, Level};
use crate::system::{Scope, System};

/// Whether the recoveries that the fault manager asks for succeed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Recoveries {
    /// They do: the component works again, until what is wrong comes back.
    #[default]
    Succeed,
    /// None does: the ladder is climbed to its end.
    Fail,
}

/// What is taken for true about what no profile and no rule says.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Assumptions {
    /// What comes of recoveries.
    pub recoveries: Recoveries,
    /// Inputs whose component passes on what comes there: if that is wrong, or nothing comes any
    /// more, so it is with all that the component sends.
    pub passes_on: Vec<InputPort>,
}

/// An input data port of a component.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputPort {
    /// Index of the application.
    pub application: usize,
    /// Index of the component in it.
    pub component: usize,
    /// Name of the port.
    pub port: String,
}

/// Who else would come down if a component were stopped, by the dependency rules: application and
/// component of each, and whether it would be destroyed, not only stopped.
pub fn dependents(
    scopes: &[Scope],
    application: usize,
    component: usize,
) -> Vec<(usize, usize, bool)> {
    let system = System::new(scopes);
    let firsts = |application: usize| system.applications[application].members.start;
    let mut levels = vec![Level::Up; system.components.len()];
    levels[firsts(application) + component] = Level::Stopped;
    let demands = Graph::new(scopes, &system).spread(&mut levels);
    let who = demands.into_iter().map(|(index, demand)| {
        let application = system.components[index].application;
        let destroyed = demand.level == Level::Destroyed;
        (application, index - firsts(application), destroyed)
    });
    who.collect()
}

/// What would be done about a fault, in these applications.
///
/// # Errors
/// If the component cannot have that fault.
pub fn answer(
    scopes: &[Scope],
    supposition: &Supposition,
    assumptions: &Assumptions,
) -> Result<Answer, Inapplicable> {
    supposition.check(scopes)?;
    Ok(stand_in::StandIn::new(scopes, supposition, assumptions).run())
}
