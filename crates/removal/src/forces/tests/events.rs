//! What the user is warned of, and what is refused.

use super::*;
use crate::operation::AirPoint;
use crate::operation::Stock;
use stead_cell::tool_scene::Cylinder;

fn warning(found: &RemovalForces, kind: &str) -> String {
    let found = found.warnings.iter().find(|warning| warning.kind == kind);
    found.map(|warning| warning.message.clone()).unwrap_or_default()
}

/// From the air into a slot.
fn slot() -> ForcesProblem {
    shoulder([-30.0, 30.0], &[([-20.0, 0.0, -5.0], UP), ([40.0, 0.0, -5.0], UP)])
}

#[test]
fn a_sound_cut_has_no_warning_and_a_note_of_the_way_in() {
    let found = found(&slot());
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    assert!(found.notes.iter().any(|note| note.contains("scored points cut nothing, ")), "{:?}", found.notes);
    assert!((found.air - 12.0 / 60.0).abs() < 0.05, "{}", found.air);
    assert!(found.notes.iter().any(|note| note.contains("no rapid moves")), "{:?}", found.notes);
    assert!(found.notes.iter().any(|note| note.contains("no holder")), "{:?}", found.notes);
}

#[test]
fn rapid_moves_through_the_stock_are_told() {
    let mut problem = slot();
    let place = |x: f64, z: f64| AirPoint { position: Vector3::new(x, 0.0, z) / 1e3, axis: Vector3::z() };
    problem.operation.rapids = vec![vec![place(-20.0, 30.0)], vec![place(40.0, 30.0)]];
    assert!(!kinds(&found(&problem)).contains(&"rapid-in-stock"));
    // Over the end of the block, 1 mm deep.
    problem.operation.rapids = vec![vec![place(90.0, -1.0), place(40.0, -1.0), place(-20.0, 30.0)], Vec::new()];
    let text = warning(&found(&problem), "rapid-in-stock");
    assert!(text.contains("rapid moves go through the stock") && text.contains("mm3"), "{text}");
}

#[test]
fn short_flutes_a_dead_centre_and_a_holder_are_told() {
    let mut problem = slot();
    problem.operation.mill.flute_length = 4e-3;
    assert!(warning(&found(&problem), "above-flutes").contains("(4 mm)"));
    let knots = [([40.0, 0.0, 5.0], UP), ([40.0, 0.0, -5.0], UP), ([50.0, 0.0, -5.0], UP)];
    let mut plunge = shoulder([-30.0, 30.0], &knots);
    assert!(!kinds(&found(&plunge)).contains(&"dead-centre"));
    plunge.operation.mill.is_centre_cutting = false;
    assert!(warning(&found(&plunge), "dead-centre").contains("within 2.4 mm of its axis"));
    // A slot does not cut with the bottom.
    let mut across = slot();
    across.operation.mill.is_centre_cutting = false;
    assert!(!kinds(&found(&across)).contains(&"dead-centre"));
    let holder = |from: f64| vec![Cylinder { radius: 0.025, from, to: from + 0.05 }];
    let mut held = slot();
    held.operation.mill.holder = holder(6e-3);
    assert!(!kinds(&found(&held)).contains(&"holder-in-stock"));
    held.operation.mill.holder = holder(4e-3);
    let text = warning(&found(&held), "holder-in-stock");
    assert!(text.contains("shank or holder are in the stock"), "{text}");
}

#[test]
fn a_cut_into_the_finished_part_is_told_from_its_tolerance_on() {
    let mut problem = slot();
    let part = |top: f64| {
        let mesh = box_mesh([[0.0, -30.0, -20.0], [80.0, 30.0, top]]);
        Some((std::sync::Arc::new(mesh), Pose::identity()))
    };
    for (top, is_told) in [(-5.0, false), (-4.97, false), (-4.9, true)] {
        problem.finished_part = part(top);
        assert_eq!(kinds(&found(&problem)).contains(&"gouge"), is_told, "{top}");
    }
}

#[test]
fn a_turn_in_place_in_the_stock_has_no_force_and_is_told() {
    let tilted = [0.2, 0.0, 1.0];
    let mut points = line(&[([-20.0, 0.0, -5.0], UP), ([40.0, 0.0, -5.0], UP)], 2.0);
    points.push((Vector3::new(0.04, 0.0, -0.005), Vector3::from(tilted).normalize()));
    let mill = mill(16.0, 0.0, 0.0);
    let path = operation(&points[..points.len() - 1], &mill, &Pose::identity()).path;
    let of_path = (0..path.points().len()).map(|k| (1, path.points()[k], true));
    let last =
        stead_model::task::PathPoint { axis: points[points.len() - 1].1, ..path.points()[path.points().len() - 1] };
    let turned = stead_model::task::ToolPath::partly_scored(of_path.chain([(1, last, false)])).unwrap();
    let mut problem = slot();
    problem.operation.path = turned.with_feeds(vec![0.02; points.len()]).unwrap();
    let found = found(&problem);
    assert!(warning(&found, "turns-in-stock").contains("without a force"), "{:?}", found.warnings);
}

#[test]
fn thin_chips_are_told() {
    let mut problem = slot();
    problem.operation.spindle_speed = 100.0 * 30.0;
    let text = warning(&found(&problem), "thin-chip");
    assert!(text.contains("thinner than 2 um at"), "{text}");
}

#[test]
fn what_makes_no_forces_is_refused() {
    let refused = |problem: &ForcesProblem| forces(problem, &Monitor::silent()).unwrap_err();
    let mut far = slot();
    far.stock = stock([[0.0, -30.0, 980.0], [80.0, 30.0, 1000.0]], &Pose::identity());
    assert_eq!(refused(&far), ForcesError::Untouched);
    let mut small = slot();
    (small.cell, small.memory) = (Some(1e-5), 2e6);
    let ForcesError::Memory { fits: Some(fits), .. } = refused(&small) else { panic!("not refused") };
    small.cell = Some(fits);
    assert!(forces(&small, &Monitor::silent()).is_ok());
    let mut large = slot();
    let of = |solid: Solid| Stock::Solid { solid, pose: Pose::identity() };
    large.stock = of(Solid::Box(Vector3::new(5.0, 0.1, 0.1)));
    assert_eq!(refused(&large), ForcesError::Large(5.0));
    let mut hull = slot();
    hull.stock = of(Solid::Capsule { radius: 0.1, length: 0.1 });
    assert_eq!(refused(&hull), ForcesError::Form);
    // A box without its top.
    let whole = box_mesh([[0.0, -30.0, -20.0], [80.0, 30.0, 0.0]]);
    let open = TriangleMesh::new(whole.vertices(), &[&whole.triangles()[..2], &whole.triangles()[4..]].concat());
    let mut broken = slot();
    broken.stock = Stock::Solid { solid: Solid::Mesh(open.unwrap().into()), pose: Pose::identity() };
    let error = refused(&broken);
    assert!(matches!(error, ForcesError::Open { .. }), "{error}");
    assert!(error.to_string().contains("the surface of the stock is no closed one"), "{error}");
}

#[test]
fn a_stop_ends_it() {
    let monitor = Monitor::silent();
    monitor.stop_handle().stop();
    assert_eq!(forces(&slot(), &monitor), Err(ForcesError::Stopped(Stop::Asked)));
}
