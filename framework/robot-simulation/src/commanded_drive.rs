//! The drive of the robot as its main board knows it: commands down the serial line, encoder counts
//! up, cycle by cycle, without the components between.

use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

use robot_interface::serial_line::{Decoder, Message, MotionCommand, encode};
use system_model::world::WorldSpecification;

use crate::line::Transport;
use crate::motion_board::REPORT_PERIOD;
use crate::simulation::{MOTION_BOARD, Simulation};

/// More than the board sends in a cycle.
const BUFFER_LENGTH: usize = 256;

/// What the main board has learnt in one cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EncoderCounts {
    /// Ticks of the left wheels, forward is up; wraps.
    pub left: i32,
    /// Ticks of the right wheels.
    pub right: i32,
}

/// A command for both sides in the words of table 4.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WheelCommand(MotionCommand);

impl WheelCommand {
    /// The command that comes nearest to these wheel speeds in rpm (forward is positive).
    pub fn from_wheel_rpm(left: f64, right: f64) -> Self {
        Self(MotionCommand::from_wheel_rpm(left, right))
    }

    /// `motion_type` of table 4: 0 stop, 1 forward, 2 backward, 3 turn left, 4 turn right.
    pub fn motion_type(self) -> u32 {
        self.0.motion_type as u32
    }

    /// Mean wheel speed in rpm, not negative.
    pub fn rpm(self) -> i32 {
        i32::from(self.0.rpm)
    }

    /// Difference between the wheel speeds in rpm.
    pub fn rpm_difference(self) -> i32 {
        i32::from(self.0.rpm_difference)
    }
}

/// How the cycles of the main board lie in time. Real executors and a real board run with the same
/// period but not in step; simulated time has no phase and the whole latency.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CyclePhases {
    /// Age of a report when it is read: how much later than the board's the cycles begin.
    pub report_age: Duration,
    /// From a cycle to the sending of the command that was decided in it, at most a cycle.
    pub command_latency: Duration,
}

impl Default for CyclePhases {
    /// As in simulated time: a report is read when it is made, a command is sent in the next cycle.
    fn default() -> Self {
        Self {
            report_age: Duration::ZERO,
            command_latency: REPORT_PERIOD,
        }
    }
}

/// A simulated robot whose wheels are commanded directly.
pub struct CommandedDrive {
    simulation: Simulation,
    line: File,
    decoder: Decoder,
    command_latency: Duration,
    /// Begin of the next cycle.
    next: Duration,
}

impl CommandedDrive {
    /// Time between two cycles: that of the board's reports.
    pub const CYCLE: Duration = REPORT_PERIOD;

    /// The robot at its start.
    ///
    /// # Errors
    /// When no arena can be drawn, or the operating system has no line left.
    pub fn new(world: &WorldSpecification, seed: u64, phases: CyclePhases) -> io::Result<Self> {
        let mut simulation = Simulation::new(world, seed).map_err(io::Error::other)?;
        let line = simulation.open(MOTION_BOARD, Transport::InProcess)?;
        Ok(Self {
            simulation,
            line: File::from(line),
            decoder: Decoder::new(),
            command_latency: phases.command_latency.min(Self::CYCLE),
            next: Self::CYCLE + phases.report_age,
        })
    }

    /// The world that the robot is in.
    pub fn simulation_mut(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    /// One cycle: the command decided in the last one is sent, and at the beginning of the next one
    /// the newest report is read. `None` if no report has come.
    ///
    /// # Errors
    /// When the line is broken.
    pub fn cycle(&mut self, command: WheelCommand) -> io::Result<Option<EncoderCounts>> {
        let last = self.next.saturating_sub(Self::CYCLE);
        self.simulation.advance_to(last + self.command_latency);
        self.line.write_all(&encode(&Message::Command(command.0)))?;
        self.simulation.advance_to(self.next);
        self.next += Self::CYCLE;
        self.newest_report()
    }

    fn newest_report(&mut self) -> io::Result<Option<EncoderCounts>> {
        let mut newest = None;
        let mut buffer = [0; BUFFER_LENGTH];
        loop {
            match self.line.read(&mut buffer) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(length) => {
                    for message in self.decoder.push(&buffer[..length]) {
                        if let Message::Report(report) = message {
                            newest = Some(EncoderCounts {
                                left: report.left_encoder_ticks,
                                right: report.right_encoder_ticks,
                            });
                        }
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(newest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ticks of the right wheels after a second of turning left.
    fn turned(phases: CyclePhases) -> i32 {
        let world = WorldSpecification::default();
        let mut drive = CommandedDrive::new(&world, 1, phases).expect("a world");
        let command = WheelCommand::from_wheel_rpm(-20.0, 20.0);
        let mut counts = EncoderCounts::default();
        for _ in 0..50 {
            counts = drive.cycle(command).expect("a line").expect("a report");
        }
        assert!((counts.left + counts.right).abs() < 3, "{counts:?}");
        counts.right
    }

    #[test]
    fn a_command_turns_the_wheels_and_every_cycle_has_a_report() {
        // A third of a turn, less the time to speed up.
        let in_step = turned(CyclePhases::default());
        assert!((80..120).contains(&in_step), "{in_step}");
        let early = turned(CyclePhases {
            command_latency: Duration::ZERO,
            ..CyclePhases::default()
        });
        let late = turned(CyclePhases {
            report_age: Duration::from_millis(15),
            ..CyclePhases::default()
        });
        assert!(early > in_step, "{early} {in_step} {late}");
        assert!(late >= in_step - 3, "{early} {in_step} {late}");
    }

    #[test]
    fn a_command_is_written_in_the_words_of_the_line() {
        let command = WheelCommand::from_wheel_rpm(-10.0, -30.0);
        assert_eq!(
            (
                command.motion_type(),
                command.rpm(),
                command.rpm_difference()
            ),
            (2, 20, -20)
        );
    }
}
