//! A small reactive planner: turn towards the target, away from what the sonars see.

use robot_interface::camera_stream::Picture;
use robot_interface::serial_line::MotionCommand;

const CRUISE_RPM: f64 = 85.0;
const SEARCH_RPM: f64 = 22.0;
/// Echoes nearer than this push the robot aside.
const NEAR_MM: f64 = 500.0;
/// Cycles of 50 ms for which it drives on blindly after the target went out of sight.
const PATIENCE: u32 = 40;
/// Cycles of one turn on the spot, and of the way on after it in vain.
const SEARCH_TURN: u32 = 110;
const SEARCH_STRETCH: u32 = 60;

/// What it remembers.
pub struct Planner {
    /// Where the target is seen: -1 at the right edge of the picture, 1 at the left one.
    bearing: Option<f64>,
    last_side: f64,
    cycles_unseen: u32,
    /// Which way it evades while something is in front; kept until the way is free.
    evasion: Option<f64>,
}

impl Planner {
    pub fn new() -> Self {
        Self {
            bearing: None,
            last_side: 1.0,
            cycles_unseen: PATIENCE,
            evasion: None,
        }
    }

    pub fn plan(&mut self, picture: Option<&Picture>, ranges_mm: [u16; 4]) -> MotionCommand {
        self.look(picture);
        let [front, left, right] = [ranges_mm[0], ranges_mm[1], ranges_mm[2]].map(closeness);
        let blocked = front.max(left).max(right);
        let attraction = match self.bearing {
            Some(bearing) => 50.0 * bearing * (1.0 - blocked),
            None if self.is_searching() => {
                let turn = SEARCH_RPM * self.last_side;
                return MotionCommand::from_wheel_rpm(-turn, turn);
            }
            None => 0.0,
        };
        if front == 0.0 {
            self.evasion = None;
        } else if self.evasion.is_none() {
            self.evasion = Some(if left < right { 1.0 } else { -1.0 });
        }
        let evasion = self.evasion.unwrap_or(0.0);
        let turn = attraction + 100.0 * (right - left) + 120.0 * front * evasion;
        let speed = CRUISE_RPM * (1.0 - 1.6 * front).max(0.0) * (1.0 - 0.5 * blocked);
        MotionCommand::from_wheel_rpm(speed - turn / 2.0, speed + turn / 2.0)
    }

    /// One turn on the spot, then a stretch onwards to see the arena from another place.
    fn is_searching(&self) -> bool {
        self.cycles_unseen
            .checked_sub(PATIENCE)
            .is_some_and(|cycles| cycles % (SEARCH_TURN + SEARCH_STRETCH) < SEARCH_TURN)
    }

    fn look(&mut self, picture: Option<&Picture>) {
        if let Some(picture) = picture {
            self.bearing = find_target(picture);
        }
        match self.bearing {
            Some(bearing) => {
                self.last_side = if bearing >= 0.0 { 1.0 } else { -1.0 };
                self.cycles_unseen = 0;
            }
            None => self.cycles_unseen += 1,
        }
    }
}

/// 0 from [`NEAR_MM`] on, 1 at the sensor.
fn closeness(range_mm: u16) -> f64 {
    ((NEAR_MM - f64::from(range_mm)) / NEAR_MM).max(0.0)
}

/// Mean column of the red pixels.
fn find_target(picture: &Picture) -> Option<f64> {
    let width = usize::from(picture.width);
    let columns: Vec<f64> = picture
        .pixels
        .chunks_exact(3)
        .enumerate()
        .filter(|(_, pixel)| pixel[0] > 150 && pixel[1] < 90 && pixel[2] < 90)
        .map(|(index, _)| (index % width) as f64 + 0.5)
        .collect();
    (columns.len() > 12).then(|| {
        let mean = columns.iter().sum::<f64>() / columns.len() as f64;
        1.0 - 2.0 * mean / width as f64
    })
}
