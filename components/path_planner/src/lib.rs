//! Path planner: decides how to move from where the target is and what is in the way.
//!
//! Properties: `cruise_speed_m_per_s`; `arrival_distance_m`, the gap before the target at which the
//! robot stands; `target_radius_m`.
#![forbid(unsafe_code)]

mod goal_memory;
mod planner;
mod search;

use component_sdk::prelude::*;
use robot_interface::port_data::{DetectedObject, MotionDecision, ObstacleReport, WheelOdometry};

use planner::{Planner, PlannerMemory, Situation};

/// Ports of the planner.
#[derive(Ports)]
pub struct PathPlannerPorts {
    object: Input<DetectedObject>,
    obstacles: Input<ObstacleReport>,
    odometry: Input<WheelOdometry>,
    motion: Output<MotionDecision>,
}

/// The planner.
pub struct PathPlanner {
    ports: PathPlannerPorts,
    planner: Planner,
    /// Registered, so that a successor goes on where this one was.
    memory: Option<&'static mut PlannerMemory>,
}

impl Component for PathPlanner {
    type Ports = PathPlannerPorts;

    fn new(ports: PathPlannerPorts) -> Self {
        Self {
            ports,
            planner: Planner::default(),
            memory: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        let default = Planner::default();
        self.planner = Planner {
            cruise_speed_m_per_s: context
                .property_or("cruise_speed_m_per_s", default.cruise_speed_m_per_s)?,
            arrival_distance_m: context
                .property_or("arrival_distance_m", default.arrival_distance_m)?,
            target_radius_m: context.property_or("target_radius_m", default.target_radius_m)?,
        };
        if self.memory.is_none() {
            self.memory = Some(context.critical(PlannerMemory::default())?);
        }
        Ok(())
    }

    fn on_reset(&mut self, _context: &Context) -> Outcome {
        if let Some(memory) = &mut self.memory {
            **memory = PlannerMemory::default();
        }
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let Some(memory) = &mut self.memory else {
            return Ok(());
        };
        let situation = Situation {
            time_ns: u64::try_from(context.now().as_nanos()).unwrap_or(u64::MAX),
            object: self.ports.object.read(),
            obstacles: self.ports.obstacles.latest(),
            odometry: self.ports.odometry.latest(),
        };
        self.ports
            .motion
            .write(&self.planner.plan(memory, &situation));
        Ok(())
    }
}

export_component!(PathPlanner);
