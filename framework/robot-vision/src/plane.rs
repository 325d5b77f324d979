//! One number for each pixel, and what filters make of it.

use crate::bands::each_row;

/// One number for each pixel, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plane {
    pub(crate) width: usize,
    pub(crate) values: Vec<f32>,
}

impl Plane {
    /// What `value` says of each pixel, given by its index.
    pub(crate) fn of_pixels(
        (width, height): (usize, usize),
        cores: usize,
        value: impl Fn(usize) -> f32 + Sync,
    ) -> Self {
        let mut values = vec![0.0; width * height];
        each_row(&mut values, width, cores, |row, values| {
            for (column, found) in values.iter_mut().enumerate() {
                *found = value(row * width + column);
            }
        });
        Self { width, values }
    }

    pub(crate) fn height(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    /// What `value` says of each pixel of two planes of one size.
    pub(crate) fn with(
        &self,
        other: &Self,
        cores: usize,
        value: impl Fn(f32, f32) -> f32 + Sync,
    ) -> Self {
        let size = (self.width, self.height());
        Self::of_pixels(size, cores, |pixel| {
            value(self.values[pixel], other.values[pixel])
        })
    }

    /// The least value in the square around each pixel, cut off at the edges.
    pub(crate) fn minimum(&self, radius: usize, cores: usize) -> Self {
        self.in_both_directions(cores, |from, to| {
            for (index, least) in to.iter_mut().enumerate() {
                let window = window(index, radius, from.len());
                *least = from[window].iter().copied().fold(f32::INFINITY, f32::min);
            }
        })
    }

    /// The mean of the square around each pixel, cut off at the edges.
    pub(crate) fn mean(&self, radius: usize, cores: usize) -> Self {
        self.in_both_directions(cores, |from, to| {
            // The sum moves along: cost does not depend on the radius. In f64, because what is
            // added must be gone again when it is subtracted.
            let mut sum: f64 = from.iter().take(radius).map(|it| f64::from(*it)).sum();
            for (index, mean) in to.iter_mut().enumerate() {
                if let Some(entering) = from.get(index + radius) {
                    sum += f64::from(*entering);
                }
                if index > radius {
                    sum -= f64::from(from[index - radius - 1]);
                }
                *mean = (sum / window(index, radius, from.len()).len() as f64) as f32;
            }
        })
    }

    /// Filters all rows, then all columns.
    fn in_both_directions(&self, cores: usize, filter: impl Fn(&[f32], &mut [f32]) + Sync) -> Self {
        self.filter_rows(cores, &filter)
            .transposed()
            .filter_rows(cores, &filter)
            .transposed()
    }

    fn filter_rows(&self, cores: usize, filter: &(impl Fn(&[f32], &mut [f32]) + Sync)) -> Self {
        let mut values = vec![0.0; self.values.len()];
        each_row(&mut values, self.width, cores, |row, to| {
            filter(&self.values[row * self.width..(row + 1) * self.width], to);
        });
        Self {
            width: self.width,
            values,
        }
    }

    fn transposed(&self) -> Self {
        let height = self.height();
        let columns = (0..self.width)
            .flat_map(|column| self.values.iter().skip(column).step_by(self.width).copied());
        Self {
            values: columns.collect(),
            width: height,
        }
    }
}

fn window(index: usize, radius: usize, length: usize) -> std::ops::Range<usize> {
    index.saturating_sub(radius)..(index + radius + 1).min(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(width: usize, values: &[f32]) -> Plane {
        Plane {
            width,
            values: values.to_vec(),
        }
    }

    #[test]
    fn filters_look_at_a_square_that_the_edges_cut_off() {
        let from = plane(3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 0.0]);
        let least = [1.0, 1.0, 2.0, 1.0, 0.0, 0.0, 4.0, 0.0, 0.0];
        assert_eq!(from.minimum(1, 1).values, least);
        let mean = from.mean(1, 1).values;
        for (pixel, expected) in [(0, 3.0), (1, 3.5), (4, 4.0), (8, 4.75)] {
            assert!((mean[pixel] - expected).abs() < 1e-6, "{pixel}: {mean:?}");
        }
    }

    #[test]
    fn filters_wider_than_the_plane_see_all_of_it() {
        let from = plane(2, &[4.0, 2.0, 6.0, 8.0]);
        assert_eq!(from.minimum(9, 1).values, [2.0; 4]);
        assert_eq!(from.mean(9, 1).values, [5.0; 4]);
        let none = plane(0, &[]);
        assert_eq!(none.mean(3, 2).values, [0.0; 0]);
    }

    #[test]
    fn cores_change_nothing() {
        let values: Vec<f32> = (0..31 * 17).map(|it| ((it * 7919) % 251) as f32).collect();
        let from = plane(31, &values);
        for cores in [2, 3, 16] {
            assert_eq!(from.mean(4, cores), from.mean(4, 1));
            assert_eq!(from.minimum(4, cores), from.minimum(4, 1));
        }
    }
}
