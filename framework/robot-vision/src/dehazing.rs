//! Haze removal by the dark channel prior, with the transmission refined by a guided filter.
//!
//! He, Sun, Tang: Single Image Haze Removal Using Dark Channel Prior (2011), Guided Image Filtering
//! (2013). Haze follows `I = J t + A (1 - t)`. In a picture without it nearly every neighbourhood
//! has a pixel that is dark in one colour; how bright the darkest one is in haze tells how much of
//! the light there is airlight.

mod airlight;
mod guided_filter;

use crate::bands::each_row;
use crate::plane::Plane;

/// How haze is removed. Lengths are in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dehazer {
    /// Radius of the neighbourhood that holds something dark.
    pub patch_radius: usize,
    /// Share of the haze that is removed, the paper's omega: a little is left, so that what is far
    /// away looks far away.
    pub strength: f32,
    /// Transmission is not taken to be less: what is left of such a pixel is noise.
    pub transmission_minimum: f32,
    /// Radius of the guided filter.
    pub filter_radius: usize,
    /// The filter's epsilon, for grey values from 0 to 1: edges weaker than this are smoothed.
    pub filter_smoothness: f32,
    /// Cores to work on.
    pub cores: usize,
}

impl Default for Dehazer {
    /// The values of the papers, with radii for pictures of 160 x 120 instead of 600 x 400; one
    /// core.
    fn default() -> Self {
        Self {
            patch_radius: 3,
            strength: 0.95,
            transmission_minimum: 0.1,
            filter_radius: 12,
            filter_smoothness: 0.001,
            cores: 1,
        }
    }
}

impl Dehazer {
    /// Clears a picture. `hazy` and `clear` hold red, green and blue of each pixel, in rows of
    /// `width` pixels; only whole rows that both have are looked at, and what is behind them in
    /// `clear` is left as it is.
    pub fn clear(&self, hazy: &[u8], width: usize, clear: &mut [u8]) {
        let rows = hazy.len().min(clear.len()) / (3 * width).max(1);
        let length = rows * width * 3;
        if length == 0 {
            return;
        }
        let (hazy, clear) = (&hazy[..length], &mut clear[..length]);
        let size = (width, rows);
        let airlight = self.airlight(hazy, size);
        let transmission = self.transmission(hazy, size, airlight);
        self.recover(hazy, airlight, &transmission, clear);
    }

    /// The colour of the haze itself, each channel from 1 to 255.
    fn airlight(&self, hazy: &[u8], size: (usize, usize)) -> [f32; 3] {
        let darkest = |pixel: usize| {
            let channels = &hazy[3 * pixel..3 * pixel + 3];
            f32::from(channels.iter().copied().min().unwrap_or_default())
        };
        let dark_channel =
            Plane::of_pixels(size, self.cores, darkest).minimum(self.patch_radius, self.cores);
        airlight::of(hazy, &dark_channel.values)
    }

    /// Share of the light of each pixel that came through the haze.
    fn transmission(&self, hazy: &[u8], size: (usize, usize), airlight: [f32; 3]) -> Plane {
        let darkest = |pixel: usize| {
            let channels = hazy[3 * pixel..3 * pixel + 3].iter().zip(airlight);
            channels
                .map(|(value, airlight)| f32::from(*value) / airlight)
                .fold(f32::INFINITY, f32::min)
        };
        let mut transmission =
            Plane::of_pixels(size, self.cores, darkest).minimum(self.patch_radius, self.cores);
        each_row(&mut transmission.values, size.0, self.cores, |_row, row| {
            for value in row {
                *value = 1.0 - self.strength * *value;
            }
        });
        let grey = |pixel: usize| {
            let [red, green, blue] = [0, 1, 2].map(|channel| f32::from(hazy[3 * pixel + channel]));
            (0.299 * red + 0.587 * green + 0.114 * blue) / 255.0
        };
        let guide = Plane::of_pixels(size, self.cores, grey);
        guided_filter::filter(self, &guide, &transmission)
    }

    /// Equation (22) of the first paper: `J = (I - A) / max(t, t0) + A`.
    fn recover(&self, hazy: &[u8], airlight: [f32; 3], transmission: &Plane, clear: &mut [u8]) {
        let pixels = hazy.chunks_exact(3).zip(clear.chunks_exact_mut(3));
        for ((hazy, clear), transmission) in pixels.zip(&transmission.values) {
            let transmission = transmission.clamp(self.transmission_minimum, 1.0);
            for channel in 0..3 {
                let airlight = airlight[channel];
                let value = (f32::from(hazy[channel]) - airlight) / transmission + airlight;
                // A conversion of a float ends at the bounds of the integer.
                clear[channel] = value.round() as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests;
