//! In which order the boxes of a column stand, so that few lines cross.

use super::columns::Columns;
use super::{Group, Link};

/// How often the order is made better; it settles within a few sweeps.
const SWEEPS: usize = 12;

/// Something that takes room in a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Item {
    /// A box.
    Box(usize),
    /// A link that passes.
    Passing(usize),
}

/// Everything in columns, from top to bottom.
pub struct Grid {
    /// Columns from left to right.
    pub columns: Vec<Vec<Item>>,
    /// For each link whether it leads back.
    pub leads_back: Vec<bool>,
    /// For each link that does not: what it goes through, from its source to its target.
    pub paths: Vec<Vec<Item>>,
}

/// Orders by the mean place of neighbours, alternately those to the left and to the right. Members of
/// a group stay together.
pub fn order(count: usize, links: &[Link], groups: &[Group], columns: &Columns) -> Grid {
    let mut grid = unordered(count, links, columns);
    let group_of = |item: Item| match item {
        Item::Box(one) => groups.iter().position(|group| group.members.contains(&one)),
        Item::Passing(_) => None,
    };
    for sweep in 0..SWEEPS {
        let to_right = sweep % 2 == 0;
        for step in 1..grid.columns.len() {
            let (column, beside) = match to_right {
                true => (step, step - 1),
                false => (grid.columns.len() - 1 - step, grid.columns.len() - step),
            };
            let places = &grid.columns[beside];
            let wanted = |item: Item| mean_place(&grid.paths, places, item, to_right);
            let items = grid.columns[column].clone();
            let own: Vec<f64> = (items.iter().enumerate())
                .map(|(place, item)| wanted(*item).unwrap_or(place as f64))
                .collect();
            let of_group = |group: usize| {
                let members = items.iter().zip(&own);
                let members = members.filter(|(item, _)| group_of(**item) == Some(group));
                let members: Vec<f64> = members.map(|(_, place)| *place).collect();
                members.iter().sum::<f64>() / members.len().max(1) as f64
            };
            let mut sorted: Vec<(f64, usize, f64, usize)> = (items.iter().enumerate())
                .map(|(place, item)| match group_of(*item) {
                    Some(group) => (of_group(group), group + 1, own[place], place),
                    None => (own[place], 0, own[place], place),
                })
                .collect();
            sorted.sort_by(|one, other| {
                let by = one.0.total_cmp(&other.0).then(one.1.cmp(&other.1));
                by.then(one.2.total_cmp(&other.2)).then(one.3.cmp(&other.3))
            });
            grid.columns[column] = sorted.iter().map(|(.., place)| items[*place]).collect();
        }
    }
    grid
}

fn unordered(count: usize, links: &[Link], columns: &Columns) -> Grid {
    let width = columns.of_box.iter().max().map_or(0, |last| last + 1);
    let mut grid = Grid {
        columns: vec![Vec::new(); width],
        leads_back: columns.leads_back.clone(),
        paths: vec![Vec::new(); links.len()],
    };
    for one in 0..count {
        grid.columns[columns.of_box[one]].push(Item::Box(one));
    }
    for (index, link) in links.iter().enumerate() {
        if columns.leads_back[index] {
            continue;
        }
        grid.paths[index].push(Item::Box(link.source));
        let between = columns.of_box[link.source] + 1..columns.of_box[link.target];
        for column in between {
            grid.columns[column].push(Item::Passing(index));
            grid.paths[index].push(Item::Passing(index));
        }
        grid.paths[index].push(Item::Box(link.target));
    }
    grid
}

/// Mean place in the column beside of what an item is linked with there.
fn mean_place(paths: &[Vec<Item>], beside: &[Item], item: Item, to_right: bool) -> Option<f64> {
    let place = |other: Item| beside.iter().position(|one| *one == other);
    let mut found = Vec::new();
    for path in paths {
        for two in path.windows(2) {
            let (own, other) = match to_right {
                true => (two[1], two[0]),
                false => (two[0], two[1]),
            };
            if own == item {
                found.extend(place(other));
            }
        }
    }
    let sum: usize = found.iter().sum();
    (!found.is_empty()).then(|| sum as f64 / found.len() as f64)
}
