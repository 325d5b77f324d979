//! The colour of the haze: that of the pixels in which it is thickest.

/// The share of pixels that is taken for the haziest (section 4.3 of the paper).
const HAZIEST_SHARE: f32 = 0.001;
/// Fewer are noise: a small picture has not many.
const HAZIEST_MINIMUM: usize = 8;

/// The mean colour of the pixels whose dark channel is brightest, each channel at least 1 so that
/// it can be divided by. The paper takes the brightest of them, which in a noisy picture is noise.
pub(super) fn of(hazy: &[u8], dark_channel: &[f32]) -> [f32; 3] {
    let wanted = ((dark_channel.len() as f32 * HAZIEST_SHARE) as usize)
        .max(HAZIEST_MINIMUM)
        .min(dark_channel.len());
    if wanted == 0 {
        return [1.0; 3];
    }
    let mut haziest: Vec<usize> = (0..dark_channel.len()).collect();
    // The first ones among equals, so that the result is the same everywhere.
    haziest.select_nth_unstable_by(wanted - 1, |a, b| {
        dark_channel[*b].total_cmp(&dark_channel[*a]).then(a.cmp(b))
    });
    haziest.truncate(wanted);
    [0, 1, 2].map(|channel| {
        let sum: u32 = haziest
            .iter()
            .map(|pixel| u32::from(hazy[3 * pixel + channel]))
            .sum();
        (sum as f32 / wanted as f32).max(1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_haziest_pixels_give_the_colour() {
        let mut hazy = vec![10; 3 * 100];
        let mut dark = vec![10.0; 100];
        for pixel in 40..48 {
            hazy[3 * pixel..3 * pixel + 3].copy_from_slice(&[200, 210, 220]);
            dark[pixel] = 200.0;
        }
        assert_eq!(of(&hazy, &dark), [200.0, 210.0, 220.0]);
    }

    #[test]
    fn a_picture_without_light_has_an_airlight_that_can_be_divided_by() {
        assert_eq!(of(&[0; 9], &[0.0; 3]), [1.0; 3]);
        assert_eq!(of(&[], &[]), [1.0; 3]);
    }
}
