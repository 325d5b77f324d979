//! The camera: a picture drawn column by column from the solids that its rays meet.

use std::time::Duration;

use rand::Rng;
use rand_pcg::Pcg64;
use robot_interface::camera_stream::Picture;
use system_model::world::{CameraSpecification, Colour, Pose};

use crate::arena::{Arena, SolidKind};
use crate::geometry::compose;
use crate::physics::{Physics, RayHit};

const FLOOR: Colour = Colour {
    red: 92,
    green: 94,
    blue: 98,
};
const CEILING: Colour = Colour {
    red: 176,
    green: 180,
    blue: 184,
};
const SMOKE: Colour = Colour {
    red: 128,
    green: 128,
    blue: 128,
};
/// Distance at which a thing is seen half as bright as at the lens.
const HALF_BRIGHT_M: f64 = 9.0;
/// Farther than any arena is long.
const RANGE_M: f64 = 1000.0;
/// Largest brightness noise of a pixel, of 255.
const NOISE_MAXIMUM: i16 = 6;

/// Takes a picture from a robot at `robot`.
pub(crate) fn take_picture(
    arena: &Arena,
    physics: &Physics,
    camera: &CameraSpecification,
    robot: Pose,
    smoke_density: f64,
    random: &mut Pcg64,
) -> Vec<u8> {
    let lens = compose(robot, camera.mount);
    let view = View::new(camera, arena);
    let mut pixels = vec![0; usize::from(view.width) * usize::from(view.height) * 3];
    let mut hits = Vec::new();
    for column in 0..view.width {
        let angle_rad = view.angle_rad(column);
        let heading_rad = lens.heading_rad + angle_rad;
        physics.all_on_ray(lens.position, heading_rad, RANGE_M, &mut hits);
        view.paint_column(&mut pixels, column, angle_rad, &hits);
    }
    finish(&mut pixels, smoke_density, random);
    pixels
}

/// Frames the pixels as a picture.
pub(crate) fn picture(camera: &CameraSpecification, now: Duration, pixels: Vec<u8>) -> Picture {
    Picture {
        width: camera.picture_width,
        height: camera.picture_height,
        time_stamp_ns: u64::try_from(now.as_nanos()).unwrap_or(u64::MAX),
        pixels,
    }
}

/// The pinhole of the camera.
struct View<'a> {
    arena: &'a Arena,
    width: u16,
    height: u16,
    lens_height_m: f64,
    /// Pixels by which a thing as wide as it is far appears.
    focal_length: f64,
}

impl<'a> View<'a> {
    fn new(camera: &CameraSpecification, arena: &'a Arena) -> Self {
        let width = f64::from(camera.picture_width);
        Self {
            arena,
            width: camera.picture_width,
            height: camera.picture_height,
            lens_height_m: camera.height_m,
            focal_length: width / 2.0 / libm::tan(camera.field_of_view_rad / 2.0),
        }
    }

    /// Direction of the middle of a column, counterclockwise from the axis of the lens.
    fn angle_rad(&self, column: u16) -> f64 {
        let right = f64::from(column) + 0.5 - f64::from(self.width) / 2.0;
        -libm::atan(right / self.focal_length)
    }

    /// Background first, then the solids from far to near.
    fn paint_column(&self, pixels: &mut [u8], column: u16, angle_rad: f64, hits: &[RayHit]) {
        let horizon = self.height / 2;
        self.fill(pixels, column, 0..horizon, CEILING);
        for row in horizon..self.height {
            let below = f64::from(row - horizon) + 0.5;
            let depth_m = self.focal_length * self.lens_height_m / below;
            self.fill(pixels, column, row..row + 1, shade(FLOOR, depth_m));
        }
        for hit in hits.iter().rev() {
            let solid = &self.arena.solids[hit.solid];
            let depth_m = hit.distance_m * libm::cos(angle_rad);
            let top = self.row(solid.height_m, depth_m);
            let bottom = self.row(0.0, depth_m);
            let colour = match solid.kind {
                // The target shines by itself, so that its colour does not depend on its place.
                SolidKind::Target => solid.colour,
                SolidKind::Wall | SolidKind::Obstacle => shade(solid.colour, hit.distance_m),
            };
            self.fill(pixels, column, top..bottom, colour);
        }
    }

    /// The row in which a point at this height and depth appears.
    fn row(&self, height_m: f64, depth_m: f64) -> u16 {
        let above = self.focal_length * (height_m - self.lens_height_m) / depth_m.max(1e-6);
        let row = f64::from(self.height) / 2.0 - above;
        row.round().clamp(0.0, f64::from(self.height)) as u16
    }

    fn fill(&self, pixels: &mut [u8], column: u16, rows: std::ops::Range<u16>, colour: Colour) {
        for row in rows {
            let at = (usize::from(row) * usize::from(self.width) + usize::from(column)) * 3;
            pixels[at..at + 3].copy_from_slice(&[colour.red, colour.green, colour.blue]);
        }
    }
}

fn shade(colour: Colour, distance_m: f64) -> Colour {
    let brightness = HALF_BRIGHT_M / (HALF_BRIGHT_M + distance_m);
    let channel = |value: u8| (f64::from(value) * brightness) as u8;
    Colour {
        red: channel(colour.red),
        green: channel(colour.green),
        blue: channel(colour.blue),
    }
}

/// Smoke in front of the lens, then the noise of the sensor behind it.
fn finish(pixels: &mut [u8], smoke_density: f64, random: &mut Pcg64) {
    let smoke = [SMOKE.red, SMOKE.green, SMOKE.blue];
    for pixel in pixels.chunks_exact_mut(3) {
        let noise = (random.next_u32() % (2 * NOISE_MAXIMUM as u32 + 1)) as i16 - NOISE_MAXIMUM;
        for (value, smoke) in pixel.iter_mut().zip(smoke) {
            let clear = f64::from(*value);
            let seen = clear + (f64::from(smoke) - clear) * smoke_density;
            *value = (seen as i16 + noise).clamp(0, 255) as u8;
        }
    }
}
