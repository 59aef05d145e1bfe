//! Contour lines of a grid whose nodes need not all have a value: marching squares, the crossings chained into lines.

use std::collections::BTreeMap;

/// A line through positions counted in steps of the grid, along the first axis and along the second. A closed line ends
/// where it begins.
pub type Line = Vec<[f64; 2]>;

/// Edges of the grid, by number: that from node `k` along the first axis is `2 k`, that along the second axis
/// `2 k + 1`.
type Edge = usize;

/// The lines on which a function has the value `level`, linear along the edges of the grid.
///
/// `values` are those of the nodes, along the first axis fastest, `columns` to a row, infinite or NaN where there is
/// none; a cell with such a corner is left out, so that lines end at its border. In a cell whose diagonals lie on
/// different sides of the level the mean of its corners decides which corners belong together. Open lines come first,
/// each group in the order of its first edges.
pub fn contour(columns: usize, values: &[f64], level: f64) -> Vec<Line> {
    let mut links: BTreeMap<Edge, [Option<Edge>; 2]> = BTreeMap::new();
    if columns < 2 {
        return Vec::new();
    }
    for node in 0..values.len().saturating_sub(columns) {
        if node % columns + 1 < columns {
            for (from, to) in segments(columns, values, level, node).into_iter().flatten() {
                link(&mut links, from, to);
                link(&mut links, to, from);
            }
        }
    }
    let mut lines = Vec::new();
    let ends: Vec<Edge> = links.iter().filter(|(_, [_, second])| second.is_none()).map(|(edge, _)| *edge).collect();
    for first in ends {
        if let Some(edges) = follow(&mut links, first) {
            lines.push(edges);
        }
    }
    while let Some(first) = links.first_key_value().map(|(edge, _)| *edge) {
        if let Some(mut edges) = follow(&mut links, first) {
            edges.push(first);
            lines.push(edges);
        }
    }
    let crossing = |edge: &Edge| crossing(columns, values, level, *edge);
    lines.into_iter().map(|edges| edges.iter().map(crossing).collect()).collect()
}

/// The pieces of the lines inside the cell whose first corner is `node`, as pairs of edges.
fn segments(columns: usize, values: &[f64], level: f64, node: usize) -> [Option<(Edge, Edge)>; 2] {
    let corners = [node, node + 1, node + columns + 1, node + columns].map(|corner| values[corner]);
    if corners.iter().any(|value| !value.is_finite()) {
        return [None, None];
    }
    // Edges in the order of the corners they start from, anticlockwise.
    let edges = [2 * node, 2 * (node + 1) + 1, 2 * (node + columns), 2 * node + 1];
    let above = corners.map(|value| value >= level);
    let mut crossed = (0..4).filter(|k| above[*k] != above[(k + 1) % 4]).map(|k| edges[k]);
    match [crossed.next(), crossed.next(), crossed.next()] {
        [Some(from), Some(to), None] => [Some((from, to)), None],
        [Some(_), Some(_), Some(_)] => {
            let middle = corners.iter().map(|value| value / 4.0).sum::<f64>() >= level;
            // Lines cut off the corners that are on the other side than the middle.
            let [first, second] = if above[0] == middle { [1, 3] } else { [0, 2] };
            [first, second].map(|corner: usize| Some((edges[(corner + 3) % 4], edges[corner])))
        }
        _ => [None, None],
    }
}

fn link(links: &mut BTreeMap<Edge, [Option<Edge>; 2]>, from: Edge, to: Edge) {
    let ends = links.entry(from).or_default();
    if ends[0].is_none() { ends[0] = Some(to) } else { ends[1] = Some(to) }
}

/// Takes the edges of a line from an end of it, or from any edge of a closed line; `None` where they are taken already.
fn follow(links: &mut BTreeMap<Edge, [Option<Edge>; 2]>, first: Edge) -> Option<Vec<Edge>> {
    let mut edges = vec![first];
    let mut next = links.remove(&first)?;
    while let Some(edge) = next.into_iter().flatten().find(|edge| links.contains_key(edge)) {
        edges.push(edge);
        next = links.remove(&edge)?;
    }
    Some(edges)
}

/// Where the level is passed on an edge.
fn crossing(columns: usize, values: &[f64], level: f64, edge: Edge) -> [f64; 2] {
    let node = edge / 2;
    let (column, row) = ((node % columns) as f64, (node / columns) as f64);
    let along_first = edge.is_multiple_of(2);
    let (from, to) = (values[node], values[if along_first { node + 1 } else { node + columns }]);
    let part = (level - from) / (to - from);
    if along_first { [column + part, row] } else { [column, row + part] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    const NONE: f64 = f64::INFINITY;

    /// A field over 41 x 41 nodes, a tenth apart, about zero.
    fn field(of: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let at = |k: usize| k as f64 / 10.0 - 2.0;
        (0..41 * 41).map(|node| of(at(node % 41), at(node / 41))).collect()
    }

    fn area(line: &[[f64; 2]]) -> f64 {
        line.windows(2).map(|pair| pair[0][0] * pair[1][1] - pair[1][0] * pair[0][1]).sum::<f64>().abs() / 2.0
    }

    #[test]
    fn a_bowl_has_one_closed_line_at_the_right_radius() {
        for radius in [0.33_f64, 1.0, 1.77] {
            let lines = contour(41, &field(|x, y| x * x + y * y), radius * radius);
            let [line] = &lines[..] else { panic!("{} lines", lines.len()) };
            assert_eq!(line.first(), line.last());
            for [x, y] in line {
                // Between nodes 0.1 apart the chord of x^2 is off by 0.1^2 / 4 at most, and so is the square of the
                // radius.
                let squared = ((x / 10.0 - 2.0).powi(2) + (y / 10.0 - 2.0).powi(2) - radius * radius).abs();
                assert!(squared <= 0.0025 + 1e-12, "{squared}");
            }
            let expected = PI * radius * radius * 100.0;
            assert!((area(line) / expected - 1.0).abs() < 0.005 / (radius * radius), "{} {expected}", area(line));
        }
    }

    #[test]
    fn a_plane_has_one_straight_open_line() {
        let lines = contour(41, &field(|x, y| x + 2.0 * y), 0.33);
        let [line] = &lines[..] else { panic!("{} lines", lines.len()) };
        assert_ne!(line.first(), line.last());
        for [x, y] in line {
            assert!(((x / 10.0 - 2.0) + 2.0 * (y / 10.0 - 2.0) - 0.33).abs() < 1e-12);
        }
        // From the left border to the right one.
        let mut ends = [line[0][0], line[line.len() - 1][0]];
        ends.sort_by(f64::total_cmp);
        assert_eq!(ends, [0.0, 40.0]);
    }

    #[test]
    fn nodes_without_a_value_are_not_crossed() {
        let gap = |x: f64, y: f64| x > 0.95 && y.abs() < 0.15;
        for none in [NONE, f64::NAN] {
            let lines = contour(41, &field(|x, y| if gap(x, y) { none } else { x * x + y * y }), 1.0);
            let [line] = &lines[..] else { panic!("{} lines", lines.len()) };
            assert_ne!(line.first(), line.last());
            // The masked nodes are rows 19 to 21 from column 30: cells from column 29 and from row 18 to 21 are left
            // out.
            let inside = |[x, y]: &[f64; 2]| *x > 29.0 && *y > 18.0 && *y < 22.0;
            assert!(!line.iter().any(inside));
            assert!(line.iter().flatten().all(|position| position.is_finite()));
        }
        assert!(contour(2, &[NONE; 4], 1.0).is_empty());
        assert!(contour(1, &[0.0, 2.0, 0.0], 1.0).is_empty() && contour(3, &[0.0, 2.0, 0.0], 1.0).is_empty());
        assert!(contour(0, &[], 1.0).is_empty());
    }

    #[test]
    fn the_mean_decides_a_saddle() {
        // High corners lower left and upper right.
        let saddle = |level| contour(2, &[3.0, 0.0, 0.0, 3.0], level);
        let rounded = |lines: Vec<Line>| -> Vec<Line> {
            lines.into_iter().map(|line| line.into_iter().map(|position| position.map(round)).collect()).collect()
        };
        // Below the mean the high corners belong together: the low corners are cut off.
        assert_eq!(rounded(saddle(1.2)), [[[0.6, 0.0], [1.0, 0.4]], [[0.0, 0.6], [0.4, 1.0]]]);
        assert_eq!(rounded(saddle(1.8)), [[[0.4, 0.0], [0.0, 0.4]], [[1.0, 0.6], [0.6, 1.0]]]);
    }

    fn round(value: f64) -> f64 {
        (value * 1e9).round() / 1e9
    }

    proptest! {
        /// Every edge of the grid whose ends lie on different sides, beside a cell with four values, is crossed once by
        /// one line; lines end only at the border of what has values.
        #[test]
        fn every_crossing_is_on_one_line(
            columns in 2..9_usize,
            nodes in prop::collection::vec(prop_oneof![1 => Just(NONE), 6 => (0..8_u32).prop_map(|k| f64::from(k) + 0.5)], 0..70),
            level in 1..8_u32,
        ) {
            let rows = nodes.len() / columns;
            let values = &nodes[..rows * columns];
            let level = f64::from(level);
            let lines = contour(columns, values, level);
            let whole = |column: usize, row: usize| {
                column + 1 < columns && row + 1 < rows
                    && [0, 1, columns, columns + 1].iter().all(|k| values[row * columns + column + k].is_finite())
            };
            let mut expected: Vec<([f64; 2], bool)> = Vec::new();
            for node in 0..values.len() {
                let (column, row) = (node % columns, node / columns);
                for edge in [2 * node, 2 * node + 1] {
                    let (other, beside) = if edge.is_multiple_of(2) {
                        (column + 1 < columns, [Some((column, row)), row.checked_sub(1).map(|row| (column, row))])
                    } else {
                        (row + 1 < rows, [Some((column, row)), column.checked_sub(1).map(|column| (column, row))])
                    };
                    let cells = beside.into_iter().flatten().filter(|(column, row)| other && whole(*column, *row)).count();
                    let end = if edge.is_multiple_of(2) { node + 1 } else { node + columns };
                    if cells > 0 && (values[node] >= level) != (values[end] >= level) {
                        expected.push((crossing(columns, values, level, edge), cells == 1));
                    }
                }
            }
            let mut found: Vec<([f64; 2], bool)> = Vec::new();
            for line in &lines {
                prop_assert!(line.len() >= 2);
                let closed = line.len() > 2 && line[0] == line[line.len() - 1];
                for (k, point) in line.iter().enumerate().skip(usize::from(closed)) {
                    found.push((*point, !closed && (k == 0 || k + 1 == line.len())));
                }
            }
            let order = |a: &([f64; 2], bool), b: &([f64; 2], bool)| {
                a.0[0].total_cmp(&b.0[0]).then(a.0[1].total_cmp(&b.0[1])).then(a.1.cmp(&b.1))
            };
            expected.sort_by(order);
            found.sort_by(order);
            prop_assert_eq!(found, expected);
        }
    }
}
