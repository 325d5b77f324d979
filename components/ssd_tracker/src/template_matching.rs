//! What is learnt of a picture, and where in another one it is again.

mod grey;

use component_sdk::PortData;

pub use grey::{GreyImage, grey_values};

/// Width and height of the template; odd, so that it has a middle. At 1.4 m from the camera of the
/// reference robot that is 0.34 m, a target and a rim of what is behind it.
pub const TEMPLATE_SIDE: usize = 31;
const HALF_SIDE: usize = TEMPLATE_SIDE / 2;
/// By so many pixels more is searched for each picture in which the target was lost.
const WIDENED_BY: usize = 4;

/// What to learn, and where to look for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// Column of the middle of what is learnt; negative for that of the picture.
    pub column: i32,
    /// Likewise its row.
    pub row: i32,
    /// Farthest way between two pictures, in pixels along rows and along columns.
    pub radius: usize,
    /// Matching error, in grey values, above which the target is lost.
    pub lost_error: f64,
}

impl Default for Search {
    /// A target that crosses the picture in a second, and a camera of ten pictures a second whose
    /// noise gives an error of 5.
    fn default() -> Self {
        Self {
            column: -1,
            row: -1,
            radius: 16,
            lost_error: 40.0,
        }
    }
}

/// What is known of the target; it can be handed over to a successor.
#[derive(PortData, Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Track {
    template: [u8; TEMPLATE_SIDE * TEMPLATE_SIDE],
    learnt: u8,
    pictures_lost: u32,
    /// Upper left corner of the last sure match.
    left: u32,
    top: u32,
}

impl Track {
    /// Nothing is learnt yet.
    pub fn nothing() -> Self {
        Self {
            template: [0; TEMPLATE_SIDE * TEMPLATE_SIDE],
            learnt: 0,
            pictures_lost: 0,
            left: 0,
            top: 0,
        }
    }

    /// Pictures since the last sure match.
    pub fn pictures_lost(&self) -> u32 {
        self.pictures_lost
    }

    /// Column and row of the middle of the last sure match, of which whole numbers are edges between
    /// pixels.
    pub fn middle(&self) -> (f64, f64) {
        let half = TEMPLATE_SIDE as f64 / 2.0;
        (f64::from(self.left) + half, f64::from(self.top) + half)
    }

    /// Learns the target from the first picture, finds it in each later one. Returns the matching
    /// error, the root mean square difference of grey values; none if the picture is too small.
    pub fn follow(&mut self, search: &Search, picture: &GreyImage) -> Option<f64> {
        let columns = picture.width.checked_sub(TEMPLATE_SIDE)?;
        let rows = picture.height.checked_sub(TEMPLATE_SIDE)?;
        if self.learnt == 0 {
            self.learn(search, picture, (columns, rows));
            return Some(0.0);
        }
        let radius = search.radius + WIDENED_BY * self.pictures_lost as usize;
        let around = |corner: u32, last: usize| {
            let corner = (corner as usize).min(last);
            corner.saturating_sub(radius)..=(corner + radius).min(last)
        };
        let mut best = (u64::MAX, (0, 0));
        for top in around(self.top, rows) {
            for left in around(self.left, columns) {
                let squares = self.squares(picture, (left, top), best.0);
                if squares < best.0 {
                    best = (squares, (left, top));
                }
            }
        }
        let error = (best.0 as f64 / self.template.len() as f64).sqrt();
        if error <= search.lost_error {
            (self.left, self.top) = (best.1.0 as u32, best.1.1 as u32);
            self.pictures_lost = 0;
        } else {
            self.pictures_lost = self.pictures_lost.saturating_add(1);
        }
        Some(error)
    }

    fn learn(&mut self, search: &Search, picture: &GreyImage, last: (usize, usize)) {
        let corner = |middle: i32, size: usize, last: usize| {
            let middle = usize::try_from(middle).unwrap_or(size / 2);
            middle.saturating_sub(HALF_SIDE).min(last)
        };
        let left = corner(search.column, picture.width, last.0);
        let top = corner(search.row, picture.height, last.1);
        for (row, learnt) in self.template.chunks_exact_mut(TEMPLATE_SIDE).enumerate() {
            learnt.copy_from_slice(picture.stretch(left, top + row, TEMPLATE_SIDE));
        }
        (self.left, self.top) = (left as u32, top as u32);
        self.learnt = 1;
    }

    /// Sum of squared differences at a place; anything from `enough` on is not reckoned to the end.
    fn squares(&self, picture: &GreyImage, (left, top): (usize, usize), enough: u64) -> u64 {
        let mut sum = 0;
        for (row, learnt) in self.template.chunks_exact(TEMPLATE_SIDE).enumerate() {
            let seen = picture.stretch(left, top + row, TEMPLATE_SIDE);
            let squares = learnt.iter().zip(seen).map(|(learnt, seen)| {
                let difference = u32::from(learnt.abs_diff(*seen));
                difference * difference
            });
            sum += u64::from(squares.sum::<u32>());
            if sum >= enough {
                break;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests;
