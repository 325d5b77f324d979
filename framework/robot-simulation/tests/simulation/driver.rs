//! Worlds and a driver's end of the lines, for the tests.

use std::fs::File;
use std::io::{Read, Write};
use std::time::Duration;

use robot_interface::camera_stream::{Picture, PictureDecoder};
use robot_interface::serial_line::{BoardReport, Decoder, Message, MotionCommand, encode};
use robot_simulation::{CAMERA, MOTION_BOARD, Simulation, Transport};
use system_model::world::{Pose, Position, TargetPlace, WorldSpecification};

/// The arena of the reference scenario without obstacles and sonar noise; the robot in the middle.
pub fn empty_world() -> WorldSpecification {
    let mut world = WorldSpecification {
        random_obstacles: None,
        ..Default::default()
    };
    world.robot.start = pose(3.0, 2.0, 0.0);
    world.target.place = TargetPlace::Fixed(Position { x_m: 5.2, y_m: 3.2 });
    for sonar in &mut world.sonars {
        sonar.noise_sigma_m = 0.0;
    }
    world
}

pub fn pose(x_m: f64, y_m: f64, heading_rad: f64) -> Pose {
    Pose {
        position: Position { x_m, y_m },
        heading_rad,
    }
}

/// A driver at the other end of both lines, in simulated time.
pub struct Driver {
    pub simulation: Simulation,
    pub last_report: BoardReport,
    pub reports: u32,
    board: File,
    camera: File,
    decoder: Decoder,
    pictures: PictureDecoder,
}

impl Driver {
    pub fn new(world: &WorldSpecification, seed: u64) -> Self {
        let mut simulation = Simulation::new(world, seed).expect("a good world");
        let open = |simulation: &mut Simulation, device| {
            File::from(
                simulation
                    .open(device, Transport::InProcess)
                    .expect("a device"),
            )
        };
        Self {
            board: open(&mut simulation, MOTION_BOARD),
            camera: open(&mut simulation, CAMERA),
            simulation,
            last_report: BoardReport::default(),
            reports: 0,
            decoder: Decoder::new(),
            pictures: PictureDecoder::new(),
        }
    }

    pub fn command(&mut self, command: MotionCommand) {
        let frame = encode(&Message::Command(command));
        self.board.write_all(&frame).expect("room for a command");
    }

    pub fn send_damaged(&mut self, command: MotionCommand) {
        let mut frame = encode(&Message::Command(command));
        frame[5] ^= 1;
        self.board.write_all(&frame).expect("room for a command");
    }

    /// Moves on without a command.
    pub fn wait(&mut self, time: Duration) -> Option<Picture> {
        self.simulation.advance_to(self.simulation.time() + time);
        let mut bytes = [0; 4096];
        while let Ok(length @ 1..) = self.board.read(&mut bytes) {
            for message in self.decoder.push(&bytes[..length]) {
                if let Message::Report(report) = message {
                    self.last_report = report;
                    self.reports += 1;
                }
            }
        }
        let mut newest = None;
        while let Ok(length @ 1..) = self.camera.read(&mut bytes) {
            newest = self.pictures.push(&bytes[..length]).or(newest);
        }
        newest
    }

    /// Repeats a command every 50 ms and returns the last picture.
    pub fn drive(&mut self, command: MotionCommand, time: Duration) -> Option<Picture> {
        let end = self.simulation.time() + time;
        let mut newest = None;
        while self.simulation.time() < end {
            self.command(command);
            newest = self.wait(Duration::from_millis(50)).or(newest);
        }
        newest
    }
}

/// A command by wheel speeds.
pub fn wheels(left_rpm: f64, right_rpm: f64) -> MotionCommand {
    MotionCommand::from_wheel_rpm(left_rpm, right_rpm)
}
