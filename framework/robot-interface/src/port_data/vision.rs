//! What the camera sees and what is found in it.

use component_sdk::prelude::*;

/// Width of an [`Image`] in pixels.
pub const IMAGE_WIDTH: usize = 160;
/// Height of an [`Image`] in pixels.
pub const IMAGE_HEIGHT: usize = 120;
/// Bytes of the pixels of an [`Image`].
pub const IMAGE_PIXEL_BYTES: usize = IMAGE_WIDTH * IMAGE_HEIGHT * 3;

/// A picture, at most 160 x 120 pixels. It has 57.6 KB: keep it in a `Box`.
#[derive(PortData, Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Image {
    /// When it was taken, by the camera's clock.
    #[unit("ns")]
    pub time: u64,
    /// Width, at most [`IMAGE_WIDTH`].
    #[unit("pixel")]
    pub width: u32,
    /// Height, at most [`IMAGE_HEIGHT`].
    #[unit("pixel")]
    pub height: u32,
    /// Three bytes a pixel (red, green, blue), rows from the top, columns from the left, without
    /// gaps; what is behind `width` x `height` pixels has no meaning.
    pub pixels: [u8; IMAGE_PIXEL_BYTES],
}

impl Image {
    /// A picture without a pixel.
    pub fn empty() -> Self {
        Self {
            time: 0,
            width: 0,
            height: 0,
            pixels: [0; IMAGE_PIXEL_BYTES],
        }
    }

    /// The bytes that have a meaning; empty if width and height claim more than there can be.
    pub fn used_pixels(&self) -> &[u8] {
        let pixels = u64::from(self.width) * u64::from(self.height);
        usize::try_from(pixels)
            .ok()
            .and_then(|pixels| self.pixels.get(..pixels.checked_mul(3)?))
            .unwrap_or_default()
    }
}

/// Where the object that the robot looks for appears in the newest picture.
#[derive(PortData, Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct DetectedObject {
    /// When the picture was taken.
    #[unit("ns")]
    pub time: u64,
    /// 1 if the object is in the picture. Otherwise this is 0 and so are all measures.
    pub visible: u32,
    /// Pixels of the object.
    #[unit("pixel")]
    pub pixel_count: u32,
    /// Direction of its middle.
    #[unit("rad")]
    pub bearing: f64,
    /// Angle between its edges.
    #[unit("rad")]
    pub angular_width: f64,
    /// Distance from the camera to its middle, reckoned from its known size.
    #[unit("m")]
    pub distance: f64,
}

/// Where a tracker has found its target in the newest picture, and how sure that is.
#[derive(PortData, Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct TrackedTarget {
    /// When the picture was taken.
    #[unit("ns")]
    pub time: u64,
    /// 1 if the picture there is like the target, 0 if the target is lost; then the place is the
    /// last one that was sure.
    pub visible: u32,
    /// Pictures since the target was last seen; 0 when it is visible.
    pub pictures_lost: u32,
    /// Column of its middle.
    #[unit("pixel")]
    pub column: f64,
    /// Row of its middle.
    #[unit("pixel")]
    pub row: f64,
    /// Direction of its middle.
    #[unit("rad")]
    pub bearing: f64,
    /// Root mean square difference of grey values, 0 to 255, between the target as it was learnt
    /// and the best match in the picture.
    pub matching_error: f64,
}

/// How far the robot shall turn.
#[derive(PortData, Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct TurnReference {
    /// When the picture was taken from which it follows.
    #[unit("ns")]
    pub time: u64,
    /// 1 if there is something to turn to, 0 if the robot shall stand still.
    pub valid: u32,
    /// Angle that is left to turn.
    #[unit("rad")]
    pub turn: f64,
}
