//! Motor driver: the main board's end of the serial line to the motion board.
//!
//! Property `device`: what to open, by default the motion board of the simulated world; a real one
//! is at `/dev/ttyUSB0` or the like.
#![forbid(unsafe_code)]

use std::fs::File;
use std::io;

use component_sdk::prelude::*;
use robot_interface::port_data::{EncoderTicks, MotorCommand, RangeReport};
use robot_interface::serial_line::{BoardLine, BoardReport};

const METRES_PER_MILLIMETRE: f64 = 0.001;

/// Ports of the driver.
#[derive(Ports)]
pub struct MotorDriverPorts {
    command: Input<MotorCommand>,
    encoders: Output<EncoderTicks>,
    ranges: Output<RangeReport>,
}

/// The driver.
pub struct MotorDriver {
    ports: MotorDriverPorts,
    device: String,
    line: Option<BoardLine<File>>,
}

impl MotorDriver {
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

    fn publish(&self, time_ns: u64, report: &BoardReport) {
        self.ports.encoders.write(&EncoderTicks {
            time: time_ns,
            left: report.left_encoder_ticks,
            right: report.right_encoder_ticks,
        });
        self.ports.ranges.write(&RangeReport {
            time: time_ns,
            distances: report
                .ranges_mm
                .map(|range_mm| f64::from(range_mm) * METRES_PER_MILLIMETRE),
        });
    }
}

impl Component for MotorDriver {
    type Ports = MotorDriverPorts;

    fn new(ports: MotorDriverPorts) -> Self {
        Self {
            ports,
            device: String::new(),
            line: None,
        }
    }

    fn on_initialize(&mut self, context: &Context) -> Outcome {
        self.device = context.property_or("device", "simulated:motion_board".to_owned())?;
        self.connect(context)
    }

    fn on_reset(&mut self, _context: &Context) -> Outcome {
        self.line = None;
        Ok(())
    }

    fn on_recover(&mut self, context: &Context) -> Outcome {
        self.connect(context)
    }

    fn on_execute(&mut self, context: &Context) -> Outcome {
        let Some(line) = &mut self.line else {
            return Ok(());
        };
        let report = line.receive();
        // Only a fresh command is sent: if nobody commands any more, the board must notice.
        let sent = match self.ports.command.read() {
            Some(command) => {
                let command = command.motion_command().ok_or_else(|| {
                    let message = format!("the motion board has no such command: {command:?}");
                    Failure::new(Status::INPUT_OUT_OF_RANGE, message)
                })?;
                line.send(command)
            }
            None => Ok(()),
        };
        let report = report.map_err(|error| self.line_is_gone(&error))?;
        sent.map_err(|error| self.line_is_gone(&error))?;
        if let Some(report) = report {
            let time_ns = u64::try_from(context.now().as_nanos()).unwrap_or(u64::MAX);
            self.publish(time_ns, &report);
        }
        Ok(())
    }
}

export_component!(MotorDriver);
