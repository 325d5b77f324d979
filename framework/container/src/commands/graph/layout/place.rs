//! Where in its column a box stands: as near as it can to the boxes that it is linked with.

use super::order::{Grid, Item};
use super::{Extent, GAP, Group, HEADING, Link, MARGIN, PADDING};

/// How often boxes are moved towards their neighbours; it settles within a few rounds.
const ROUNDS: usize = 16;

/// Room of a line that passes.
const LINE: f64 = 8.0;

/// Tops of all items, column by column.
pub struct Places {
    /// In the order of the grid.
    pub tops: Vec<Vec<f64>>,
}

impl Places {
    /// The top of an item.
    pub fn top(&self, grid: &Grid, column: usize, item: Item) -> f64 {
        let place = grid.columns[column].iter().position(|one| *one == item);
        place.map_or(0.0, |place| self.tops[column][place])
    }
}

/// Places every item of every column.
pub fn place(boxes: &[Extent], links: &[Link], groups: &[Group], grid: &Grid) -> Places {
    let columns = grid.columns.iter();
    let offsets: Vec<Vec<f64>> = columns.map(|items| offsets(boxes, groups, items)).collect();
    let mut places = Places {
        tops: offsets.clone(),
    };
    for round in 0..ROUNDS {
        let count = grid.columns.len();
        for step in 0..count {
            let column = if round % 2 == 0 {
                step
            } else {
                count - 1 - step
            };
            let wanted: Vec<f64> = (grid.columns[column].iter())
                .map(|item| wanted(links, grid, &places, column, *item))
                .collect();
            places.tops[column] = spread(&wanted, &offsets[column]);
        }
    }
    let tops = places.tops.iter().flatten();
    let least = tops.copied().fold(f64::INFINITY, f64::min);
    let shift = MARGIN + HEADING - if least.is_finite() { least } else { 0.0 };
    for top in places.tops.iter_mut().flatten() {
        *top += shift;
    }
    places
}

/// Tops of items that stand as close as they may.
fn offsets(boxes: &[Extent], groups: &[Group], items: &[Item]) -> Vec<f64> {
    let group_of = |item: &Item| match item {
        Item::Box(one) => groups.iter().position(|group| group.members.contains(one)),
        Item::Passing(_) => None,
    };
    let mut top = 0.0;
    let mut tops = Vec::new();
    for (place, item) in items.iter().enumerate() {
        let before = place.checked_sub(1).map(|before| group_of(&items[before]));
        if let Some(before) = before
            && before != group_of(item)
        {
            top += if group_of(item).is_some() {
                PADDING + HEADING
            } else {
                0.0
            };
            top += if before.is_some() { PADDING } else { 0.0 };
        }
        tops.push(top);
        top += GAP
            + match item {
                Item::Box(one) => boxes[*one].height,
                Item::Passing(_) => LINE,
            };
    }
    tops
}

/// Where the top of an item should be for its lines to be level, on the average.
fn wanted(links: &[Link], grid: &Grid, places: &Places, column: usize, item: Item) -> f64 {
    let mut sum = 0.0;
    let mut count = 0.0;
    for (link, path) in links.iter().zip(&grid.paths) {
        let first = path.iter().position(|one| *one == item);
        let Some(_) = first else { continue };
        for (index, one) in path.iter().enumerate() {
            let here = column_of(grid, path, index);
            if *one != item || here != column {
                continue;
            }
            let own = end(link, path, index);
            for beside in [index.checked_sub(1), Some(index + 1)]
                .into_iter()
                .flatten()
            {
                if let Some(other) = path.get(beside) {
                    let there = column_of(grid, path, beside);
                    sum += places.top(grid, there, *other) + end(link, path, beside) - own;
                    count += 1.0;
                }
            }
        }
    }
    match count > 0.0 {
        true => sum / count,
        false => places.top(grid, column, item),
    }
}

/// The column of an item of a path: a path goes one column further with each.
fn column_of(grid: &Grid, path: &[Item], index: usize) -> usize {
    let first = path.first().copied();
    let first = grid
        .columns
        .iter()
        .position(|items| first.is_some_and(|one| items.contains(&one)));
    first.unwrap_or(0) + index
}

/// How far below the top of an item of its path a link goes in or out.
pub fn end(link: &Link, path: &[Item], index: usize) -> f64 {
    match index {
        0 => link.source_y,
        _ if index + 1 == path.len() => link.target_y,
        _ => LINE / 2.0,
    }
}

/// The tops nearest to those wanted (by least squares) with which nothing overlaps: isotonic
/// regression by pooling adjacent violators.
fn spread(wanted: &[f64], offsets: &[f64]) -> Vec<f64> {
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (wanted, offset) in wanted.iter().zip(offsets) {
        pools.push((wanted - offset, 1));
        while let [.., before, last] = pools.as_slice()
            && before.0 > last.0
        {
            let count = before.1 + last.1;
            let mean = (before.0 * before.1 as f64 + last.0 * last.1 as f64) / count as f64;
            pools.truncate(pools.len() - 2);
            pools.push((mean, count));
        }
    }
    let levels = pools
        .iter()
        .flat_map(|(level, count)| std::iter::repeat_n(*level, *count));
    levels
        .zip(offsets)
        .map(|(level, offset)| level + offset)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_moved_no_farther_than_needed() {
        let offsets = [0.0, 10.0, 20.0];
        assert_eq!(spread(&[0.0, 50.0, 90.0], &offsets), [0.0, 50.0, 90.0]);
        assert_eq!(spread(&[5.0, 5.0, 90.0], &offsets), [0.0, 10.0, 90.0]);
        assert_eq!(spread(&[30.0, 30.0, 30.0], &offsets), [20.0, 30.0, 40.0]);
        assert_eq!(spread(&[], &[]), Vec::<f64>::new());
    }
}
