//! The world as it moves through time.

use std::io;
use std::os::fd::OwnedFd;
use std::path::Path;
use std::time::Duration;

use rand_pcg::Pcg64;
use robot_interface::camera_stream;
use system_model::world::{Pose, Position, WorldSpecification};

use crate::arena::Arena;
use crate::camera::{self, Air};
use crate::drive::Drive;
use crate::drive_record::{DriveRecord, RobotSummary};
use crate::error::SimulationError;
use crate::fault::{Fault, Faults, Side};
use crate::geometry::{along, compose};
use crate::line::{Line, Transport};
use crate::motion_board::{MotionBoard, REPORT_PERIOD};
use crate::physics::Physics;
use crate::random::{Purpose, stream};
use crate::sonar::measure_m;
use crate::sway;

/// Name of the device that drives the robot: the motion board.
pub const MOTION_BOARD: &str = "motion_board";
/// Name of the device that sends pictures.
pub const CAMERA: &str = "camera";

/// The robot moves 1.7 mm in it at full speed, well below what a sonar tells apart; reports,
/// pictures and the command time-out are whole multiples of it.
const STEP: Duration = Duration::from_millis(5);
/// Ten points a second draw a smooth path.
const PATH_PERIOD: Duration = Duration::from_millis(100);
/// More than a serial line at 115,200 baud brings in one step; what is left comes in the next.
const RECEIVE_BUFFER_LENGTH: usize = 256;

/// One run of one world.
pub struct Simulation {
    world: WorldSpecification,
    seed: u64,
    arena: Arena,
    physics: Physics,
    drive: Drive,
    board: MotionBoard,
    faults: Faults,
    sonar_noise: Pcg64,
    camera_noise: Pcg64,
    pictures: u32,
    board_line: Line,
    camera_line: Line,
    record: DriveRecord,
    /// Where the target stands, or the middle of its sway.
    target_place: Position,
    now: Duration,
}

impl Simulation {
    /// The run of this world with this seed, at time zero.
    ///
    /// # Errors
    /// When no arena can be drawn in which the robot can get to its target.
    pub fn new(world: &WorldSpecification, seed: u64) -> Result<Self, SimulationError> {
        let arena = Arena::draw(world, seed)?;
        let mut simulation = Self {
            seed,
            physics: Physics::new(&arena, &world.robot, STEP.as_secs_f64()),
            drive: Drive::new(world.robot),
            board: MotionBoard::new(world.robot.encoder_ticks_per_revolution),
            faults: Faults::default(),
            sonar_noise: stream(seed, Purpose::SonarNoise),
            camera_noise: stream(seed, Purpose::CameraNoise),
            pictures: 0,
            board_line: Line::default(),
            camera_line: Line::default(),
            record: DriveRecord::new(world.robot.start, arena.solids.len()),
            target_place: arena.target,
            now: Duration::ZERO,
            world: world.clone(),
            arena,
        };
        // The board measures all round before its first report.
        for sonar in 0..simulation.world.sonars.len() {
            simulation.fire_sonar(sonar);
        }
        simulation.remember();
        Ok(simulation)
    }

    /// Time between two steps of the world.
    pub fn step_period(&self) -> Duration {
        STEP
    }

    /// Moves the world on to `now`, in whole steps; a time that has passed already moves nothing.
    pub fn advance_to(&mut self, now: Duration) {
        while self.now + STEP <= now {
            self.step();
        }
    }

    /// How far the world has moved.
    pub fn time(&self) -> Duration {
        self.now
    }

    /// The seed of this run.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The world of this run.
    pub fn world(&self) -> &WorldSpecification {
        &self.world
    }

    /// Everything that stands in the arena of this run.
    pub fn arena(&self) -> &Arena {
        &self.arena
    }

    /// Where the robot is.
    pub fn pose(&self) -> Pose {
        self.physics.pose()
    }

    /// How fast the wheels of one side turn, whatever their encoder says.
    pub fn wheel_rpm(&self, side: Side) -> f64 {
        self.drive.rpm(side)
    }

    /// How the drive went so far.
    pub fn summary(&self) -> RobotSummary {
        self.record.summary()
    }

    /// Makes a fault appear.
    pub fn set_fault(&mut self, fault: Fault) {
        self.faults.set(fault);
    }

    /// Repairs a fault; the density of smoke does not matter here.
    pub fn clear_fault(&mut self, fault: Fault) {
        self.faults.clear(fault);
    }

    /// Repairs all faults.
    pub fn clear_faults(&mut self) {
        self.faults = Faults::default();
    }

    /// Opens the line to [`MOTION_BOARD`] or [`CAMERA`] and returns the component's end, which
    /// never blocks. A device can be opened again; an older in-process end then ends. The camera
    /// has no serial line: it always answers in the process.
    ///
    /// # Errors
    /// `NotFound` when there is no such device or it is unplugged; what the operating system says
    /// when it has no line left.
    pub fn open(&mut self, device: &str, transport: Transport) -> io::Result<OwnedFd> {
        match device {
            CAMERA => self.camera_line.open(Transport::InProcess),
            _ => self.line_mut(device)?.open(transport),
        }
    }

    /// The file of a device that was opened over a pseudo-terminal.
    pub fn slave_path(&self, device: &str) -> Option<&Path> {
        self.line(device)?.slave_path()
    }

    /// Pulls the plug of a device: its line ends and cannot be opened.
    ///
    /// # Errors
    /// `NotFound` when there is no such device.
    pub fn unplug(&mut self, device: &str) -> io::Result<()> {
        self.line_mut(device)?.unplug();
        Ok(())
    }

    /// Puts the plug back; the device can be opened again.
    ///
    /// # Errors
    /// `NotFound` when there is no such device.
    pub fn plug_in(&mut self, device: &str) -> io::Result<()> {
        self.line_mut(device)?.plug_in();
        Ok(())
    }

    /// Frames that a device could not send because nobody emptied its line.
    pub fn dropped_frames(&self, device: &str) -> Option<u64> {
        Some(self.line(device)?.dropped_frames())
    }

    pub(crate) fn record(&self) -> &DriveRecord {
        &self.record
    }

    fn line(&self, device: &str) -> Option<&Line> {
        match device {
            MOTION_BOARD => Some(&self.board_line),
            CAMERA => Some(&self.camera_line),
            _ => None,
        }
    }

    fn line_mut(&mut self, device: &str) -> io::Result<&mut Line> {
        match device {
            MOTION_BOARD => Ok(&mut self.board_line),
            CAMERA => Ok(&mut self.camera_line),
            _ => Err(io::Error::new(
                io::ErrorKind::NotFound,
                format!("no device '{device}'; there are '{MOTION_BOARD}' and '{CAMERA}'"),
            )),
        }
    }

    fn step(&mut self) {
        let mut buffer = [0; RECEIVE_BUFFER_LENGTH];
        self.sway_target();
        self.board
            .receive(self.board_line.receive(&mut buffer), self.now);
        let (left, right) = self.board.side_commands(&self.faults);
        let step_s = STEP.as_secs_f64();
        let force = self
            .drive
            .force(self.physics.velocity(), left, right, step_s);
        self.physics.step(force);
        self.now += STEP;
        self.drive.follow(self.physics.velocity(), step_s);
        self.board.count(&self.drive, &self.faults);
        if self.is_due(REPORT_PERIOD) {
            self.fire_sonar(self.board.next_sonar());
            let report = self.board.report();
            self.board_line.send(&report);
        }
        self.serve_camera();
        self.remember();
    }

    fn sway_target(&mut self) {
        if let Some(sway) = self.world.target.sway {
            let place = sway::place(sway, self.target_place, self.now + STEP);
            self.arena.move_target(place);
            self.physics.move_solid(self.arena.solids.len() - 1, place);
        }
    }

    fn is_due(&self, period: Duration) -> bool {
        self.now.as_nanos().is_multiple_of(period.as_nanos())
    }

    fn fire_sonar(&mut self, index: usize) {
        let pose = self.physics.pose();
        let sonar = self.world.sonars[index];
        let range_m = measure_m(&self.physics, pose, &sonar, &mut self.sonar_noise);
        let answers = self.faults.sonar_answers(index);
        self.board.take_range(index, answers.then_some(range_m));
        if answers && range_m < sonar.range_maximum_m {
            let sensor = compose(pose, sonar.mount);
            self.record
                .take_sensed(along(sensor.position, sensor.heading_rad, range_m));
        }
    }

    fn serve_camera(&mut self) {
        self.camera_line.finish();
        let next_s = f64::from(self.pictures + 1) / self.world.camera.rate_hz;
        if self.now < Duration::from_secs_f64(next_s) {
            return;
        }
        self.pictures += 1;
        if self.camera_line.is_open() {
            let air = Air::new(&self.world, self.faults.smoke_density());
            let picture = camera::take_picture(
                (&self.arena, &self.physics),
                &self.world.camera,
                self.physics.pose(),
                &air,
                self.now,
                &mut self.camera_noise,
            );
            self.camera_line.send(&camera_stream::encode(&picture));
        }
    }

    fn remember(&mut self) {
        let position = self.physics.pose().position;
        self.record.take_position(position);
        self.record.take_distances(
            self.now,
            &self.arena,
            self.physics.distances_m(),
            self.world.target.reach_distance_m,
        );
        if self.is_due(PATH_PERIOD) {
            self.record.mark_path(self.now, position);
        }
    }
}
