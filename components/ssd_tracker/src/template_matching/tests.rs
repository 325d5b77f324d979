//! A target that moves over a background, found to the pixel.

use robot_interface::port_data::Image;

use super::*;

/// A checkered board of 21 x 21 pixels with its middle at a place, before a slope of grey; all
/// values through `haze`.
fn picture(column: usize, row: usize, haze: impl Fn(u8) -> u8) -> GreyImage {
    let mut image = Box::new(Image::empty());
    (image.width, image.height) = (160, 120);
    for (index, pixel) in image.pixels.chunks_exact_mut(3).enumerate() {
        let (at_row, at_column) = (index / 160, index % 160);
        let is_target = at_row.abs_diff(row) <= 10 && at_column.abs_diff(column) <= 10;
        let value = match is_target {
            true if (at_row + 100 - row) / 5 % 2 == (at_column + 100 - column) / 7 % 2 => 220,
            true => 20,
            false => (60 + at_column / 4) as u8,
        };
        pixel.fill(haze(value));
    }
    grey_values(&image).expect("a picture")
}

fn clear(value: u8) -> u8 {
    value
}

/// A third of the light comes through.
fn hazy(value: u8) -> u8 {
    value / 3 + 130
}

#[test]
fn a_known_motion_is_followed_to_the_pixel() {
    let mut track = Track::nothing();
    let search = Search::default();
    assert_eq!(track.follow(&search, &picture(80, 60, clear)), Some(0.0));
    let mut at = (80_usize, 60_usize);
    for (right, down) in [(3, 0), (-7, 2), (0, -5), (16, 16), (-12, -9), (0, 0)] {
        at = (
            at.0.wrapping_add_signed(right),
            at.1.wrapping_add_signed(down),
        );
        let error = track.follow(&search, &picture(at.0, at.1, clear));
        assert!(error.is_some_and(|error| error < 5.0), "{error:?}");
        assert_eq!(track.middle(), (at.0 as f64 + 0.5, at.1 as f64 + 0.5));
        assert_eq!(track.pictures_lost(), 0);
    }
}

#[test]
fn what_is_lost_in_haze_is_looked_for_ever_farther_away() {
    let mut track = Track::nothing();
    let search = Search::default();
    track.follow(&search, &picture(80, 60, clear));
    for lost in 1..=4 {
        let error = track.follow(&search, &picture(80, 60, hazy));
        assert!(
            error.is_some_and(|error| error > search.lost_error),
            "{error:?}"
        );
        assert_eq!(
            (track.pictures_lost(), track.middle()),
            (lost, (80.5, 60.5))
        );
    }
    // 30 columns away: too far for two pictures, not for one after four that were lost.
    track.follow(&search, &picture(110, 60, clear));
    assert_eq!((track.pictures_lost(), track.middle()), (0, (110.5, 60.5)));
}

#[test]
fn a_place_at_the_edge_is_learnt_as_far_as_the_picture_goes() {
    for (column, row, middle) in [
        (0, 0, (15.5, 15.5)),
        (159, 119, (144.5, 104.5)),
        (40, 30, (40.5, 30.5)),
        (-1, -1, (80.5, 60.5)),
    ] {
        let mut track = Track::nothing();
        let search = Search {
            column,
            row,
            ..Search::default()
        };
        track.follow(&search, &picture(80, 60, clear));
        assert_eq!(track.middle(), middle);
        let error = track.follow(&search, &picture(80, 60, clear));
        assert_eq!(error, Some(0.0), "the same picture");
    }
}

#[test]
fn pictures_without_room_for_the_target_are_refused() {
    let mut image = Box::new(Image::empty());
    assert_eq!(grey_values(&image), None);
    (image.width, image.height) = (30, 40);
    let small = grey_values(&image).expect("a picture");
    assert_eq!(Track::nothing().follow(&Search::default(), &small), None);
    image.width = u32::MAX;
    assert_eq!(grey_values(&image), None);
}
