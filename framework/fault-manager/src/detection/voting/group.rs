//! Values out of groups of sources. Indices are those of usable sources, so every value is finite.

use super::SourceValue;

/// The value of the first of two sources that agree.
pub(super) fn agreeing_pair(
    sources: &[SourceValue],
    indices: &[usize],
    tolerance: f64,
) -> Option<f64> {
    let &[first, second] = indices else {
        return None;
    };
    let (first, second) = (sources[first].value, sources[second].value);
    ((first - second).abs() <= tolerance).then_some(first)
}

/// The middle value of at least one source; the order of `indices` is lost.
pub(super) fn median(sources: &[SourceValue], indices: &mut [usize]) -> f64 {
    let by_value = |one: &usize, other: &usize| {
        let order = sources[*one].value.total_cmp(&sources[*other].value);
        order.then(one.cmp(other))
    };
    indices.sort_unstable_by(by_value);
    let upper = indices.len() / 2;
    let middle = match indices.len() % 2 {
        0 => indices[upper - 1].min(indices[upper]),
        _ => indices[upper],
    };
    sources[middle].value
}

/// The mean of the largest group that agrees with one of its members; none if nobody agrees with
/// anybody.
pub(super) fn majority(sources: &[SourceValue], indices: &[usize], tolerance: f64) -> Option<f64> {
    let group = |centre: usize| {
        let centre = sources[centre].value;
        let values = indices.iter().map(|index| sources[*index].value);
        values.filter(move |value| (value - centre).abs() <= tolerance)
    };
    let (_, centre) = indices
        .iter()
        .map(|index| (group(*index).count(), *index))
        .filter(|(size, _)| *size >= 2)
        .reduce(|best, next| if next.0 > best.0 { next } else { best })?;
    let count = group(centre).count() as f64;
    // Divided first: the sum of large values may be none.
    Some(group(centre).map(|value| value / count).sum())
}

/// The mean by weight of those that agree with it: the one farthest off is left out until the rest
/// agree. None if no two do. The order of `indices` is kept, those left out are removed.
pub(super) fn weighted(
    sources: &[SourceValue],
    indices: &mut Vec<usize>,
    tolerance: f64,
) -> Option<f64> {
    while indices.len() >= 2 {
        let mean = weighted_mean(sources, indices);
        let distance = |index: usize| (sources[index].value - mean).abs();
        let (position, farthest) = indices
            .iter()
            .enumerate()
            .map(|(position, index)| (position, distance(*index)))
            .reduce(|worst, next| if next.1 >= worst.1 { next } else { worst })?;
        if farthest <= tolerance {
            return Some(mean);
        }
        indices.remove(position);
    }
    None
}

/// Weights that are all zero count equally; one that is no positive number counts nothing.
fn weighted_mean(sources: &[SourceValue], indices: &[usize]) -> f64 {
    let weight = |index: usize| {
        let weight = sources[index].weight;
        if weight > 0.0 && weight.is_finite() {
            weight
        } else {
            0.0
        }
    };
    let largest = indices
        .iter()
        .fold(0.0, |largest, index| weight(*index).max(largest));
    let share = |index: usize| {
        if largest > 0.0 {
            weight(index) / largest
        } else {
            1.0
        }
    };
    let total: f64 = indices.iter().map(|index| share(*index)).sum();
    let parts = indices
        .iter()
        .map(|index| sources[*index].value * (share(*index) / total));
    parts.sum()
}
