//! Where boxes and lines of a picture lie: a layered layout after Sugiyama et al. (1981). Boxes stand
//! in columns from left to right along what goes from one to another, in an order with few crossings;
//! long lines have room of their own in the columns that they pass; those that lead back go round
//! below all boxes. All measures are pixels.

mod columns;
mod order;
mod place;
mod route;

/// A box to be placed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// A line to be drawn, from the right side of a box to the left side of another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// The box that it leaves.
    pub source: usize,
    /// How far below that one's top.
    pub source_y: f64,
    /// The box that it leads to.
    pub target: usize,
    /// How far below that one's top.
    pub target_y: f64,
}

/// Boxes that belong together and get a frame where they stand in one column.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// The boxes.
    pub members: Vec<usize>,
    /// Width of what is written above them.
    pub label_width: f64,
}

/// A box in its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Left side.
    pub x: f64,
    /// Top.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// Everything in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Boxes, as they were given.
    pub boxes: Vec<Area>,
    /// Frames, each with the index of its group; a group has one for each column.
    pub frames: Vec<(usize, Area)>,
    /// Lines, as they were given.
    pub lines: Vec<Line>,
    /// Size of the picture.
    pub size: Extent,
}

/// A line.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Points from its beginning to its end.
    pub points: Vec<(f64, f64)>,
    /// Whether it leads back, in straight pieces; else it is to be drawn smoothly.
    pub leads_back: bool,
}

/// Empty margin around the picture.
const MARGIN: f64 = 24.0;
/// Between two boxes of a column.
const GAP: f64 = 22.0;
/// Between a frame and the boxes in it.
const PADDING: f64 = 10.0;
/// Above the boxes in a frame, for what is written there.
const HEADING: f64 = 22.0;

/// Places everything.
pub fn layout(boxes: &[Extent], links: &[Link], groups: &[Group]) -> Layout {
    let columns = columns::columns(boxes.len(), links);
    let grid = order::order(boxes.len(), links, groups, &columns);
    let places = place::place(boxes, links, groups, &grid);
    route::conclude(boxes, links, groups, &grid, &places)
}

impl Area {
    /// Whether two boxes have any point in common.
    #[cfg(test)]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.x < other.x + other.width
            && other.x < self.x + self.width
            && self.y < other.y + other.height
            && other.y < self.y + self.height
    }

    /// Whether another box lies inside.
    #[cfg(test)]
    pub fn contains(&self, other: &Self) -> bool {
        self.x <= other.x
            && self.y <= other.y
            && self.x + self.width >= other.x + other.width
            && self.y + self.height >= other.y + other.height
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Links from one box to another, at half their height.
    fn links(ends: &[(usize, usize)]) -> Vec<Link> {
        let link = |(source, target): &(usize, usize)| Link {
            source: *source,
            source_y: 20.0,
            target: *target,
            target_y: 20.0,
        };
        ends.iter().map(link).collect()
    }

    fn boxes(count: usize) -> Vec<Extent> {
        let extent = |index: usize| Extent {
            width: 80.0 + 10.0 * (index % 4) as f64,
            height: 40.0 + 15.0 * (index % 3) as f64,
        };
        (0..count).map(extent).collect()
    }

    /// Nothing overlaps, and no line passes through a box.
    fn is_sound(layout: &Layout) {
        for (index, one) in layout.boxes.iter().enumerate() {
            assert!(one.x >= 0.0 && one.y >= 0.0, "{one:?}");
            assert!(one.x + one.width <= layout.size.width, "{one:?}");
            assert!(one.y + one.height <= layout.size.height, "{one:?}");
            for other in &layout.boxes[index + 1..] {
                assert!(!one.overlaps(other), "{one:?} and {other:?}");
            }
        }
        for (index, (_, frame)) in layout.frames.iter().enumerate() {
            for (_, other) in &layout.frames[index + 1..] {
                assert!(!frame.overlaps(other), "{frame:?} and {other:?}");
            }
            for one in &layout.boxes {
                assert!(frame.contains(one) || !frame.overlaps(one), "{one:?}");
            }
        }
        let points = layout.lines.iter().flat_map(|line| &line.points);
        for (x, y) in points.copied() {
            let inside = |one: &&Area| {
                x > one.x && x < one.x + one.width && y > one.y && y < one.y + one.height
            };
            assert_eq!(layout.boxes.iter().find(inside), None, "({x}, {y})");
            assert!(x >= 0.0 && x <= layout.size.width, "{x}");
            assert!(y >= 0.0 && y <= layout.size.height, "{y}");
        }
    }

    #[test]
    fn nothing_overlaps() {
        let cases: [(usize, &[(usize, usize)]); 6] = [
            (0, &[]),
            (1, &[(0, 0)]),
            (3, &[(0, 1), (1, 2), (0, 2)]),
            (4, &[(0, 1), (1, 2), (2, 3), (3, 0)]),
            (
                6,
                &[
                    (0, 1),
                    (0, 2),
                    (0, 3),
                    (1, 4),
                    (2, 4),
                    (3, 4),
                    (4, 5),
                    (5, 0),
                    (0, 5),
                ],
            ),
            (5, &[]),
        ];
        for (count, ends) in cases {
            let groups = [Group {
                members: (1..count).step_by(2).collect(),
                label_width: 150.0,
            }];
            let layout = layout(&boxes(count), &links(ends), &groups);
            assert_eq!(layout.boxes.len(), count);
            assert_eq!(layout.lines.len(), ends.len());
            is_sound(&layout);
        }
    }

    #[test]
    fn what_is_sent_goes_from_left_to_right_and_comes_back_below() {
        let layout = layout(&boxes(3), &links(&[(0, 1), (1, 2), (2, 0)]), &[]);
        assert!(layout.boxes[0].x < layout.boxes[1].x);
        assert!(layout.boxes[1].x < layout.boxes[2].x);
        let back: Vec<bool> = layout.lines.iter().map(|line| line.leads_back).collect();
        assert_eq!(back, [false, false, true]);
        let lowest = layout.boxes.iter().map(|one| one.y + one.height);
        let lowest = lowest.fold(0.0, f64::max);
        let points = &layout.lines[2].points;
        assert!(points.iter().any(|(_, y)| *y > lowest), "{points:?}");
    }
}
