//! The world a simulated robot drives in: arena, obstacles, target, robot and its sensors.
//!
//! Plain data in SI units and radians. Coordinates are those of the arena: the origin is its lower
//! left inner corner, x runs along its length, y along its width, headings turn counterclockwise
//! from the x axis. Mount poses are relative to the centre of the robot, x forward, y to the left.

/// One world: what stands in it and what drives in it.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldSpecification {
    /// The world's name.
    pub name: String,
    /// The rectangle inside the four outer walls.
    pub arena: ArenaSpecification,
    /// Walls inside the arena.
    pub walls: Vec<WallSpecification>,
    /// Obstacles whose places are given.
    pub obstacles: Vec<ObstacleSpecification>,
    /// Obstacles placed at random from the seed of a run.
    pub random_obstacles: Option<RandomObstacleSpecification>,
    /// What the robot looks for.
    pub target: TargetSpecification,
    /// Smoke that blows in during a run.
    pub smoke: Option<SmokeSpecification>,
    /// The robot.
    pub robot: RobotSpecification,
    /// The ultrasonic sensors in the order in which the motion board reports them.
    pub sonars: [SonarSpecification; SONAR_COUNT],
    /// The camera.
    pub camera: CameraSpecification,
}

/// The motion board of the reference robot has sockets for four ultrasonic sensors.
pub const SONAR_COUNT: usize = 4;

/// A point of the arena.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Position {
    /// Along the length of the arena.
    pub x_m: f64,
    /// Along the width of the arena.
    pub y_m: f64,
}

/// A point and a direction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Where.
    pub position: Position,
    /// Counterclockwise from the x axis.
    pub heading_rad: f64,
}

/// A colour, 0 to 255 a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour {
    /// Red.
    pub red: u8,
    /// Green.
    pub green: u8,
    /// Blue.
    pub blue: u8,
}

/// The rectangle inside the four outer walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArenaSpecification {
    /// Size along x.
    pub length_m: f64,
    /// Size along y.
    pub width_m: f64,
    /// Height of all walls, as the camera sees them.
    pub wall_height_m: f64,
    /// Colour of all walls.
    pub wall_colour: Colour,
}

/// A straight wall inside the arena.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallSpecification {
    /// One end of its centre line.
    pub from: Position,
    /// The other end.
    pub to: Position,
    /// Thickness.
    pub thickness_m: f64,
}

/// An obstacle whose place is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObstacleSpecification {
    /// Its centre.
    pub centre: Position,
    /// Its outline.
    pub shape: ObstacleShape,
    /// Height, as the camera sees it.
    pub height_m: f64,
    /// Colour.
    pub colour: Colour,
}

/// Outline of an obstacle seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ObstacleShape {
    /// A cylinder.
    Circle {
        /// Radius.
        radius_m: f64,
    },
    /// A box.
    Box {
        /// Size along its own x axis.
        length_m: f64,
        /// Size along its own y axis.
        width_m: f64,
        /// Direction of its own x axis.
        heading_rad: f64,
    },
}

/// Cylinders placed at random from the seed of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomObstacleSpecification {
    /// Fewest.
    pub count_minimum: usize,
    /// Most.
    pub count_maximum: usize,
    /// Smallest radius.
    pub radius_minimum_m: f64,
    /// Largest radius.
    pub radius_maximum_m: f64,
    /// Free floor between the centre of the robot at its start and the nearest outline.
    pub keep_out_robot_m: f64,
    /// Free floor between the centre of the target and the nearest outline.
    pub keep_out_target_m: f64,
    /// Free floor between any two outlines, and between an outline and a wall; also the least
    /// width of the way to the target.
    pub gap_m: f64,
    /// Height, as the camera sees them.
    pub height_m: f64,
    /// Colour.
    pub colour: Colour,
}

/// What the robot looks for: a coloured cylinder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetSpecification {
    /// Where it stands.
    pub place: TargetPlace,
    /// Radius.
    pub radius_m: f64,
    /// Height, as the camera sees it.
    pub height_m: f64,
    /// Colour, better saturated: everything else is dull.
    pub colour: Colour,
    /// Level bands of a second colour.
    pub bands: Option<BandSpecification>,
    /// How it moves, if it does.
    pub sway: Option<SwaySpecification>,
    /// The target is reached when the gap between the outlines of robot and target is at most this.
    pub reach_distance_m: f64,
}

/// Level bands around the target, which look the same from all sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandSpecification {
    /// Height of each band and of each gap between two; the lowest stretch has the target's colour.
    pub height_m: f64,
    /// Colour of the bands.
    pub colour: Colour,
}

/// A target that sways to and fro along y around its place, as a sine of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwaySpecification {
    /// Farthest from its place.
    pub amplitude_m: f64,
    /// Time to and fro.
    pub period_s: f64,
}

/// Smoke that fills the arena evenly: the standard model of a scattering atmosphere, `I = J t +
/// A (1 - t)` with `t = exp(-beta d)`, for what a camera sees at the distance `d`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmokeSpecification {
    /// Time of the run from which it is there.
    pub begins_s: f64,
    /// Scattering coefficient beta.
    pub scattering_per_m: f64,
    /// The light that the smoke itself scatters into the lens, A.
    pub airlight: Colour,
}

/// Where the target stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TargetPlace {
    /// At this point.
    Fixed(Position),
    /// Anywhere in this rectangle, drawn from the seed of a run.
    Region {
        /// Lower left corner.
        lowest: Position,
        /// Upper right corner.
        highest: Position,
    },
}

/// A robot with four wheels, driven in pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotSpecification {
    /// Where it starts.
    pub start: Pose,
    /// Size along its own x axis.
    pub length_m: f64,
    /// Size along its own y axis, wheels included.
    pub width_m: f64,
    /// Mass.
    pub mass_kg: f64,
    /// Radius of each wheel.
    pub wheel_radius_m: f64,
    /// Distance between the left and the right wheels.
    pub track_m: f64,
    /// Fastest turn of a wheel.
    pub wheel_maximum_rpm: f64,
    /// Time in which a wheel covers 63 % of a step of its commanded speed.
    pub motor_time_constant_s: f64,
    /// Encoder ticks for one turn of a wheel.
    pub encoder_ticks_per_revolution: u32,
}

/// An ultrasonic sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SonarSpecification {
    /// Where on the robot, and which way it looks.
    pub mount: Pose,
    /// Full opening angle of its cone.
    pub cone_angle_rad: f64,
    /// Nearer things read as this.
    pub range_minimum_m: f64,
    /// Farther things read as this.
    pub range_maximum_m: f64,
    /// Standard deviation of a range.
    pub noise_sigma_m: f64,
}

/// A camera on the robot that looks level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraSpecification {
    /// Where on the robot, and which way it looks.
    pub mount: Pose,
    /// Height of the lens over the floor.
    pub height_m: f64,
    /// Horizontal field of view; pixels are square.
    pub field_of_view_rad: f64,
    /// Width of a picture in pixels.
    pub picture_width: u16,
    /// Height of a picture in pixels.
    pub picture_height: u16,
    /// Pictures a second.
    pub rate_hz: f64,
}

impl Default for WorldSpecification {
    /// The arena of the reference scenario: the robot looks for a red cylinder among five to seven
    /// round obstacles in a room of 6 m by 4 m.
    fn default() -> Self {
        Self {
            name: "target_arena".to_owned(),
            arena: ArenaSpecification {
                length_m: 6.0,
                width_m: 4.0,
                wall_height_m: 1.0,
                wall_colour: Colour {
                    red: 150,
                    green: 150,
                    blue: 142,
                },
            },
            walls: Vec::new(),
            obstacles: Vec::new(),
            random_obstacles: Some(RandomObstacleSpecification::default()),
            target: TargetSpecification::default(),
            smoke: None,
            robot: RobotSpecification::default(),
            sonars: SonarSpecification::reference_ring(),
            camera: CameraSpecification::default(),
        }
    }
}

impl Default for RandomObstacleSpecification {
    fn default() -> Self {
        Self {
            count_minimum: 5,
            count_maximum: 7,
            radius_minimum_m: 0.12,
            radius_maximum_m: 0.22,
            keep_out_robot_m: 0.6,
            keep_out_target_m: 0.7,
            // Three and a half times the width of the robot: a way that sonars can find.
            gap_m: 0.5,
            height_m: 0.5,
            colour: Colour {
                red: 118,
                green: 104,
                blue: 84,
            },
        }
    }
}

impl Default for TargetSpecification {
    fn default() -> Self {
        Self {
            place: TargetPlace::Region {
                lowest: Position { x_m: 4.7, y_m: 0.8 },
                highest: Position { x_m: 5.3, y_m: 3.2 },
            },
            radius_m: 0.12,
            height_m: 0.5,
            colour: Colour {
                red: 225,
                green: 30,
                blue: 35,
            },
            bands: None,
            sway: None,
            reach_distance_m: 0.25,
        }
    }
}

impl Default for RobotSpecification {
    /// The robot of Ahn et al. (2012), table 3: 1.3 kg, 210 mm by 140 mm.
    fn default() -> Self {
        Self {
            start: Pose {
                position: Position { x_m: 0.6, y_m: 2.0 },
                heading_rad: 0.0,
            },
            length_m: 0.210,
            width_m: 0.140,
            mass_kg: 1.3,
            wheel_radius_m: 0.0325,
            track_m: 0.120,
            // 0.34 m/s at the rim of a 65 mm wheel.
            wheel_maximum_rpm: 100.0,
            motor_time_constant_s: 0.12,
            encoder_ticks_per_revolution: 360,
        }
    }
}

impl SonarSpecification {
    /// The four sensors of the reference robot: front, left front, right front, rear.
    pub fn reference_ring() -> [Self; SONAR_COUNT] {
        [
            (0.105, 0.0, 0.0_f64),
            (0.095, 0.060, 40.0),
            (0.095, -0.060, -40.0),
            (-0.105, 0.0, 180.0),
        ]
        .map(|(x_m, y_m, heading_deg)| Self {
            mount: Pose {
                position: Position { x_m, y_m },
                heading_rad: heading_deg.to_radians(),
            },
            cone_angle_rad: 30.0_f64.to_radians(),
            range_minimum_m: 0.03,
            range_maximum_m: 3.0,
            noise_sigma_m: 0.005,
        })
    }
}

impl Default for CameraSpecification {
    fn default() -> Self {
        Self {
            mount: Pose {
                position: Position {
                    x_m: 0.09,
                    y_m: 0.0,
                },
                heading_rad: 0.0,
            },
            height_m: 0.30,
            field_of_view_rad: 65.0_f64.to_radians(),
            picture_width: 160,
            picture_height: 120,
            rate_hz: 10.0,
        }
    }
}
