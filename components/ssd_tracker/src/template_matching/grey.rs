//! Grey values of a picture.

use robot_interface::port_data::Image;

/// A picture of grey values, rows from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GreyImage {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    pub(super) values: Vec<u8>,
}

impl GreyImage {
    /// Neighbouring pixels of a row.
    pub(super) fn stretch(&self, left: usize, row: usize, length: usize) -> &[u8] {
        let from = row * self.width + left;
        &self.values[from..from + length]
    }
}

/// Luminance by ITU-R BT.601 in whole numbers; none for a picture without a pixel.
pub fn grey_values(image: &Image) -> Option<GreyImage> {
    let pixels = image.used_pixels();
    if pixels.is_empty() {
        // Its width may be anything.
        return None;
    }
    let luminance = |pixel: &[u8]| {
        let [red, green, blue] = [0, 1, 2].map(|channel| u32::from(pixel[channel]));
        ((77 * red + 150 * green + 29 * blue) / 256) as u8
    };
    Some(GreyImage {
        width: image.width as usize,
        height: image.height as usize,
        values: pixels.chunks_exact(3).map(luminance).collect(),
    })
}
