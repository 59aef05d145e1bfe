//! Removed volumes against exact Booleans of meshes (manifold3d 3.5.4, `experiments/removed_volumes.py`), within 1 %.

use super::*;
use crate::operation::Stock;

/// A closed prism along z of an outline, anticlockwise, that is cut into convex parts by corner numbers. mm
fn prism(outline: &[[f64; 2]], walls: &[&[u32]], parts: &[&[u32]], [low, high]: [f64; 2]) -> Stock {
    let count = outline.len() as u32;
    let at = |z: f64| outline.iter().map(move |[x, y]| Vector3::new(*x, *y, z) / 1e3);
    let vertices: Vec<Vector3<f64>> = at(low).chain(at(high)).collect();
    let mut triangles = Vec::new();
    for part in parts {
        for k in 1..part.len() - 1 {
            let [a, b, c] = [part[0], part[k], part[k + 1]];
            triangles.extend([[a, c, b], [a + count, b + count, c + count]]);
        }
    }
    for wall in walls {
        for k in 0..wall.len() {
            let (a, b) = (wall[k], wall[(k + 1) % wall.len()]);
            triangles.extend([[a, b, b + count], [a, b + count, a + count]]);
        }
    }
    let mesh = TriangleMesh::new(&vertices, &triangles).unwrap();
    assert!(mesh.is_closed());
    Stock::Solid { solid: Solid::Mesh(mesh.into()), pose: Pose::identity() }
}

fn of(stock: Stock, mill: &EndMill, cuts: &[Vec<Knot>]) -> RemovalForces {
    let mut operations: Vec<_> =
        cuts.iter().map(|knots| operation(&line(knots, 4.0), mill, &Pose::identity())).collect();
    let last = operations.pop().unwrap();
    found(&ForcesProblem { stock, before: operations, operation: last, finished_part: None, cell: None, memory: 2e9 })
}

/// All that the cuts remove: each by itself, with those before it done before. mm3
fn removed(stock: &Stock, mill: &EndMill, cuts: &[Vec<Knot>]) -> f64 {
    (1..=cuts.len()).map(|count| of(stock.clone(), mill, &cuts[..count]).removed * 1e9).sum()
}

#[track_caller]
#[expect(clippy::print_stdout, reason = "the guide states what it prints")]
fn assert_removes(name: &str, found: f64, exact: f64) {
    println!("{name:44} {found:.1} for {exact:.1} mm3: {:+.2} %", (found / exact - 1.0) * 100.0);
    assert!((found / exact - 1.0).abs() < 0.01, "{name}: {found} for {exact}");
}

#[test]
fn volumes_are_those_of_exact_booleans_of_meshes() {
    let whole = || stock([[-60.0, -40.0, -15.0], [60.0, 40.0, 0.0]], &Pose::identity());
    let corner = vec![([-70.0, -20.0, -5.0], UP), ([20.0, -20.0, -5.0], UP), ([20.0, 45.0, -5.0], UP)];
    let found = removed(&whole(), &mill(16.0, 0.0, 0.0), &[corner]);
    assert_removes("flat, a corner in a box", found, 11131.595);

    let (sine, cosine) = libm::sincos(15_f64.to_radians());
    let lead = [sine, -0.1, cosine];
    let lines = [-6.0, -3.0, 0.0].map(|y| vec![([-25.0, y, -3.0], lead), ([25.0, y, -3.0], lead)]);
    let lying = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
    let cylinder = Stock::Solid {
        solid: Solid::Cylinder { radius: 30e-3, length: 80e-3 },
        pose: Pose { rotation: lying, translation: Vector3::new(0.0, 0.0, -30e-3) },
    };
    let found = removed(&cylinder, &mill(10.0, 5.0, 0.0), &lines);
    assert_removes("ball, three leaning lines over a cylinder", found, 690.510);

    let ramp = vec![([-45.0, 3.0, 2.0], UP), ([35.0, 3.0, -7.0], UP), ([35.0, -25.0, -7.0], UP)];
    let found = removed(&whole(), &mill(12.0, 2.0, 0.0), &[ramp]);
    assert_removes("bull nose, a ramp into a box", found, 5352.906);

    let outline = [[-40.0, -30.0], [40.0, -30.0], [40.0, -5.0], [0.0, -5.0], [0.0, 30.0], [-40.0, 30.0]];
    // From the inner corner all others are seen.
    let ell = prism(&outline, &[&[0, 1, 2, 3, 4, 5]], &[&[3, 4, 5, 0, 1, 2]], [-20.0, 0.0]);
    let across = vec![([-50.0, -35.0, -6.0], UP), ([50.0, 20.0, -6.0], UP)];
    let found = removed(&ell, &mill(4.0, 2.0, 10.0), &[across]);
    assert_removes("tapered ball, across a mesh like an L", found, 1267.927);

    let outline = [
        [-50.0, -30.0],
        [50.0, -30.0],
        [50.0, 0.0],
        [-50.0, 0.0],
        [-15.0, -22.0],
        [20.0, -22.0],
        [20.0, -2.0],
        [-15.0, -2.0],
    ];
    let sides: [&[u32]; 4] = [&[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
    let frame = prism(&outline, &[&[0, 1, 2, 3], &[7, 6, 5, 4]], &sides, [2.0, 22.0]);
    let leaning = |x: f64| {
        let (s, c) = libm::sincos((0.25 * x).to_radians());
        ([x, -3.0, 0.0], [0.0, s, c])
    };
    let wall = (-14..=14).map(|k| leaning(4.0 * f64::from(k))).collect();
    let found = removed(&frame, &mill(12.0, 0.0, 0.0), &[wall]);
    assert_removes("swarf, five axes, along a mesh with a hole", found, 13273.299);
}
