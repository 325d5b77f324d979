//! Drives as a monitor sees them: motor commands and wheel speeds, sample by sample.

use std::io;
use std::time::Duration;

use fault_manager::detection::process_model::InputMap;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use robot_simulation::{CommandedDrive, CyclePhases, EncoderCounts, Fault, Side, WheelCommand};
use system_model::data_type::{DataType, Field, Scalar};
use system_model::process_model::ProcessModel;
use system_model::world::{Pose, Position, TargetPlace, WorldSpecification};

use super::driving::{Driver, METRES_PER_TICK};

/// A hall whose walls are never met: what holds the wheels is no false alarm.
const HALL_M: f64 = 100.0;
/// The world's step; phases are whole multiples of it.
const PHASE_STEP_MS: u64 = 5;
/// The wheel encoders smooth over 60 ms, so one sample of 20 ms counts a quarter.
const SMOOTHING_SHARE: f64 = 0.25;

/// One sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sample {
    /// Inputs of the model: what the left and the right wheels are told.
    pub(super) inputs: [f32; 2],
    /// What the wheel encoders publish: left and right.
    pub(super) speeds_m_per_s: [f32; 2],
}

/// A drive with a fault.
#[derive(Debug)]
pub(super) struct FaultyDrive {
    pub(super) samples: Vec<Sample>,
    /// Index of the first sample after the fault.
    pub(super) fault: usize,
    /// Samples from the fault to the first that differs from the same drive without it, itself
    /// included; none if it never does.
    pub(super) first_evidence: Option<usize>,
    /// Ticks by which the two differ after each sample from the fault on.
    pub(super) missing_ticks: Vec<i32>,
}

/// Makes drives.
pub(super) struct Recorder {
    inputs: InputMap,
    in_step: bool,
    world: WorldSpecification,
}

impl Recorder {
    /// # Errors
    /// When the model does not go from motor commands to two wheel speeds.
    pub(super) fn new(model: &ProcessModel, in_step: bool) -> io::Result<Self> {
        let unfit = |reason: String| io::Error::new(io::ErrorKind::InvalidInput, reason);
        let inputs = InputMap::compile(&model.inputs, &motor_command()).map_err(|errors| {
            let errors = errors.iter().map(ToString::to_string);
            unfit(errors.collect::<Vec<_>>().join("; "))
        })?;
        if (inputs.inputs(), model.state_space.c.rows) != (2, 2) {
            return Err(unfit(
                "the model must have two inputs, made of a motor command by its <inputs>, and two \
                 outputs, the speeds of the left and the right wheels"
                    .into(),
            ));
        }
        let mut world = WorldSpecification {
            random_obstacles: None,
            ..WorldSpecification::default()
        };
        world.arena.length_m = HALL_M;
        world.arena.width_m = HALL_M;
        let centre = HALL_M / 2.0;
        world.robot.start = Pose {
            position: Position {
                x_m: centre,
                y_m: centre,
            },
            heading_rad: 0.0,
        };
        world.target.place = TargetPlace::Fixed(Position {
            x_m: HALL_M - 2.0,
            y_m: HALL_M - 2.0,
        });
        Ok(Self {
            inputs,
            in_step,
            world,
        })
    }

    /// A drive without a fault.
    ///
    /// # Errors
    /// When the simulation does not run.
    pub(super) fn sane(&self, seed: u64, samples: usize) -> io::Result<Vec<Sample>> {
        Ok(self.drive(seed, samples, None)?.0)
    }

    /// A drive whose left motor driver loses power, at a random time at which the left wheels are
    /// asked to turn; it goes on for `after` samples.
    ///
    /// # Errors
    /// When the simulation does not run.
    pub(super) fn faulty(&self, seed: u64, after: usize) -> io::Result<FaultyDrive> {
        const EARLIEST: usize = 250;
        const LATEST: usize = 1250;
        let (sane, sane_counts) = self.drive(seed, LATEST + after, None)?;
        let wanted = random(seed, 2).random_range(EARLIEST..LATEST);
        let is_turning = |index: &usize| f64::from(sane[*index - 1].inputs[0]).abs() > 0.0;
        let later = (wanted..LATEST).find(is_turning);
        let fault = later
            .or_else(|| (EARLIEST..wanted).rev().find(is_turning))
            .unwrap_or(wanted);
        let (samples, counts) = self.drive(seed, fault + after, Some(fault))?;
        let pairs = sane_counts[fault..].iter().zip(&counts[fault..]);
        let missing = |(sane, faulty): (&EncoderCounts, &EncoderCounts)| {
            let left = sane.left.wrapping_sub(faulty.left).abs();
            left.max(sane.right.wrapping_sub(faulty.right).abs())
        };
        let missing_ticks: Vec<i32> = pairs.map(missing).collect();
        let first = missing_ticks.iter().position(|ticks| *ticks > 0);
        Ok(FaultyDrive {
            samples,
            fault,
            first_evidence: first.map(|first| first + 1),
            missing_ticks,
        })
    }

    fn drive(
        &self,
        seed: u64,
        samples: usize,
        fault: Option<usize>,
    ) -> io::Result<(Vec<Sample>, Vec<EncoderCounts>)> {
        let mut drive = CommandedDrive::new(&self.world, seed, self.phases(seed))?;
        let mut driver = Driver::new(seed);
        let mut command = WheelCommand::default();
        let mut last = EncoderCounts::default();
        let mut speeds_m_per_s = [0.0; 2];
        let (mut series, mut all_counts) = (Vec::new(), Vec::new());
        for index in 0..samples {
            if fault == Some(index) {
                let off = Fault::MotorDriverOff(Side::Left);
                drive.simulation_mut().set_fault(off);
            }
            let counts = drive.cycle(command)?.unwrap_or(last);
            let ticks = [(counts.left, last.left), (counts.right, last.right)];
            for (speed, (now, before)) in speeds_m_per_s.iter_mut().zip(ticks) {
                let way_m = f64::from(now.wrapping_sub(before)) * METRES_PER_TICK;
                *speed += SMOOTHING_SHARE * (way_m / CommandedDrive::CYCLE.as_secs_f64() - *speed);
            }
            last = counts;
            command = driver.command(counts);
            let mut inputs = [0.0; 2];
            self.inputs.read(&datum(command), &mut inputs);
            series.push(Sample {
                inputs: inputs.map(|input| input as f32),
                speeds_m_per_s: speeds_m_per_s.map(|speed| speed as f32),
            });
            all_counts.push(counts);
        }
        Ok((series, all_counts))
    }

    fn phases(&self, seed: u64) -> CyclePhases {
        if self.in_step {
            return CyclePhases::default();
        }
        let steps = CommandedDrive::CYCLE.as_millis() as u64 / PHASE_STEP_MS;
        let mut random = random(seed, 1);
        CyclePhases {
            report_age: Duration::from_millis(PHASE_STEP_MS * random.random_range(0..steps)),
            command_latency: Duration::from_millis(PHASE_STEP_MS * random.random_range(0..=steps)),
        }
    }
}

fn random(seed: u64, purpose: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed.wrapping_mul(4).wrapping_add(purpose))
}

/// The data type of the motor driver's port `command`.
fn motor_command() -> DataType {
    let field = |path: &str, unit: &str, offset, scalar| Field {
        path: path.into(),
        unit: unit.into(),
        offset,
        scalar,
        count: 1,
    };
    DataType {
        name: "MotorCommand".into(),
        size: 24,
        layout_hash: 0,
        fields: vec![
            field("time", "ns", 0, Scalar::U64),
            field("motion_type", "", 8, Scalar::U32),
            field("rpm", "rpm", 12, Scalar::I32),
            field("rpm_difference", "rpm", 16, Scalar::I32),
        ],
    }
}

fn datum(command: WheelCommand) -> [u8; 24] {
    let mut bytes = [0; 24];
    bytes[8..12].copy_from_slice(&command.motion_type().to_ne_bytes());
    bytes[12..16].copy_from_slice(&command.rpm().to_ne_bytes());
    bytes[16..20].copy_from_slice(&command.rpm_difference().to_ne_bytes());
    bytes
}
