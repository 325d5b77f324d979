//! Actuator control: turns motion decisions into commands for the motion board.
//!
//! Properties: `wheel_radius_m`, `track_m` and `wheel_maximum_rpm` of the robot;
//! `decision_timeout_ms`: without a new decision for this long the robot is stopped.
#![forbid(unsafe_code)]

use std::time::Duration;

use component_sdk::prelude::*;
use robot_interface::differential_drive::DifferentialDrive;
use robot_interface::port_data::{MotionDecision, MotorCommand};
use robot_interface::serial_line::MotionCommand;

/// Five cycles of the planner: one that is late is no reason to stop, one that is gone is.
const DECISION_TIMEOUT_MS: u64 = 200;

/// Ports of actuator control.
#[derive(Ports)]
pub struct ActuatorControlPorts {
    motion: Input<MotionDecision>,
    command: Output<MotorCommand>,
}

/// Actuator control.
pub struct ActuatorControl {
    ports: ActuatorControlPorts,
    drive: DifferentialDrive,
    decision_timeout: Duration,
    /// The last decision and when it arrived.
    decision: Option<(MotionDecision, Duration)>,
}

impl Component for ActuatorControl {
    type Ports = ActuatorControlPorts;

    fn new(ports: ActuatorControlPorts) -> Self {
        Self {
            ports,
            drive: DifferentialDrive::default(),
            decision_timeout: Duration::from_millis(DECISION_TIMEOUT_MS),
            decision: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.drive = DifferentialDrive::of_properties(context)?;
        let timeout_ms = context.property_or("decision_timeout_ms", DECISION_TIMEOUT_MS)?;
        self.decision_timeout = Duration::from_millis(timeout_ms);
        Ok(())
    }

    fn on_reset(&mut self, _context: &Context) -> Outcome {
        self.decision = None;
        Ok(())
    }

    fn on_recover(&mut self, _context: &Context) -> Outcome {
        // What was decided before the failure is too old to be driven.
        self.decision = None;
        Ok(())
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let now = context.now();
        if let Some(decision) = self.ports.motion.read() {
            self.decision = Some((decision, now));
        }
        let is_fresh = |at: Duration| now.saturating_sub(at) < self.decision_timeout;
        let command = match self.decision {
            Some((decision, at)) if is_fresh(at) => self.drive.command(&decision),
            _ => MotionCommand::stop(),
        };
        let time_ns = u64::try_from(now.as_nanos()).unwrap_or(u64::MAX);
        self.ports
            .command
            .write(&MotorCommand::new(time_ns, command));
        Ok(())
    }
}

export_component!(ActuatorControl);
