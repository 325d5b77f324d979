//! The simulation as a component sees it: through its lines, in simulated time.

mod arenas;
mod drive;
mod driver;
mod lines;
mod planner;
mod reference_drive;
mod repeatability;
mod sensors;
