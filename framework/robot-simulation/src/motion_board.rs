//! The firmware of the motion board: commands in, motors, sensors, reports out.

use std::f64::consts::TAU;
use std::time::Duration;

use robot_interface::serial_line::{BoardReport, Decoder, Message, MotionCommand, encode};
use system_model::world::SONAR_COUNT;

use crate::drive::{Drive, SideCommand};
use crate::fault::{Faults, Side};

/// The board stops the motors when no command arrived for this long, as real boards do: a main
/// board that hangs must not leave a moving robot behind.
pub(crate) const COMMAND_TIME_OUT: Duration = Duration::from_millis(200);
/// Reports, and sonar shots: the echo of a wall 3 m away needs 17.5 ms, so the sensors fire one
/// after the other, one a report.
pub(crate) const REPORT_PERIOD: Duration = Duration::from_millis(20);

/// The board.
#[derive(Debug, Clone)]
pub(crate) struct MotionBoard {
    decoder: Decoder,
    command: MotionCommand,
    command_at: Duration,
    stopped_by_time_out: bool,
    sequence: u16,
    ranges_mm: [u16; SONAR_COUNT],
    left_encoder: Encoder,
    right_encoder: Encoder,
}

impl MotionBoard {
    pub(crate) fn new(encoder_ticks_per_revolution: u32) -> Self {
        let encoder = Encoder::new(encoder_ticks_per_revolution);
        Self {
            decoder: Decoder::new(),
            command: MotionCommand::stop(),
            command_at: Duration::ZERO,
            stopped_by_time_out: false,
            sequence: 0,
            ranges_mm: [0; SONAR_COUNT],
            left_encoder: encoder,
            right_encoder: encoder,
        }
    }

    /// Takes bytes from the line and looks at the time since the last command.
    pub(crate) fn receive(&mut self, bytes: &[u8], now: Duration) {
        for message in self.decoder.push(bytes) {
            if let Message::Command(command) = message {
                self.command = command;
                self.command_at = now;
            }
        }
        self.stopped_by_time_out = now.saturating_sub(self.command_at) >= COMMAND_TIME_OUT;
    }

    /// What the left and the right motor driver are told.
    pub(crate) fn side_commands(&self, faults: &Faults) -> (SideCommand, SideCommand) {
        let (left_rpm, right_rpm) = if self.stopped_by_time_out {
            (0.0, 0.0)
        } else {
            self.command.wheel_rpm()
        };
        let side = |rpm, side| SideCommand {
            rpm,
            powered: faults.motor_driver_on(side),
        };
        (side(left_rpm, Side::Left), side(right_rpm, Side::Right))
    }

    /// Counts what the wheels have turned.
    pub(crate) fn count(&mut self, drive: &Drive, faults: &Faults) {
        for (side, encoder) in [
            (Side::Left, &mut self.left_encoder),
            (Side::Right, &mut self.right_encoder),
        ] {
            encoder.follow(drive.turned_rad(side), faults.encoder_counts(side));
        }
    }

    /// The sensor that fires before the next report.
    pub(crate) fn next_sonar(&self) -> usize {
        usize::from(self.sequence) % SONAR_COUNT
    }

    /// Takes a range; none means that the sensor did not answer.
    pub(crate) fn take_range(&mut self, sonar: usize, range_m: Option<f64>) {
        self.ranges_mm[sonar] = range_m.map_or(0, |range_m| (range_m * 1000.0).round() as u16);
    }

    /// The next report as bytes for the line.
    pub(crate) fn report(&mut self) -> Vec<u8> {
        let report = BoardReport {
            sequence: self.sequence,
            stopped_by_time_out: self.stopped_by_time_out,
            left_encoder_ticks: self.left_encoder.ticks(),
            right_encoder_ticks: self.right_encoder.ticks(),
            ranges_mm: self.ranges_mm,
        };
        self.sequence = self.sequence.wrapping_add(1);
        encode(&Message::Report(report))
    }
}

/// The counter of one side; what turns while it is dead is lost for ever.
#[derive(Debug, Clone, Copy)]
struct Encoder {
    ticks_per_rad: f64,
    seen_rad: f64,
    counted_rad: f64,
}

impl Encoder {
    fn new(ticks_per_revolution: u32) -> Self {
        Self {
            ticks_per_rad: f64::from(ticks_per_revolution) / TAU,
            seen_rad: 0.0,
            counted_rad: 0.0,
        }
    }

    fn follow(&mut self, turned_rad: f64, counts: bool) {
        if counts {
            self.counted_rad += turned_rad - self.seen_rad;
        }
        self.seen_rad = turned_rad;
    }

    fn ticks(&self) -> i32 {
        // Through i64, so that the counter wraps like that of the board.
        (self.counted_rad * self.ticks_per_rad).floor() as i64 as i32
    }
}
