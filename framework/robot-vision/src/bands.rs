//! Work on rows, divided among cores.

use std::thread;

/// More cores than this have nothing to do on a picture of some hundred rows.
const CORES_MAXIMUM: usize = 64;

/// Calls `work` with the number and the values of each row of `width` values, on up to `cores`
/// cores. What a row becomes must not depend on other rows of `values`.
pub(crate) fn each_row(
    values: &mut [f32],
    width: usize,
    cores: usize,
    work: impl Fn(usize, &mut [f32]) + Sync,
) {
    let rows = values.len() / width.max(1);
    let cores = cores.clamp(1, CORES_MAXIMUM).min(rows.max(1));
    if cores == 1 {
        in_order(values, width, 0, &work);
        return;
    }
    let rows_each = rows.div_ceil(cores);
    thread::scope(|scope| {
        for (index, band) in values.chunks_mut(rows_each * width).enumerate() {
            let work = &work;
            scope.spawn(move || in_order(band, width, index * rows_each, work));
        }
    });
}

fn in_order(
    values: &mut [f32],
    width: usize,
    first: usize,
    work: &(impl Fn(usize, &mut [f32]) + Sync),
) {
    for (row, values) in values.chunks_exact_mut(width.max(1)).enumerate() {
        work(first + row, values);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_worked_on_once_whatever_the_number_of_cores() {
        for (rows, width) in [(0, 4), (1, 4), (5, 3), (7, 1), (120, 2)] {
            for cores in [0, 1, 2, 3, 8, 1000] {
                let mut values = vec![0.0; rows * width];
                each_row(&mut values, width, cores, |row, values| {
                    for value in values {
                        *value += row as f32 + 1.0;
                    }
                });
                let expected: Vec<f32> = (0..rows * width)
                    .map(|index| (index / width) as f32 + 1.0)
                    .collect();
                assert_eq!(values, expected, "{rows} x {width} on {cores}");
            }
        }
    }
}
