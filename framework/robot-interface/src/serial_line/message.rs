//! The two messages of the line and their payloads.

/// The motion board has sockets for four ultrasonic sensors.
pub const SONAR_COUNT: usize = 4;

/// What travels in one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Message {
    /// From the main board to the motion board.
    Command(MotionCommand),
    /// From the motion board to the main board.
    Report(BoardReport),
}

/// `motion_type` of table 4.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MotionType {
    /// 0: stand still.
    #[default]
    Stop,
    /// 1: both sides forward.
    Forward,
    /// 2: both sides backward.
    Backward,
    /// 3: turn to the left (counterclockwise).
    TurnLeft,
    /// 4: turn to the right.
    TurnRight,
}

impl MotionType {
    const ALL: [Self; 5] = [
        Self::Stop,
        Self::Forward,
        Self::Backward,
        Self::TurnLeft,
        Self::TurnRight,
    ];

    /// The motion type of this number, if there is one.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }
}

/// What the motors shall do until the next command.
///
/// Table 4 gives every motion one parameter, the rpm of a straight drive or the rpm difference of
/// a turn. An arc needs both, so both travel: a straight drive may carry a difference and a turn
/// may carry a common speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MotionCommand {
    /// Which way.
    pub motion_type: MotionType,
    /// Mean wheel speed in rpm, not negative.
    pub rpm: i16,
    /// Difference between the wheel speeds in rpm. In a straight drive a positive difference bends
    /// the way counterclockwise; in a turn it is positive and the motion type says which way.
    pub rpm_difference: i16,
}

impl MotionCommand {
    pub(super) const PAYLOAD_LENGTH: usize = 5;

    /// Stand still.
    pub fn stop() -> Self {
        Self::default()
    }

    /// The command that comes nearest to these wheel speeds in rpm (forward is positive).
    pub fn from_wheel_rpm(left: f64, right: f64) -> Self {
        let mean = (left + right) / 2.0;
        let difference = (right - left).round() as i16;
        let rpm = mean.abs().round() as i16;
        let motion_type = match (rpm, difference) {
            (0, 0) => MotionType::Stop,
            (0, 1..) => MotionType::TurnLeft,
            (0, _) => MotionType::TurnRight,
            _ if mean > 0.0 => MotionType::Forward,
            _ => MotionType::Backward,
        };
        let rpm_difference = match motion_type {
            MotionType::TurnRight => difference.saturating_neg(),
            _ => difference,
        };
        Self {
            motion_type,
            rpm,
            rpm_difference,
        }
    }

    /// Speeds of the left and the right wheels in rpm (forward is positive).
    pub fn wheel_rpm(self) -> (f64, f64) {
        let rpm = f64::from(self.rpm);
        let half = f64::from(self.rpm_difference) / 2.0;
        match self.motion_type {
            MotionType::Stop => (0.0, 0.0),
            MotionType::Forward | MotionType::TurnLeft => (rpm - half, rpm + half),
            MotionType::Backward => (-rpm - half, -rpm + half),
            MotionType::TurnRight => (rpm + half, rpm - half),
        }
    }

    pub(super) fn to_payload(self) -> [u8; Self::PAYLOAD_LENGTH] {
        let [rpm_low, rpm_high] = self.rpm.to_le_bytes();
        let [difference_low, difference_high] = self.rpm_difference.to_le_bytes();
        [
            self.motion_type as u8,
            rpm_low,
            rpm_high,
            difference_low,
            difference_high,
        ]
    }

    pub(super) fn from_payload(payload: &[u8]) -> Option<Self> {
        let &[
            motion_type,
            rpm_low,
            rpm_high,
            difference_low,
            difference_high,
        ] = payload
        else {
            return None;
        };
        Some(Self {
            motion_type: MotionType::from_code(motion_type)?,
            rpm: i16::from_le_bytes([rpm_low, rpm_high]),
            rpm_difference: i16::from_le_bytes([difference_low, difference_high]),
        })
    }
}

/// What the motion board knows, sent at a steady rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BoardReport {
    /// Counts the reports; wraps.
    pub sequence: u16,
    /// The board stopped the motors by itself because no command arrived in time.
    pub stopped_by_time_out: bool,
    /// Cumulative encoder ticks of the left wheels, forward is up; wraps.
    pub left_encoder_ticks: i32,
    /// Cumulative encoder ticks of the right wheels, forward is up; wraps.
    pub right_encoder_ticks: i32,
    /// Ranges of the ultrasonic sensors in mm; 0 means that the sensor does not answer.
    pub ranges_mm: [u16; SONAR_COUNT],
}

impl BoardReport {
    pub(super) const PAYLOAD_LENGTH: usize = 11 + 2 * SONAR_COUNT;
    const STOPPED_BY_TIME_OUT: u8 = 1;

    pub(super) fn to_payload(self) -> [u8; Self::PAYLOAD_LENGTH] {
        let mut payload = [0; Self::PAYLOAD_LENGTH];
        payload[0..2].copy_from_slice(&self.sequence.to_le_bytes());
        payload[2] = u8::from(self.stopped_by_time_out) * Self::STOPPED_BY_TIME_OUT;
        payload[3..7].copy_from_slice(&self.left_encoder_ticks.to_le_bytes());
        payload[7..11].copy_from_slice(&self.right_encoder_ticks.to_le_bytes());
        for (bytes, range_mm) in payload[11..].chunks_exact_mut(2).zip(self.ranges_mm) {
            bytes.copy_from_slice(&range_mm.to_le_bytes());
        }
        payload
    }

    pub(super) fn from_payload(payload: &[u8]) -> Option<Self> {
        let (sequence, rest) = payload.split_first_chunk()?;
        let (flags, rest) = rest.split_first()?;
        let (left, rest) = rest.split_first_chunk()?;
        let (right, ranges) = rest.split_first_chunk()?;
        if ranges.len() != 2 * SONAR_COUNT {
            return None;
        }
        let mut ranges_mm = [0; SONAR_COUNT];
        for (range_mm, bytes) in ranges_mm.iter_mut().zip(ranges.chunks_exact(2)) {
            *range_mm = u16::from_le_bytes([bytes[0], bytes[1]]);
        }
        Some(Self {
            sequence: u16::from_le_bytes(*sequence),
            stopped_by_time_out: flags & Self::STOPPED_BY_TIME_OUT != 0,
            left_encoder_ticks: i32::from_le_bytes(*left),
            right_encoder_ticks: i32::from_le_bytes(*right),
            ranges_mm,
        })
    }
}
