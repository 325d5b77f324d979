//! Columns get their places, frames are put around groups, and lines are led from box to box.

use super::order::{Grid, Item};
use super::place::{Places, end};
use super::{Area, Extent, Group, HEADING, Layout, Line, Link, MARGIN, PADDING};

/// Between two columns, beside what lines that lead back need.
const GUTTER: f64 = 70.0;
/// Between two lines that lead back.
const TRACK: f64 = 10.0;

/// Everything in its place.
pub fn conclude(
    boxes: &[Extent],
    links: &[Link],
    groups: &[Group],
    grid: &Grid,
    places: &Places,
) -> Layout {
    let back = grid.leads_back.iter().filter(|back| **back).count() as f64;
    let gutter = GUTTER + 2.0 * TRACK * back;
    let mut x = MARGIN + PADDING + TRACK * (back + 1.0);
    let mut sides = Vec::new();
    for items in &grid.columns {
        let width = column_width(boxes, groups, items);
        sides.push((x, x + width));
        x += width + gutter;
    }
    let mut areas = vec![None; boxes.len()];
    for (column, items) in grid.columns.iter().enumerate() {
        for (place, item) in items.iter().enumerate() {
            if let Item::Box(one) = item {
                areas[*one] = Some(Area {
                    x: sides[column].0,
                    y: places.tops[column][place],
                    width: boxes[*one].width,
                    height: boxes[*one].height,
                });
            }
        }
    }
    let areas: Vec<Area> = areas.into_iter().flatten().collect();
    let frames = frames(groups, grid, &areas, &sides);
    let passing = |column: usize, item: Item| places.top(grid, column, item);
    let bottoms = areas.iter().map(|area| area.y + area.height);
    let bottom = bottoms.fold(0.0, f64::max) + PADDING + TRACK;
    let mut tracks = 0.0;
    let mut lines = Vec::new();
    for (index, link) in links.iter().enumerate() {
        if grid.leads_back[index] {
            tracks += 1.0;
            lines.push(around(link, &areas, &sides, bottom, tracks));
        } else {
            lines.push(along(link, &grid.paths[index], &areas, &sides, passing));
        }
    }
    let right = sides.last().map_or(0.0, |(_, right)| *right) + PADDING + TRACK * (back + 1.0);
    Layout {
        boxes: areas,
        frames,
        lines,
        size: Extent {
            width: right + MARGIN,
            height: bottom + TRACK * tracks + MARGIN,
        },
    }
}

fn column_width(boxes: &[Extent], groups: &[Group], items: &[Item]) -> f64 {
    let widths = items.iter().map(|item| match item {
        Item::Box(one) => {
            let group = groups.iter().find(|group| group.members.contains(one));
            let label = group.map_or(0.0, |group| group.label_width);
            boxes[*one].width.max(label)
        }
        Item::Passing(_) => 0.0,
    });
    widths.fold(0.0, f64::max)
}

/// One for each column that members of a group stand in.
fn frames(
    groups: &[Group],
    grid: &Grid,
    areas: &[Area],
    sides: &[(f64, f64)],
) -> Vec<(usize, Area)> {
    let mut frames = Vec::new();
    for (column, items) in grid.columns.iter().enumerate() {
        for (number, group) in groups.iter().enumerate() {
            let members = items.iter().filter_map(|item| match item {
                Item::Box(one) if group.members.contains(one) => Some(areas[*one]),
                _ => None,
            });
            let members: Vec<Area> = members.collect();
            if members.is_empty() {
                continue;
            }
            let top = members
                .iter()
                .map(|one| one.y)
                .fold(f64::INFINITY, f64::min);
            let bottom = members.iter().map(|one| one.y + one.height);
            let bottom = bottom.fold(0.0, f64::max);
            let (left, right) = sides[column];
            frames.push((
                number,
                Area {
                    x: left - PADDING,
                    y: top - HEADING,
                    width: right - left + 2.0 * PADDING,
                    height: bottom - top + HEADING + PADDING,
                },
            ));
        }
    }
    frames
}

/// Through the room that was kept for it in the columns between.
fn along(
    link: &Link,
    path: &[Item],
    areas: &[Area],
    sides: &[(f64, f64)],
    passing: impl Fn(usize, Item) -> f64,
) -> Line {
    let source = areas[link.source];
    let target = areas[link.target];
    let first = column_at(sides, source.x);
    let y = source.y + link.source_y;
    let mut points = vec![(source.x + source.width, y), (sides[first].1, y)];
    for (index, item) in path.iter().enumerate() {
        if let Item::Passing(_) = item {
            let column = first + index;
            let y = passing(column, *item) + end(link, path, index);
            points.push((sides[column].0, y));
            points.push((sides[column].1, y));
        }
    }
    points.push((target.x, target.y + link.target_y));
    Line {
        points,
        leads_back: false,
    }
}

/// Out to the right, down, to the left below everything, up, and in from the left, on a track of its
/// own.
fn around(link: &Link, areas: &[Area], sides: &[(f64, f64)], bottom: f64, track: f64) -> Line {
    let (source, target) = (areas[link.source], areas[link.target]);
    let (from, to) = (source.y + link.source_y, target.y + link.target_y);
    let right = sides[column_at(sides, source.x)].1 + PADDING + TRACK * track;
    let left = target.x - PADDING - TRACK * track;
    let below = bottom + TRACK * (track - 1.0);
    Line {
        points: vec![
            (source.x + source.width, from),
            (right, from),
            (right, below),
            (left, below),
            (left, to),
            (target.x, to),
        ],
        leads_back: true,
    }
}

fn column_at(sides: &[(f64, f64)], x: f64) -> usize {
    sides.iter().position(|(left, _)| *left >= x).unwrap_or(0)
}
