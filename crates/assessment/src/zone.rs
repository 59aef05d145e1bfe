//! Square zones of a map: where the largest circularity inside is smallest, and the zones in the middle of what can be
//! reached (Klimchik 2017, Tables 6 and 7).
//!
//! The largest value over every square of a size is a sliding-window maximum along each axis in turn, so that the cost
//! is linear in the number of nodes, whatever the size.

use super::map::Grid;
use serde::Serialize;
use std::collections::VecDeque;

/// A square of nodes, all of them with a value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Zone {
    /// Centre of the square, in the coordinates of the grid. m
    pub centre: [f64; 2],
    /// Side of the square. m
    pub side: f64,
    /// Largest value of its nodes. m
    pub largest: f64,
}

/// The zone of `intervals` grid steps a side whose largest value is smallest; `None` where no such square has values at
/// all its nodes. `values` are in the order of [`Grid::place`], infinite where there is none. Of several equal ones it
/// is the first in that order.
pub fn optimal(grid: &Grid, values: &[f64], intervals: usize) -> Option<Zone> {
    let [columns, rows] = grid.counts;
    let side = intervals + 1;
    if side > columns || side > rows {
        return None;
    }
    let across: Vec<Vec<f64>> =
        values.chunks_exact(columns).map(|row| window_maxima(row.iter().copied(), side)).collect();
    let mut best: Option<([usize; 2], f64)> = None;
    for column in 0..=columns - side {
        let down = window_maxima(across.iter().map(|row| row[column]), side);
        for (row, largest) in down.into_iter().enumerate() {
            let better = best.is_none_or(|([_, best_row], min)| largest < min || (largest == min && row < best_row));
            if largest.is_finite() && better {
                best = Some(([column, row], largest));
            }
        }
    }
    best.map(|(corner, largest)| zone(grid, corner, intervals, largest))
}

/// The zone of `intervals` steps a side about a node of the grid (column and row); `None` where a node of it has no
/// value or is off the grid. With an odd number of steps the centre is half a step below the node on both axes.
pub fn about(grid: &Grid, values: &[f64], node: [usize; 2], intervals: usize) -> Option<Zone> {
    let before = intervals.div_ceil(2);
    let corner = [node[0].checked_sub(before)?, node[1].checked_sub(before)?];
    if corner[0] + intervals >= grid.counts[0] || corner[1] + intervals >= grid.counts[1] {
        return None;
    }
    let rows = (corner[1]..=corner[1] + intervals).map(|row| row * grid.counts[0] + corner[0]);
    let largest =
        rows.flat_map(|first| &values[first..=first + intervals]).fold(f64::NEG_INFINITY, |max, v| max.max(*v));
    largest.is_finite().then(|| zone(grid, corner, intervals, largest))
}

/// The middle of what has a value: the node (column and row) at the centre of the largest square of nodes that all have
/// one. Of several such squares it is the one nearest to the centroid of all nodes with a value; a square of an even
/// number of nodes has its centre at the upper of the two middle ones. `None` where no node has a value.
pub fn middle(grid: &Grid, values: &[f64]) -> Option<[usize; 2]> {
    let [columns, _] = grid.counts;
    let (mut count, mut sum) = (0.0, [0.0, 0.0]);
    let mut largest = 0;
    // Side of the largest square whose last corner is the node, one row at a time.
    let mut sides = vec![0_usize; values.len()];
    for index in 0..values.len() {
        if !values[index].is_finite() {
            continue;
        }
        let (column, row) = (index % columns, index / columns);
        let edge = column == 0 || row == 0;
        let before = [index.wrapping_sub(1), index.wrapping_sub(columns), index.wrapping_sub(columns + 1)];
        sides[index] = if edge { 1 } else { 1 + before.map(|k| sides[k]).into_iter().min().unwrap_or(0) };
        largest = largest.max(sides[index]);
        count += 1.0;
        sum = [sum[0] + column as f64, sum[1] + row as f64];
    }
    let centroid = sum.map(|part| part / count);
    let off = |[column, row]: [usize; 2]| {
        let (x, y) = (column as f64 - centroid[0], row as f64 - centroid[1]);
        x * x + y * y
    };
    let half = |last: usize| last - (largest - 1) / 2;
    let squares = (0..values.len()).filter(|index| largest > 0 && sides[*index] == largest);
    squares.map(|index| [half(index % columns), half(index / columns)]).min_by(|a, b| off(*a).total_cmp(&off(*b)))
}

fn zone(grid: &Grid, corner: [usize; 2], intervals: usize, largest: f64) -> Zone {
    let half = intervals as f64 / 2.0;
    Zone { centre: grid.at(corner.map(|node| node as f64 + half)), side: grid.step * intervals as f64, largest }
}

/// The largest of every `width` neighbours, from the first to the last such window.
fn window_maxima(values: impl Iterator<Item = f64>, width: usize) -> Vec<f64> {
    // Candidates for the largest of the windows to come: later and smaller ones behind.
    let mut candidates: VecDeque<(usize, f64)> = VecDeque::with_capacity(width);
    let mut maxima = Vec::new();
    for (index, value) in values.enumerate() {
        while candidates.back().is_some_and(|(_, last)| *last <= value) {
            candidates.pop_back();
        }
        candidates.push_back((index, value));
        if candidates.front().is_some_and(|(first, _)| first + width <= index) {
            candidates.pop_front();
        }
        if index + 1 >= width {
            maxima.extend(candidates.front().map(|(_, largest)| *largest));
        }
    }
    maxima
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BLOCKED: f64 = f64::INFINITY;

    /// All squares one after the other, all their nodes one after the other.
    fn nested_scan(grid: &Grid, values: &[f64], intervals: usize) -> Option<f64> {
        let mut min: Option<f64> = None;
        for row in 0..grid.counts[1].saturating_sub(intervals) {
            for column in 0..grid.counts[0].saturating_sub(intervals) {
                let mut largest = f64::NEG_INFINITY;
                for down in row..=row + intervals {
                    for across in column..=column + intervals {
                        largest = largest.max(values[down * grid.counts[0] + across]);
                    }
                }
                if largest.is_finite() {
                    min = Some(min.map_or(largest, |min| min.min(largest)));
                }
            }
        }
        min
    }

    fn grids() -> impl Strategy<Value = (Grid, Vec<f64>)> {
        (1..14_usize, 1..12_usize).prop_flat_map(|(columns, rows)| {
            let grid = Grid { origin: [0.3, -0.7], step: 0.1, counts: [columns, rows] };
            let node = prop_oneof![1 => Just(BLOCKED), 9 => (0..50_u32).prop_map(f64::from)];
            (Just(grid), prop::collection::vec(node, columns * rows))
        })
    }

    proptest! {
        #[test]
        fn the_optimal_zone_is_that_of_a_nested_scan((grid, values) in grids(), intervals in 0..6_usize) {
            let found = optimal(&grid, &values, intervals);
            prop_assert_eq!(found.map(|zone| zone.largest), nested_scan(&grid, &values, intervals));
            if let Some(zone) = found {
                // The zone is where it says it is.
                let corner = [0, 1].map(|axis| ((zone.centre[axis] - grid.origin[axis] - zone.side / 2.0) / grid.step).round() as usize);
                let middle = corner.map(|node| node + intervals.div_ceil(2));
                prop_assert_eq!(about(&grid, &values, middle, intervals), Some(zone));
            }
        }

        #[test]
        fn the_middle_is_in_the_largest_square((grid, values) in grids()) {
            let Some([column, row]) = middle(&grid, &values) else {
                prop_assert!(values.iter().all(|value| value.is_infinite()));
                return Ok(());
            };
            let max = (0..14).filter(|intervals| nested_scan(&grid, &values, *intervals).is_some()).max();
            // An odd number of steps has its middle node on the upper side, so that the zone about it is that square.
            prop_assert!(about(&grid, &values, [column, row], max.unwrap()).is_some());
            prop_assert!((0..14).filter(|intervals| about(&grid, &values, [column, row], *intervals).is_some()).max() == max);
        }
    }

    #[test]
    fn a_zone_does_not_reach_over_what_has_no_value() {
        let grid = Grid { origin: [0.0, 0.0], step: 1.0, counts: [4, 3] };
        #[rustfmt::skip]
        let values = [1.0, 2.0, BLOCKED, 0.5,
                      3.0, 4.0, 9.0, 0.5,
                      5.0, 6.0, 8.0, 0.5];
        let zone = optimal(&grid, &values, 1).unwrap();
        assert_eq!(zone, Zone { centre: [0.5, 0.5], side: 1.0, largest: 4.0 });
        assert_eq!(optimal(&grid, &values, 0).unwrap().centre, [3.0, 0.0]);
        assert_eq!(optimal(&grid, &values, 2), None);
        assert_eq!(optimal(&grid, &values, 9), None);
        assert_eq!(about(&grid, &values, [2, 1], 1), None);
        assert_eq!(about(&grid, &values, [3, 2], 1).unwrap().largest, 9.0);
    }
}
