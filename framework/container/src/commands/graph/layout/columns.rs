//! Which box stands in which column.

use super::Link;

/// Columns of all boxes, and which links lead back.
pub struct Columns {
    /// Counted from the left, from 0.
    pub of_box: Vec<usize>,
    /// For each link.
    pub leads_back: Vec<bool>,
}

/// As few columns as there can be with every link leading to the right, but for those that close a
/// circle.
pub fn columns(count: usize, links: &[Link]) -> Columns {
    let leads_back = circles(count, links);
    let forward = || {
        let all = links.iter().zip(&leads_back);
        all.filter(|(_, back)| !**back).map(|(link, _)| link)
    };
    let mut of_box = vec![0; count];
    // A path has at most so many links as there are boxes.
    for _ in 0..count {
        for link in forward() {
            of_box[link.target] = of_box[link.target].max(of_box[link.source] + 1);
        }
    }
    // Whoever sends at least as much as it gets stands as near to its readers as it can.
    for _ in 0..count {
        for one in 0..count {
            let sent = forward().filter(|link| link.source == one);
            let got = forward().filter(|link| link.target == one).count();
            let nearest = sent.clone().map(|link| of_box[link.target]).min();
            if let Some(nearest) = nearest
                && sent.count() >= got
            {
                of_box[one] = nearest - 1;
            }
        }
    }
    Columns { of_box, leads_back }
}

/// Which links lead back to a box that they come from, in the order of boxes.
fn circles(count: usize, links: &[Link]) -> Vec<bool> {
    let mut leads_back = vec![false; links.len()];
    let mut done = vec![false; count];
    for root in 0..count {
        let mut path = vec![(root, 0)];
        let mut on_path = vec![false; count];
        while let Some((one, next)) = path.last_mut() {
            let one = *one;
            on_path[one] = true;
            let found = (*next..links.len()).find(|index| links[*index].source == one);
            match found {
                Some(index) => {
                    *next = index + 1;
                    let target = links[index].target;
                    if on_path[target] {
                        leads_back[index] = true;
                    } else if !done[target] {
                        path.push((target, 0));
                    }
                }
                None => {
                    path.pop();
                    on_path[one] = false;
                    done[one] = true;
                }
            }
        }
    }
    leads_back
}
