//! The widest stretch of columns with pixels of the target's colour.

use std::ops::Range;

use robot_interface::port_data::{DetectedObject, Image};

/// Single pixels of the right colour are noise.
const COLUMN_PIXELS_MINIMUM: u32 = 2;
/// The target at the far wall of the arena has some 60 pixels; a fifth of it is still worth a look.
const OBJECT_PIXELS_MINIMUM: u32 = 12;

/// What to look for, and with which camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detector {
    /// Red, green and blue of the target.
    pub colour: [u8; 3],
    /// Largest difference in each channel.
    pub tolerance: u8,
    /// Horizontal field of view of the camera.
    pub field_of_view_rad: f64,
    /// Diameter of the target.
    pub object_diameter_m: f64,
}

impl Default for Detector {
    /// The target and the camera of the reference scenario. The tolerance lets through the noise of
    /// the camera and half a room of smoke, and nothing else in the arena.
    fn default() -> Self {
        Self {
            colour: [225, 30, 35],
            tolerance: 60,
            field_of_view_rad: 65.0_f64.to_radians(),
            object_diameter_m: 0.24,
        }
    }
}

impl Detector {
    /// Where the target appears in `image`.
    pub fn find(&self, image: &Image) -> DetectedObject {
        let counts = self.column_counts(image);
        let object = stretches(&counts)
            .map(|columns| (counts[columns.clone()].iter().sum::<u32>(), columns))
            .filter(|(pixels, _)| *pixels >= OBJECT_PIXELS_MINIMUM)
            // The leftmost among equals.
            .min_by_key(|(pixels, columns)| (u32::MAX - pixels, columns.start));
        match object {
            Some((pixel_count, columns)) => self.measure(image, pixel_count, &columns),
            None => DetectedObject {
                time: image.time,
                ..DetectedObject::default()
            },
        }
    }

    /// Pixels of the target's colour in each column.
    fn column_counts(&self, image: &Image) -> Vec<u32> {
        let pixels = image.used_pixels();
        if pixels.is_empty() {
            // Its width may be anything.
            return Vec::new();
        }
        let width = image.width as usize;
        let mut counts = vec![0; width];
        for row in pixels.chunks_exact(3 * width) {
            for (count, pixel) in counts.iter_mut().zip(row.chunks_exact(3)) {
                *count += u32::from(self.matches(pixel));
            }
        }
        counts
    }

    fn matches(&self, pixel: &[u8]) -> bool {
        pixel
            .iter()
            .zip(self.colour)
            .all(|(channel, wanted)| channel.abs_diff(wanted) <= self.tolerance)
    }

    fn measure(&self, image: &Image, pixel_count: u32, columns: &Range<usize>) -> DetectedObject {
        let left_edge_rad = self.bearing_rad(image, columns.start);
        let right_edge_rad = self.bearing_rad(image, columns.end);
        let angular_width_rad = left_edge_rad - right_edge_rad;
        DetectedObject {
            time: image.time,
            visible: 1,
            pixel_count,
            bearing: f64::midpoint(left_edge_rad, right_edge_rad),
            angular_width: angular_width_rad,
            // Both lines of sight touch the cylinder.
            distance: self.object_diameter_m / 2.0 / (angular_width_rad / 2.0).sin(),
        }
    }

    /// Direction of the left edge of a column.
    fn bearing_rad(&self, image: &Image, column: usize) -> f64 {
        let half_width = f64::from(image.width) / 2.0;
        let focal_length = half_width / (self.field_of_view_rad / 2.0).tan();
        ((half_width - column as f64) / focal_length).atan()
    }
}

/// Ranges of neighbouring columns that all hold enough pixels.
fn stretches(counts: &[u32]) -> impl Iterator<Item = Range<usize>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let belongs = |count: &u32| *count >= COLUMN_PIXELS_MINIMUM;
        let start = at + counts[at..].iter().position(belongs)?;
        let length = counts[start..].iter().position(|count| !belongs(count));
        at = length.map_or(counts.len(), |length| start + length);
        Some(start..at)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: [u8; 3] = [220, 35, 30];
    const DULL: [u8; 3] = [118, 104, 84];

    /// A picture of 160 x 120 pixels with red boxes of 20 rows, from a column to before another.
    fn picture(boxes: &[(usize, usize)]) -> Box<Image> {
        let mut image = Box::new(Image::empty());
        (image.time, image.width, image.height) = (5, 160, 120);
        for (index, pixel) in image.pixels.chunks_exact_mut(3).enumerate() {
            let (row, column) = (index / 160, index % 160);
            let is_red = (50..70).contains(&row)
                && boxes
                    .iter()
                    .any(|(from, to)| (*from..*to).contains(&column));
            pixel.copy_from_slice(if is_red { &RED } else { &DULL });
        }
        image
    }

    #[test]
    fn nothing_red_is_nothing_found() {
        let found = Detector::default().find(&picture(&[]));
        assert_eq!((found.visible, found.pixel_count, found.time), (0, 0, 5));
        assert_eq!(Detector::default().find(&Image::empty()).visible, 0);
    }

    #[test]
    fn the_middle_of_the_picture_is_straight_ahead() {
        let found = Detector::default().find(&picture(&[(70, 90)]));
        assert_eq!((found.visible, found.pixel_count), (1, 400));
        assert!(found.bearing.abs() < 1e-12);
        // 20 of 160 columns at a focal length of 125.6: 9.1 degrees for 0.24 m.
        assert!((found.angular_width - 0.1590).abs() < 1e-3, "{found:?}");
        assert!((found.distance - 1.511).abs() < 1e-2, "{found:?}");
    }

    #[test]
    fn the_edges_are_half_the_field_of_view_away_and_left_is_positive() {
        let left = Detector::default().find(&picture(&[(0, 2)]));
        let right = Detector::default().find(&picture(&[(158, 160)]));
        assert!((left.bearing - 32.1_f64.to_radians()).abs() < 0.01);
        assert!((left.bearing + right.bearing).abs() < 1e-12);
    }

    #[test]
    fn the_larger_of_two_things_is_the_target() {
        let found = Detector::default().find(&picture(&[(10, 14), (100, 120)]));
        assert!(found.bearing < 0.0);
        assert_eq!(found.pixel_count, 400);
    }

    #[test]
    fn an_image_that_claims_too_much_is_empty() {
        let mut image = picture(&[(70, 90)]);
        image.height = u32::MAX;
        assert_eq!(Detector::default().find(&image).visible, 0);
        // Counting so many columns would take seconds.
        image.width = u32::MAX;
        assert_eq!(Detector::default().column_counts(&image).len(), 0);
    }
}
