//! The mesh of the shipped cell, `configs/cells/stepped-part.stl`: a slab with a stepped shoulder whose top is wavy.
//! The walls of the steps are 8 mm, the radius of the cutter, beside the path `tasks/five-segments.csv`, which runs on
//! the slab.

use super::*;
use crate::testing::root;

/// Ends of the cells of the grid in which the surface is made, mm: between two marks so many cells.
const X: ([f64; 5], [usize; 4]) = ([-260.0, -184.0, 16.0, 216.0, 260.0], [3, 8, 7, 2]);
const Y: ([f64; 4], [usize; 3]) = ([-260.0, 16.0, 216.0, 460.0], [8, 6, 7]);
/// Height of the slab's upper and lower side. mm
const SLAB: [f64; 2] = [0.0, -60.0];

fn lines(marks: &[f64], counts: &[usize]) -> Vec<f64> {
    let steps = marks.windows(2).zip(counts);
    let inner = steps
        .flat_map(|(ends, count)| (0..*count).map(move |k| ends[0] + (ends[1] - ends[0]) * k as f64 / *count as f64));
    inner.chain(marks.last().copied()).collect()
}

/// Whether the shoulder is there, for a point within a cell. mm
fn is_shoulder(x: f64, y: f64) -> bool {
    x > 216.0 || (x > 16.0 && y > 16.0) || (x > -184.0 && y > 216.0)
}

/// Height of the shoulder. mm
fn top(x: f64, y: f64) -> f64 {
    25.0 + 12.0 * libm::sin(x / 60.0) * libm::cos(y / 70.0)
}

/// The triangles, facing outwards. mm
fn triangles() -> Vec<[Vector3<f64>; 3]> {
    let (xs, ys) = (lines(&X.0, &X.1), lines(&Y.0, &Y.1));
    let mut triangles = Vec::new();
    let mut quad = |a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]| {
        triangles.extend([[a, b, c], [a, c, d]].map(|corners| corners.map(Vector3::from)));
    };
    let within = |i: usize, j: usize| is_shoulder((xs[i] + xs[i + 1]) / 2.0, (ys[j] + ys[j + 1]) / 2.0);
    for i in 0..xs.len() - 1 {
        for j in 0..ys.len() - 1 {
            let is_high = within(i, j);
            let height = |x: f64, y: f64| if is_high { top(x, y) } else { SLAB[0] };
            let corners = [[xs[i], ys[j]], [xs[i + 1], ys[j]], [xs[i + 1], ys[j + 1]], [xs[i], ys[j + 1]]];
            let [a, b, c, d] = corners.map(|[x, y]| [x, y, height(x, y)]);
            quad(a, b, c, d);
            let [a, b, c, d] = corners.map(|[x, y]| [x, y, SLAB[1]]);
            quad(a, d, c, b);
            // Over each side of the cell, counterclockwise: down to the neighbour, or to the lower side at the end of
            // the slab.
            let neighbours = [(i, j.wrapping_sub(1)), (i + 1, j), (i, j + 1), (i.wrapping_sub(1), j)];
            for (side, (ni, nj)) in neighbours.into_iter().enumerate() {
                let ([x0, y0], [x1, y1]) = (corners[side], corners[(side + 1) % 4]);
                let mut wall = |low: [f64; 2], high: [f64; 2]| {
                    quad([x0, y0, low[0]], [x1, y1, low[1]], [x1, y1, high[1]], [x0, y0, high[0]]);
                };
                let upper = [height(x0, y0), height(x1, y1)];
                let is_end = ni >= xs.len() - 1 || nj >= ys.len() - 1;
                if is_high && (is_end || !within(ni, nj)) {
                    wall([SLAB[0]; 2], upper);
                }
                if is_end {
                    wall([SLAB[1]; 2], [SLAB[0]; 2]);
                }
            }
        }
    }
    triangles
}

/// As a binary STL.
fn stl() -> Vec<u8> {
    let triangles = triangles();
    let mut bytes = b"Stepped part of the shipped cell, mm".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for [a, b, c] in triangles {
        let normal = (b - a).cross(&(c - a)).normalize();
        let numbers = [normal, a, b, c];
        bytes.extend(numbers.iter().flatten().flat_map(|value| (*value as f32).to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

#[test]
fn the_shipped_part_is_closed_and_made_as_here() {
    let file = root().join("configs/cells/stepped-part.stl");
    let mesh = read_mesh(&file, &stl(), MeshUnit::Millimetre).unwrap();
    assert!(mesh.is_closed());
    assert!((1900..2100).contains(&mesh.triangles().len()), "{}", mesh.triangles().len());
    assert!(std::fs::read(&file).unwrap() == stl(), "renew it: cargo test -- --ignored write_the_shipped_part");
}

#[test]
#[ignore = "writes configs/cells/stepped-part.stl"]
fn write_the_shipped_part() {
    std::fs::write(root().join("configs/cells/stepped-part.stl"), stl()).unwrap();
}
