//! The guided filter: smooths a plane, but keeps the edges of a guide.

use super::Dehazer;
use crate::plane::Plane;

/// In each window the result is a linear function of the guide, `q = a I + b` (algorithm 1 of the
/// second paper); near an edge of the guide `a` is large, elsewhere the plane's mean is left.
pub(super) fn filter(dehazer: &Dehazer, guide: &Plane, plane: &Plane) -> Plane {
    let (radius, cores) = (dehazer.filter_radius, dehazer.cores);
    let mean = |plane: &Plane| plane.mean(radius, cores);
    let product = |one: &Plane, other: &Plane| one.with(other, cores, |one, other| one * other);
    let (mean_guide, mean_plane) = (mean(guide), mean(plane));
    let variance = mean(&product(guide, guide)).with(&mean_guide, cores, |square, mean| {
        // Rounding must not make it negative.
        (square - mean * mean).max(0.0)
    });
    let covariance =
        mean(&product(guide, plane)).with(&product(&mean_guide, &mean_plane), cores, |a, b| a - b);
    let slope = covariance.with(&variance, cores, |covariance, variance| {
        covariance / (variance + dehazer.filter_smoothness)
    });
    let offset = mean_plane.with(&product(&slope, &mean_guide), cores, |a, b| a - b);
    product(&mean(&slope), guide).with(&mean(&offset), cores, |a, b| a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_the_guide_are_kept_and_noise_is_smoothed() {
        let size = (40, 20);
        let is_right = |pixel: usize| pixel % 40 >= 20;
        let guide = Plane::of_pixels(size, 1, |pixel| f32::from(u8::from(is_right(pixel))));
        let noisy = Plane::of_pixels(size, 1, |pixel| {
            let side = if is_right(pixel) { 0.8 } else { 0.2 };
            side + if pixel % 2 == 0 { 0.1 } else { -0.1 }
        });
        let smooth = filter(&Dehazer::default(), &guide, &noisy);
        for (pixel, value) in smooth.values.iter().enumerate() {
            let expected = if is_right(pixel) { 0.8 } else { 0.2 };
            assert!((value - expected).abs() < 0.03, "{pixel}: {value}");
        }
    }
}
