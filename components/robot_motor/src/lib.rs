//! Robot motor: drives the robot through its motion board.
//!
//! Properties: `device`, by default the motion board of the simulated world; `wheel_radius_m`,
//! `track_m` and `wheel_maximum_rpm` of the robot; `decision_timeout_ms`: without a new decision for
//! this long the robot is stopped.
#![forbid(unsafe_code)]

use std::fs::File;
use std::io;
use std::time::Duration;

use component_sdk::prelude::*;
use robot_interface::differential_drive::DifferentialDrive;
use robot_interface::port_data::{EncoderTicks, MotionDecision};
use robot_interface::serial_line::{BoardLine, MotionCommand};

/// Three pictures of a camera that takes ten a second: one that is late is no reason to stop.
const DECISION_TIMEOUT_MS: u64 = 300;

/// Ports of the motor.
#[derive(Ports)]
pub struct RobotMotorPorts {
    motion: Input<MotionDecision>,
    encoders: Output<EncoderTicks>,
}

/// The motor.
pub struct RobotMotor {
    ports: RobotMotorPorts,
    device: String,
    line: Option<BoardLine<File>>,
    drive: DifferentialDrive,
    decision_timeout: Duration,
    /// The last decision and when it arrived.
    decision: Option<(MotionDecision, Duration)>,
}

impl RobotMotor {
    fn connect(&mut self, context: &Context) -> Outcome {
        self.line = Some(BoardLine::new(context.open_device(&self.device)?));
        Ok(())
    }

    fn line_is_gone(&self, error: &io::Error) -> Failure {
        Failure::internal(format!(
            "the serial line '{}' to the motion board is gone: {error}; plug it in again and reset \
             the component, or set its property 'device' to where the board is now",
            self.device
        ))
    }

    fn command(&self, now: Duration) -> MotionCommand {
        let is_fresh = |at: Duration| now.saturating_sub(at) < self.decision_timeout;
        match self.decision {
            Some((decision, at)) if is_fresh(at) => self.drive.command(&decision),
            _ => MotionCommand::stop(),
        }
    }
}

impl Component for RobotMotor {
    type Ports = RobotMotorPorts;

    fn new(ports: RobotMotorPorts) -> Self {
        Self {
            ports,
            device: String::new(),
            line: None,
            drive: DifferentialDrive::default(),
            decision_timeout: Duration::from_millis(DECISION_TIMEOUT_MS),
            decision: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.drive = DifferentialDrive::of_properties(context)?;
        let timeout_ms = context.property_or("decision_timeout_ms", DECISION_TIMEOUT_MS)?;
        self.decision_timeout = Duration::from_millis(timeout_ms);
        self.device = context.property_or("device", "simulated:motion_board".to_owned())?;
        self.connect(context)
    }

    fn on_reset(&mut self, _context: &Context) -> Outcome {
        (self.line, self.decision) = (None, None);
        Ok(())
    }

    fn on_recover(&mut self, context: &Context) -> Outcome {
        // What was decided before the failure is too old to be driven.
        self.decision = None;
        self.connect(context)
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let now = context.now();
        if let Some(decision) = self.ports.motion.read() {
            self.decision = Some((decision, now));
        }
        let command = self.command(now);
        let Some(line) = &mut self.line else {
            return Ok(());
        };
        let report = line.receive();
        let sent = line.send(command);
        let report = report.map_err(|error| self.line_is_gone(&error))?;
        sent.map_err(|error| self.line_is_gone(&error))?;
        if let Some(report) = report {
            self.ports.encoders.write(&EncoderTicks {
                time: u64::try_from(now.as_nanos()).unwrap_or(u64::MAX),
                left: report.left_encoder_ticks,
                right: report.right_encoder_ticks,
            });
        }
        Ok(())
    }
}

export_component!(RobotMotor);
