//! The camera: a picture drawn column by column from the solids that its rays meet.

use std::time::Duration;

use rand::Rng;
use rand_pcg::Pcg64;
use robot_interface::camera_stream::Picture;
use system_model::world::{
    CameraSpecification, Colour, Pose, SmokeSpecification, WorldSpecification,
};

use crate::arena::{Arena, Solid, SolidKind};
use crate::geometry::compose;
use crate::physics::{Physics, RayHit};
use crate::smoke::Light;

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
/// Of smoke right before the lens.
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

/// What lies between things and the picture of them.
pub(crate) struct Air<'a> {
    /// Smoke that fills the arena.
    smoke: Option<&'a SmokeSpecification>,
    /// Density of smoke right before the lens, 0 to 1.
    density_at_lens: f64,
}

impl<'a> Air<'a> {
    /// The air of a world, and smoke right before the lens of this density, 0 to 1.
    pub(crate) fn new(world: &'a WorldSpecification, density_at_lens: f64) -> Self {
        Self {
            smoke: world.smoke.as_ref(),
            density_at_lens,
        }
    }
}

/// Takes a picture at `now` from a robot at `robot`.
pub(crate) fn take_picture(
    (arena, physics): (&Arena, &Physics),
    camera: &CameraSpecification,
    robot: Pose,
    air: &Air<'_>,
    now: Duration,
    random: &mut Pcg64,
) -> Picture {
    let lens = compose(robot, camera.mount);
    let view = View::new(camera, arena);
    let mut light = Light::none(usize::from(view.width) * usize::from(view.height));
    let mut hits = Vec::new();
    for column in 0..view.width {
        let angle_rad = view.angle_rad(column);
        let heading_rad = lens.heading_rad + angle_rad;
        physics.all_on_ray(lens.position, heading_rad, RANGE_M, &mut hits);
        view.paint_column(&mut light, column, angle_rad, &hits);
    }
    light.pass(air.smoke, now);
    finish(&mut light.pixels, air.density_at_lens, random);
    Picture {
        width: camera.picture_width,
        height: camera.picture_height,
        time_stamp_ns: u64::try_from(now.as_nanos()).unwrap_or(u64::MAX),
        pixels: light.pixels,
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
    fn paint_column(&self, light: &mut Light, column: u16, angle_rad: f64, hits: &[RayHit]) {
        let horizon = self.height / 2;
        let ceiling_m = self.arena.wall_height_m - self.lens_height_m;
        for row in 0..self.height {
            let off_axis = self.off_axis(row);
            let (colour, depth_m) = match row < horizon {
                true => (CEILING, self.focal_length * ceiling_m.abs() / -off_axis),
                false => {
                    let depth_m = self.focal_length * self.lens_height_m / off_axis;
                    (shade(FLOOR, depth_m), depth_m)
                }
            };
            self.paint(light, column, row, colour, depth_m);
        }
        for hit in hits.iter().rev() {
            let solid = &self.arena.solids[hit.solid];
            let depth_m = hit.distance_m * libm::cos(angle_rad);
            let top = self.row(solid.height_m, depth_m);
            let bottom = self.row(0.0, depth_m);
            for row in top..bottom {
                let colour = match solid.kind {
                    // The target shines by itself, so that its colour does not depend on its place.
                    SolidKind::Target => self.colour_of_target(solid, row, depth_m),
                    SolidKind::Wall | SolidKind::Obstacle => shade(solid.colour, hit.distance_m),
                };
                self.paint(light, column, row, colour, depth_m);
            }
        }
    }

    fn colour_of_target(&self, target: &Solid, row: u16, depth_m: f64) -> Colour {
        let height_m = self.lens_height_m - self.off_axis(row) * depth_m / self.focal_length;
        match self.arena.target_bands {
            Some(bands) if (height_m / bands.height_m).rem_euclid(2.0) >= 1.0 => bands.colour,
            _ => target.colour,
        }
    }

    /// Rows from the axis of the lens down to the middle of a row.
    fn off_axis(&self, row: u16) -> f64 {
        f64::from(row) + 0.5 - f64::from(self.height / 2)
    }

    /// The row in which a point at this height and depth appears.
    fn row(&self, height_m: f64, depth_m: f64) -> u16 {
        let above = self.focal_length * (height_m - self.lens_height_m) / depth_m.max(1e-6);
        let row = f64::from(self.height) / 2.0 - above;
        row.round().clamp(0.0, f64::from(self.height)) as u16
    }

    fn paint(&self, light: &mut Light, column: u16, row: u16, colour: Colour, depth_m: f64) {
        let across = f64::from(column) + 0.5 - f64::from(self.width) / 2.0;
        let away = libm::hypot(across, self.off_axis(row)) / self.focal_length;
        let pixel = usize::from(row) * usize::from(self.width) + usize::from(column);
        light.set(pixel, colour, depth_m * libm::hypot(1.0, away));
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

/// Smoke right before the lens, then the noise of the sensor behind it.
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
