//! Against closed forms and fine surface integrals that know nothing of lines: 4 teeth, 0.05 mm a tooth, clockwise,
//! wall and stock as named.

mod corners;
mod events;
mod five_axes;
mod kept;
mod leaning;
mod oracles;
mod path_stock;
mod probing;
mod twin;
mod volumes;

use super::*;
use crate::load::PointForces;
use nalgebra::{Matrix3, Vector3};
use oracles::{Knot, line, mill, operation, stock};
use stead_cell::TriangleMesh;
use stead_model::cutting::{Cutter, Rotation};
use stead_model::robot::Pose;
use stead_numerics::monitor::Stop;

const UP: [f64; 3] = [0.0, 0.0, 1.0];

/// A cut along x of a block 80 mm long, its wall from one y to another, with a cutter of 16 mm.
fn shoulder(y: [f64; 2], knots: &[Knot]) -> ForcesProblem {
    let path = line(knots, 2.0);
    ForcesProblem {
        stock: stock([[0.0, y[0], -20.0], [80.0, y[1], 0.0]], &Pose::identity()),
        before: Vec::new(),
        operation: operation(&path, &mill(16.0, 0.0, 0.0), &Pose::identity()),
        finished_part: None,
        cell: Some(0.5e-3),
        memory: 2e9,
    }
}

fn along_x(depth: f64) -> Vec<Knot> {
    vec![([10.0, 0.0, -depth], UP), ([70.0, 0.0, -depth], UP)]
}

fn found(problem: &ForcesProblem) -> RemovalForces {
    forces(problem, &Monitor::silent()).unwrap()
}

fn kinds(found: &RemovalForces) -> Vec<&'static str> {
    found.warnings.iter().map(|warning| warning.kind).collect()
}

/// The largest force of points. N
fn largest(points: &[PointForces]) -> f64 {
    points.iter().map(|point| point.at_feed(1.0).force.norm()).fold(0.0, f64::max)
}

#[test]
fn a_second_pass_cuts_nothing_and_threads_change_no_bit() {
    let mut knots = along_x(5.0);
    knots.extend([([10.0, 0.0, -5.0], UP)]);
    let problem = shoulder([4.0, 30.0], &knots);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| found(&problem))
    };
    let one = with(1);
    assert_eq!(with(3), one);
    // The way back from 8 mm behind the end on, where the first pass had its corner.
    let back: Vec<PointForces> = one.points.iter().rev().take(25).copied().collect();
    assert!(largest(&back) < 0.01 && largest(&one.points) > 100.0, "{}", largest(&back));
    assert!(kinds(&one).contains(&"in-air") && kinds(&one).contains(&"starts-in-stock"), "{:?}", one.warnings);
}

/// Beside what the cutter stands in when a segment begins, the first cut is as even as any other.
#[test]
fn a_plunge_that_begins_in_the_stock_has_its_force_from_the_start() {
    let knots = [([40.0, 0.0, -3.0], UP), ([40.0, 0.0, -12.0], UP), ([42.0, 0.0, -12.0], UP)];
    let path = line(&knots, 1.0);
    let problem = ForcesProblem {
        operation: operation(&path, &mill(16.0, 0.0, 0.0), &Pose::identity()),
        ..shoulder([-30.0, 30.0], &along_x(5.0))
    };
    let found = found(&problem);
    for load in &found.points[..9] {
        assert!((load.at_feed(1.0).force.norm() / 1152.0 - 1.0).abs() < 0.05, "{}", load.at_feed(1.0).force);
    }
    assert!(found.difference.largest[0] < 0.1, "{:?}", found.difference);
    assert!(kinds(&found).contains(&"starts-in-stock"), "{:?}", found.warnings);
}

/// An upright shoulder, and the same with the tool along the other axes of the grid and quarter turns about it.
#[test]
fn stock_and_path_turned_by_a_quarter_give_the_same_forces() {
    let of_depth = |depth: f64, y: [f64; 2], is: Vector3<f64>| {
        for tool_axis in 0..3 {
            for quarters in 0..4 {
                let (s, c) = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][quarters];
                let about = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
                // The axes of the grid in turn.
                let turn = Matrix3::from_fn(|row, column| f64::from((row + 3 - tool_axis) % 3 == (column + 1) % 3));
                let rotation = turn * about;
                let pose = Pose { rotation, translation: Vector3::zeros() };
                let problem = ForcesProblem {
                    stock: stock([[0.0, y[0], -20.0], [80.0, y[1], 0.0]], &pose),
                    operation: operation(&line(&along_x(depth), 2.0), &mill(16.0, 0.0, 0.0), &pose),
                    ..shoulder(y, &along_x(depth))
                };
                let found = found(&problem);
                let (mut squares, mut largest) = (0.0, 0.0_f64);
                for load in &found.points[5..25] {
                    let off = (rotation.transpose() * load.at_feed(1.0).force - is).norm() / is.norm();
                    squares += off * off / 20.0;
                    largest = largest.max(off);
                }
                let rms = squares.sqrt();
                assert!(rms < 0.015 && largest < 0.04, "{tool_axis} {quarters}: {rms} {largest}");
            }
        }
    };
    of_depth(5.0, [4.0, 30.0], Vector3::new(-150.3504, -3.3003, 7.9577));
    of_depth(10.0, [-30.0, -7.0], Vector3::new(71.4029, 99.9017, 3.9789));
}

/// The lines are the same, and what the moves sweep of them together. The force is a sum over other points of them.
#[test]
fn the_same_path_in_other_moves_removes_the_same() {
    let removed = |step: f64| {
        let problem = shoulder([4.0, 30.0], &along_x(5.0));
        let path = line(&along_x(5.0), step);
        let operation = operation(&path, &mill(16.0, 0.0, 0.0), &Pose::identity());
        let run = Run::new(
            &ForcesProblem { operation, ..problem },
            0.5e-3,
            Some(1e-3),
            Requested::Forces,
            "",
            &Monitor::silent(),
        );
        let run = run.unwrap();
        let force: Vector3<f64> = run.found.sums.iter().map(|sums| sums.chip.force + sums.edge.force).sum();
        (run.workpiece.removed().map(|(_, volume)| volume), force)
    };
    let (lost, force) = removed(60.0);
    for step in [5.0, 0.7] {
        let (other, of_other) = removed(step);
        for axis in 0..3 {
            assert!((other[axis] / lost[axis] - 1.0).abs() < 1e-9, "{step} {axis}: {} {}", other[axis], lost[axis]);
        }
        assert!((of_other - force).norm() < 2e-3 * force.norm(), "{step}: {of_other} {force}");
    }
}

#[test]
fn the_largest_force_of_a_turn_is_that_of_the_teeth() {
    // Slot, down a_e 1 a_p 10, down a_e 0.2 a_p 10; helix 0 and 30 deg.
    for (y, depth, is) in [
        ([-30.0, 30.0], 5.0, [416.68, 415.59]),
        ([-30.0, -7.0], 10.0, [482.21, 267.41]),
        ([-30.0, -7.8], 10.0, [372.91, 101.70]),
    ] {
        for (helix, is) in [0.0_f64, 30.0].into_iter().zip(is) {
            let mut problem = shoulder(y, &along_x(depth));
            let straight = &problem.operation.mill.cutter;
            let teeth = straight.teeth().to_vec();
            let cutter =
                Cutter::new(teeth, helix.to_radians(), Some(0.04), Rotation::Clockwise, straight.coefficients());
            problem.operation.mill.cutter = cutter.unwrap();
            for point in &found(&problem).points[8..22] {
                let off = point.largest / is - 1.0;
                assert!(off.abs() < 0.15, "{y:?} helix {helix}: {} for {is}", point.largest);
            }
        }
    }
}

#[test]
fn angles_and_heights_are_those_of_the_cut() {
    // Up milling of 4 mm of 16: from 0 to acos(1 - 4 / 8) = 60 deg; down: the other way round.
    for (y, is) in [([4.0, 30.0], [0.0, 60.0]), ([-30.0, -4.0], [120.0, 180.0])] {
        let found = found(&shoulder(y, &along_x(5.0)));
        for point in &found.points[8..22] {
            let angles = point.angles.unwrap().map(f64::to_degrees);
            assert!((angles[0] - is[0]).abs() < 3.0 && (angles[1] - is[1]).abs() < 3.0, "{angles:?}");
            let [low, high] = point.heights.unwrap();
            assert!(low < 0.6e-3 && high > 4.4e-3 && high <= 5.0e-3 + 1e-9, "{low} {high}");
            assert!((point.removed * 1e6 - 20.0).abs() < 0.5);
            // 0.05 mm a tooth times the sine of 60 deg.
            assert!((point.chip_thickness * 1e3 - 0.0433).abs() < 0.002, "{}", point.chip_thickness);
        }
        assert!(found.difference.rms[0] < 0.05 && found.difference.rms[0] > 0.0, "{:?}", found.difference);
    }
}

/// Leaning back by so little, the bottom is in the stock all around, and cuts chips of a tenth of a micrometre.
#[test]
fn a_bottom_that_hardly_cuts_does_not_widen_the_angles() {
    let (s, c) = libm::sincos(0.15_f64.to_radians());
    let back = [-s, 0.0, c];
    let problem = shoulder([4.0, 30.0], &[([10.0, 0.0, -5.0], back), ([70.0, 0.0, -5.0], back)]);
    for point in &found(&problem).points[8..22] {
        let angles = point.angles.unwrap().map(f64::to_degrees);
        assert!(angles[0].abs() < 3.0 && (angles[1] - 60.0).abs() < 3.0, "{angles:?}");
    }
}

/// A closed mesh of a box, in twelve triangles that face outwards.
fn box_mesh([min, max]: [[f64; 3]; 2]) -> TriangleMesh {
    let corner = |bits: usize| Vector3::from_fn(|k, _| if bits >> k & 1 == 1 { max[k] } else { min[k] }) / 1e3;
    let vertices: Vec<Vector3<f64>> = (0..8).map(corner).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    TriangleMesh::new(&vertices, &triangles).unwrap()
}

#[test]
fn a_mesh_of_a_box_is_cut_as_the_box() {
    let plain = shoulder([4.0, 30.0], &along_x(5.0));
    let mesh = box_mesh([[0.0, 4.0, -20.0], [80.0, 30.0, 0.0]]);
    assert!(mesh.is_closed());
    let mut of_mesh = plain.clone();
    of_mesh.stock = crate::operation::Stock::Solid { solid: Solid::Mesh(mesh.into()), pose: Pose::identity() };
    let (a, b) = (found(&plain), found(&of_mesh));
    assert!((a.removed / b.removed - 1.0).abs() < 1e-5);
    for (a, b) in a.points.iter().zip(&b.points) {
        assert!((a.at_feed(1.0).force - b.at_feed(1.0).force).norm() < 0.01);
    }
}

#[test]
fn points_are_added_where_the_force_is_not_straight() {
    // Into a wall: one move of 60 mm from air to a slot.
    let knots = [([-40.0, 0.0, -5.0], UP), ([20.0, 0.0, -5.0], UP), ([40.0, 0.0, -5.0], UP)];
    let path = line(&knots, 60.0);
    let problem = ForcesProblem {
        operation: operation(&path, &mill(16.0, 0.0, 0.0), &Pose::identity()),
        ..shoulder([-30.0, 30.0], &along_x(5.0))
    };
    let found = found(&problem);
    let added = found.points.iter().filter(|point| point.is_added).count();
    assert!(added >= 3 && found.points.len() == path.len() + added, "{added}");
    assert_eq!(found.path.points().len(), found.points.len());
    // On the way in the force rises from none at -8 mm; every added point is there.
    for (point, load) in found.path.points().iter().zip(&found.points).filter(|(_, load)| load.is_added) {
        assert!(point.position.x > -0.0125 && point.position.x < 0.01, "{}", point.position);
        assert!(load.at_feed(1.0).force.norm() >= 0.0);
    }
}

#[test]
#[ignore = "takes long: for measuring"]
#[expect(clippy::print_stdout, reason = "the guide states what it prints")]
fn many_points() {
    let rows = std::env::var("ROWS").ok().and_then(|rows| rows.parse().ok()).unwrap_or(100);
    let mut knots = Vec::new();
    for row in 0..rows {
        let y = 100.0 + 4.0 * f64::from(row);
        let ends = if row % 2 == 0 { [-10.0, 990.0] } else { [990.0, -10.0] };
        knots.extend(ends.map(|x| ([x, y, -5.0], UP)));
    }
    let path = line(&knots, 0.5);
    let problem = ForcesProblem {
        stock: stock([[0.0, 0.0, -300.0], [1000.0, 1000.0, 0.0]], &Pose::identity()),
        operation: operation(&path, &mill(16.0, 0.0, 0.0), &Pose::identity()),
        ..shoulder([-30.0, 30.0], &along_x(5.0))
    };
    let start = std::time::Instant::now();
    let run = |cell: f64, requested| {
        let start = std::time::Instant::now();
        let run = Run::new(&problem, cell, Some(1e-3), requested, "", &Monitor::silent()).unwrap();
        println!("cell {cell}: {:?}, {} tiles", start.elapsed(), run.workpiece.tile_count());
    };
    run(1e-3, Requested::Forces);
    run(0.5e-3, Requested::Forces);
    run(0.5e-3, Requested::Turns);
    println!("{} points: {:?}", path.len(), start.elapsed());
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    println!("{:?}", status.lines().find(|line| line.starts_with("VmHWM")));
}

#[test]
fn what_is_cut_is_told_in_a_few_figures_and_what_no_cutter_does_is_warned_of() {
    let slot = found(&shoulder([-30.0, 30.0], &along_x(5.0)));
    let cut = slot.cut.unwrap();
    assert!(cut.depths.iter().all(|depth| (depth - 5e-3).abs() < 1e-9), "{:?}", cut.depths);
    assert!((cut.section.mean / 80e-6 - 1.0).abs() < 0.03 && cut.slot > 0.9 && cut.air < 0.05, "{cut:?}");
    let feed = slot.path.feed(1).unwrap();
    assert!((cut.rate / (cut.section.mean * feed) - 1.0).abs() < 1e-9);
    let speed = shoulder([-30.0, 30.0], &along_x(5.0)).operation.spindle_speed * std::f64::consts::TAU;
    assert!((cut.power.max / (cut.torque.max * speed) - 1.0).abs() < 1e-12 && cut.torque.max > 0.1);
    assert!((cut.force.max - largest(&slot.points)).abs() < 1e-9);
    assert!(
        cut.lines()[0].starts_with("depth 5.00 mm (95 % to 5.00") && cut.lines()[1].contains("cm3/min"),
        "{:?}",
        cut.lines()
    );
    assert_eq!(cut.beyond(Some(cut.power.max * 1.01), Some(cut.torque.max * 1.01)), None);
    let beyond = cut.beyond(Some(cut.power.max / 2.0), None).unwrap();
    assert!(beyond.kind == "spindle-power" && beyond.message.contains("a power of up to"), "{beyond}");
    let odd = ["deep-cut", "uneven-depth"];
    assert!(kinds(&slot).iter().all(|kind| !odd.contains(kind)), "{:?}", slot.warnings);
    // 26 mm of a block 20 mm high and 10 above: deeper than 1.5 diameters, in full width.
    let mut deep = shoulder([-30.0, 30.0], &along_x(20.0));
    deep.stock = stock([[0.0, -30.0, -20.0], [80.0, 30.0, 10.0]], &Pose::identity());
    assert!(kinds(&found(&deep)).contains(&"deep-cut"));
    // A ridge 9 mm high over 2 of 60 mm of a cut 2 mm deep.
    let mut ridge = shoulder([-30.0, 30.0], &along_x(2.0));
    ridge.stock = stock([[0.0, -30.0, -20.0], [80.0, 30.0, 0.0]], &Pose::identity());
    let knots = [([10.0, 0.0, -2.0], UP), ([70.0, 0.0, -2.0], UP), ([70.0, 0.0, -12.0], UP), ([71.0, 0.0, -12.0], UP)];
    ridge.operation = operation(&line(&knots, 0.5), &mill(16.0, 0.0, 0.0), &Pose::identity());
    let uneven = found(&ridge);
    let said = uneven.warnings.iter().find(|warning| warning.kind == "uneven-depth").unwrap();
    assert!(said.message.contains("up to 12.0 mm where 95 % cut 2.00 mm"), "{said}");
}

/// Points that cut nothing are followed and have no part in means.
#[test]
fn points_in_air_weigh_nothing() {
    let half = [([-60.0, 0.0, -5.0], UP), ([70.0, 0.0, -5.0], UP)];
    let problem = ForcesProblem {
        operation: operation(&line(&half, 2.0), &mill(16.0, 0.0, 0.0), &Pose::identity()),
        ..shoulder([4.0, 30.0], &along_x(5.0))
    };
    let found = found(&problem);
    let cuts = |point: usize| found.points[point].heights.is_some();
    assert!((0..found.points.len()).all(|point| found.path.is_scored(point) == cuts(point)));
    assert!(found.air > 0.3 && kinds(&found).contains(&"in-air"), "{}", found.air);
}
