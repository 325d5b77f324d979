//! Smoke between the camera and what it looks at.

use std::time::Duration;

use system_model::world::{Colour, SmokeSpecification};

/// The light that arrives at the lens: for each pixel what is there, and how far the light came.
pub(crate) struct Light {
    /// Red, green and blue of each pixel.
    pub(crate) pixels: Vec<u8>,
    /// Length in m of the line of sight of each pixel.
    pub(crate) distances_m: Vec<f64>,
}

impl Light {
    /// Darkness.
    pub(crate) fn none(pixels: usize) -> Self {
        Self {
            pixels: vec![0; pixels * 3],
            distances_m: vec![0.0; pixels],
        }
    }

    pub(crate) fn set(&mut self, pixel: usize, colour: Colour, distance_m: f64) {
        let channels = [colour.red, colour.green, colour.blue];
        self.pixels[pixel * 3..pixel * 3 + 3].copy_from_slice(&channels);
        self.distances_m[pixel] = distance_m;
    }

    /// Lets the light pass through smoke, once that is there: `I = J t + A (1 - t)` with
    /// `t = exp(-beta d)`.
    pub(crate) fn pass(&mut self, smoke: Option<&SmokeSpecification>, now: Duration) {
        let Some(smoke) = smoke.filter(|smoke| now.as_secs_f64() >= smoke.begins_s) else {
            return;
        };
        let airlight = [
            smoke.airlight.red,
            smoke.airlight.green,
            smoke.airlight.blue,
        ];
        for (pixel, distance_m) in self.pixels.chunks_exact_mut(3).zip(&self.distances_m) {
            let transmission = libm::exp(-smoke.scattering_per_m * distance_m);
            for (value, airlight) in pixel.iter_mut().zip(airlight) {
                let scattered = f64::from(airlight) * (1.0 - transmission);
                *value = libm::round(f64::from(*value) * transmission + scattered) as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_far_fades_into_the_airlight_from_the_time_on_at_which_smoke_begins() {
        let grey = |value| Colour {
            red: value,
            green: value,
            blue: value,
        };
        let smoke = SmokeSpecification {
            begins_s: 4.4,
            scattering_per_m: 0.5,
            airlight: grey(200),
        };
        // Black, 2 m away: t = 1/e, so 200 (1 - 0.368) = 126 is seen of it.
        let cases = [
            (4.3, 2.0, 0, 0),
            (4.4, 2.0, 0, 126),
            (9.0, 0.0, 0, 0),
            (9.0, 1000.0, 0, 200),
            (9.0, 2.0, 200, 200),
            (9.0, 2.0, 255, 220),
        ];
        for (now_s, distance_m, there, seen) in cases {
            let mut light = Light::none(1);
            light.set(0, grey(there), distance_m);
            light.pass(Some(&smoke), Duration::from_secs_f64(now_s));
            assert_eq!(
                light.pixels, [seen; 3],
                "{now_s} s, {distance_m} m, {there}"
            );
        }
        let mut light = Light::none(1);
        light.pass(None, Duration::MAX);
        assert_eq!(light.pixels, [0; 3]);
    }
}
