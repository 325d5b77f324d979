//! Pictures in haze, and how near to the clear ones they come back.

use super::*;

const SIZE: (usize, usize) = (80, 60);

/// A far bright wall above, and coloured boards before it of which each lets one colour be dark.
fn scene(pixel: usize) -> ([f32; 3], f32) {
    let (column, row) = (pixel % SIZE.0, pixel / SIZE.0);
    const BOARDS: [[f32; 3]; 4] = [
        [210.0, 30.0, 20.0],
        [20.0, 150.0, 40.0],
        [30.0, 25.0, 160.0],
        [190.0, 170.0, 15.0],
    ];
    match row {
        0..10 => ([185.0; 3], 20.0),
        _ => (
            BOARDS[(column / 8 + row / 8) % 4],
            1.0 + column as f32 / 40.0,
        ),
    }
}

fn picture(scattering_per_m: f32) -> Vec<u8> {
    let pixels = (0..SIZE.0 * SIZE.1).flat_map(|pixel| {
        let (colour, distance_m) = scene(pixel);
        let transmission = (-scattering_per_m * distance_m).exp();
        colour.map(|channel| (channel * transmission + 200.0 * (1.0 - transmission)).round() as u8)
    });
    pixels.collect()
}

fn clear(dehazer: &Dehazer, hazy: &[u8]) -> Vec<u8> {
    let mut clear = vec![0; hazy.len()];
    dehazer.clear(hazy, SIZE.0, &mut clear);
    clear
}

/// Root mean square difference of two pictures, below the bright wall.
fn difference(one: &[u8], other: &[u8]) -> f64 {
    let from = 10 * SIZE.0 * 3;
    let squares = one[from..].iter().zip(&other[from..]).map(|(one, other)| {
        let difference = f64::from(*one) - f64::from(*other);
        difference * difference
    });
    (squares.sum::<f64>() / (one.len() - from) as f64).sqrt()
}

/// Standard deviation of all values below the bright wall.
fn contrast(picture: &[u8]) -> f64 {
    let below = &picture[10 * SIZE.0 * 3..];
    let mean = below.iter().map(|it| f64::from(*it)).sum::<f64>() / below.len() as f64;
    difference(picture, &vec![mean.round() as u8; picture.len()])
}

#[test]
fn contrast_comes_back_out_of_haze() {
    let there = picture(0.0);
    for scattering_per_m in [0.3, 0.5, 0.8] {
        let hazy = picture(scattering_per_m);
        let clear = clear(&Dehazer::default(), &hazy);
        let restored = contrast(&clear) / contrast(&there);
        assert!(
            contrast(&hazy) < 0.75 * contrast(&there),
            "no haze in the picture"
        );
        assert!(
            (0.8..1.2).contains(&restored),
            "{scattering_per_m}: contrast {restored}"
        );
        let (before, after) = (difference(&hazy, &there), difference(&clear, &there));
        assert!(
            after < 0.4 * before,
            "{scattering_per_m}: off by {after}, before by {before}"
        );
    }
}

#[test]
fn a_clear_picture_stays_nearly_as_it_is() {
    let there = picture(0.0);
    let cleared = clear(&Dehazer::default(), &there);
    assert!(
        difference(&cleared, &there) < 25.0,
        "{}",
        difference(&cleared, &there)
    );
}

#[test]
fn all_cores_give_what_one_gives() {
    let hazy = picture(0.5);
    let alone = clear(&Dehazer::default(), &hazy);
    for cores in [2, 3, 8] {
        let together = Dehazer {
            cores,
            ..Dehazer::default()
        };
        assert!(clear(&together, &hazy) == alone, "{cores} cores");
    }
}

#[test]
fn sizes_that_do_not_fit_take_whole_rows_only() {
    let hazy = picture(0.5);
    for (pixels, width, expected) in [
        (0, 80, 0),
        (80 * 3 * 2 + 5, 80, 480),
        (30, 0, 0),
        (30, 80, 0),
    ] {
        let mut clear = vec![7; pixels];
        Dehazer::default().clear(&hazy, width, &mut clear);
        assert!(
            clear[expected..].iter().all(|it| *it == 7),
            "{pixels} {width}"
        );
    }
    let whole = clear(&Dehazer::default(), &hazy);
    assert_ne!(whole, hazy);
}
