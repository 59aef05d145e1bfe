//! Stock from the path, against blocks of which the path says where they are.

use super::*;
use crate::operation::{PathStock, Stock};
use stead_model::task::{PathPoint, ToolPath};

/// The means of force (N) and removed section (mm2) over the scored points that cut, and the largest force. N
fn figures(found: &RemovalForces) -> [f64; 3] {
    let cuts: Vec<&PointForces> = found.points.iter().filter(|point| point.removed > 0.0).collect();
    let mean = |of: &dyn Fn(&PointForces) -> f64| cuts.iter().map(|point| of(point)).sum::<f64>() / cuts.len() as f64;
    [mean(&|point| point.at_feed(1.0).force.norm()), mean(&|point| point.removed * 1e6), largest(&found.points)]
}

fn with(problem: &ForcesProblem, depth_mm: Option<f64>, layer_mm: Option<f64>) -> RemovalForces {
    let metres = |mm: f64| mm * 1e-3;
    let stock = Stock::Path(PathStock { depth: depth_mm.map(metres), layer: layer_mm.map(metres) });
    found(&ForcesProblem { stock, ..problem.clone() })
}

/// A pocket in two levels of 4 mm by rows that overlap by half: the second level meets what the first one has left.
#[test]
fn levels_of_a_pocket_are_as_deep_as_their_steps() {
    let level = |z: f64| {
        let ends = [(20.0, 0.0), (60.0, 0.0), (60.0, 8.0), (20.0, 8.0), (20.0, 16.0), (60.0, 16.0)];
        ends.map(|(x, y)| ([x, y, z], UP))
    };
    let back = level(-8.0).into_iter().rev();
    let knots: Vec<Knot> = level(-4.0).into_iter().chain(back).collect();
    let path = line(&knots, 2.0);
    let of_block = ForcesProblem {
        operation: operation(&path, &mill(16.0, 0.0, 0.0), &Pose::identity()),
        stock: stock([[0.0, -20.0, -20.0], [80.0, 36.0, 0.0]], &Pose::identity()),
        ..shoulder([-30.0, 30.0], &along_x(5.0))
    };
    let (block, path) = (found(&of_block), with(&of_block, Some(4.0), None));
    for point in path.points.iter().filter(|point| point.removed > 1e-6) {
        let [_, top] = point.heights.unwrap();
        assert!(top < 4.1e-3, "{top}");
    }
    let ([_, _, of_block], [_, _, of_path]) = (figures(&block), figures(&path));
    assert!((of_path / of_block - 1.0).abs() < 0.1, "{of_path} for {of_block}");
    // The first row is a slot, as in the block; what is beside the last one is not there.
    for (block, path) in block.points[5..15].iter().zip(&path.points[5..15]) {
        let (block, path) = (block.at_feed(1.0).force, path.at_feed(1.0).force);
        assert!((block - path).norm() < 0.02 * block.norm(), "{block} {path}");
    }
}

/// A ball in rows on a flat face with a layer of 0.5 mm: against a block as high as that.
#[test]
fn a_layer_is_as_thick_as_it_says() {
    let mut knots: Vec<Knot> = Vec::new();
    for row in 0..5 {
        let y = f64::from(row);
        let ends = if row % 2 == 0 { [20.0, 60.0] } else { [60.0, 20.0] };
        knots.extend(ends.map(|x| ([x, y, 0.0], UP)));
    }
    let path = line(&knots, 2.0);
    let of_block = ForcesProblem {
        operation: operation(&path, &mill(10.0, 5.0, 0.0), &Pose::identity()),
        stock: stock([[0.0, -20.0, -20.0], [80.0, 36.0, 0.5]], &Pose::identity()),
        cell: Some(0.25e-3),
        ..shoulder([-30.0, 30.0], &along_x(5.0))
    };
    let (block, path) = (found(&of_block), with(&of_block, None, Some(0.5)));
    // On the third row and the fourth the one before has cut as it does in the block.
    for (block, path) in block.points.iter().zip(&path.points).skip(48).take(12) {
        let (of_block, of_path) = (block.at_feed(1.0).force.norm(), path.at_feed(1.0).force.norm());
        assert!((of_path / of_block - 1.0).abs() < 0.5 && of_path > 0.0, "{of_path} for {of_block}");
        assert!((path.removed / block.removed - 1.0).abs() < 0.15, "{} {}", path.removed, block.removed);
    }
    // A thinner one takes less force, and one with a height the same where that is higher than the layer.
    let [thin, ..] = figures(&with(&of_block, None, Some(0.2)));
    let [whole, ..] = figures(&path);
    assert!(thin < 0.7 * whole, "{thin} {whole}");
}

#[test]
fn a_path_along_the_tool_has_no_stock_of_its_own() {
    let mut problem = shoulder([-30.0, 30.0], &along_x(5.0));
    let at = |z: f64| PathPoint { position: Vector3::new(0.04, 0.0, z), feed: Vector3::x(), axis: Vector3::z() };
    let path = ToolPath::partly_scored([(1, at(5e-3), false), (1, at(-12e-3), true)]).unwrap();
    problem.operation.path = path.with_feeds(vec![0.02; 2]).unwrap();
    problem.stock = Stock::Path(PathStock { depth: Some(2e-3), layer: None });
    assert_eq!(forces(&problem, &Monitor::silent()).unwrap_err(), ForcesError::NoWall);
}
