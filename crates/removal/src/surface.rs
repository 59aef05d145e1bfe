//! The surface of what is left of the stock, thinned, to be seen.

use crate::lattice::others;
use crate::removal::Workpiece;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Triangles that face out of the stock. m
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surface {
    /// Vertices.
    pub vertices: Vec<Vector3<f64>>,
    /// Three vertices each, from 0.
    pub triangles: Vec<[u32; 3]>,
}

/// Grid lines along the longest side of the stock.
const FINE: f64 = 64.0;

/// A grid over the stock with a layer around it: how far each node is inside, along the axis in which that is least.
struct Grid {
    low: Vector3<f64>,
    step: f64,
    counts: [usize; 3],
    inside: Vec<f64>,
}

impl Grid {
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn new(workpiece: &Workpiece) -> Self {
        let [low, high] = workpiece.body.extent;
        let size = high - low;
        let step = (size.max() / FINE).max(workpiece.cell);
        let counts = [0, 1, 2].map(|k| (size[k] / step).ceil() as usize + 3);
        // Even on both sides, so that no node is on a side.
        let low = Vector3::from_fn(|k, _| low[k] - ((counts[k] - 1) as f64 * step - size[k]) / 2.0);
        let mut grid = Self { low, step, counts, inside: vec![f64::INFINITY; counts.iter().product()] };
        let mut made = BTreeMap::new();
        for axis in 0..3 {
            let [a, b] = others(axis);
            for i in 0..counts[a] {
                for j in 0..counts[b] {
                    let mut node = [0; 3];
                    (node[a], node[b]) = (i, j);
                    let left = workpiece.left_of(axis, &grid.place(node), &mut made);
                    for k in 0..counts[axis] {
                        node[axis] = k;
                        let at = grid.place(node)[axis];
                        let within = |[from, to]: &[f64; 2]| (at - from).min(to - at);
                        let inside = left.iter().map(within).fold(f64::NEG_INFINITY, f64::max).max(-step);
                        let number = grid.number(node);
                        if inside.abs() < grid.inside[number].abs() {
                            grid.inside[number] = inside;
                        }
                    }
                }
            }
        }
        grid
    }

    fn number(&self, node: [usize; 3]) -> usize {
        (node[0] * self.counts[1] + node[1]) * self.counts[2] + node[2]
    }

    fn place(&self, node: [usize; 3]) -> Vector3<f64> {
        self.low + Vector3::from_fn(|k, _| node[k] as f64 * self.step)
    }

    fn at(&self, node: [usize; 3]) -> f64 {
        self.inside[self.number(node)]
    }
}

/// The surface between nodes inside and outside: a vertex in every cell that it passes, at the mean of its crossings.
pub fn surface(workpiece: &Workpiece) -> Surface {
    let grid = Grid::new(workpiece);
    let [nx, ny, nz] = grid.counts.map(|count| count - 1);
    let nodes = |first: usize| {
        (first..nx).flat_map(move |i| (first..ny).flat_map(move |j| (first..nz).map(move |k| [i, j, k])))
    };
    let mut of_cell = vec![u32::MAX; grid.inside.len()];
    let mut surface = Surface::default();
    let corner = |[i, j, k]: [usize; 3], bits: usize| [i + (bits & 1), j + (bits >> 1 & 1), k + (bits >> 2 & 1)];
    for node in nodes(0) {
        let (mut sum, mut count) = (Vector3::zeros(), 0.0);
        for from in 0..8 {
            for axis in 0..3 {
                let to = from | 1 << axis;
                let (a, b) = (corner(node, from), corner(node, to));
                let (at, other) = (grid.at(a), grid.at(b));
                if to == from || (at > 0.0) == (other > 0.0) {
                    continue;
                }
                let share = at / (at - other);
                sum += grid.place(a) * (1.0 - share) + grid.place(b) * share;
                count += 1.0;
            }
        }
        if count > 0.0 {
            of_cell[grid.number(node)] = surface.vertices.len() as u32;
            surface.vertices.push(sum / count);
        }
    }
    for node in nodes(1) {
        for axis in 0..3 {
            let mut next = node;
            next[axis] += 1;
            let is_in = grid.at(node) > 0.0;
            if is_in == (grid.at(next) > 0.0) {
                continue;
            }
            let [a, b] = others(axis);
            let cell = |back_a: usize, back_b: usize| {
                let mut cell = node;
                cell[a] -= back_a;
                cell[b] -= back_b;
                of_cell[grid.number(cell)]
            };
            let mut around = [cell(1, 1), cell(0, 1), cell(0, 0), cell(1, 0)];
            if !is_in {
                around.reverse();
            }
            let [p, q, r, s] = around;
            surface.triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    surface
}
