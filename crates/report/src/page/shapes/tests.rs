//! Bodies of every arm of the catalogue: closed, outward, where the rows are.

use super::illustration::{Paint, illustration};
use super::loft::Solid;
use super::*;
use crate::page::shapes::arm::scale;
use crate::testing::problem;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stead_format::catalogue::shipped_arms;
use stead_model::robot::{Pose, Robot, testing::odd_arms};

/// The problem of the tests with each arm of the catalogue, and with arms of every sign of twist.
fn arms() -> Vec<Robot> {
    shipped_arms().unwrap().into_iter().map(|arm| arm.robot).chain(odd_arms()).collect()
}

fn with(robot: Robot) -> Problem {
    problem().clone().with(|parts| parts.robot = robot)
}

fn point(position: [f32; 3]) -> Vector3<f64> {
    Vector3::from(position.map(f64::from))
}

fn block() -> BodyMesh {
    let points = problem().task.points();
    let all = |of: fn(&stead_model::task::PathPoint) -> Vector3<f64>| points.iter().map(of).collect::<Vec<_>>();
    block_of(&all(|point| point.position), &all(|point| point.axis))
}

/// Volume that the triangles enclose, of each connected part. m^3
fn volumes(body: &BodyMesh) -> Vec<f64> {
    let mut root: Vec<usize> = (0..body.positions.len()).collect();
    fn find(root: &[usize], mut k: usize) -> usize {
        while root[k] != k {
            k = root[k];
        }
        k
    }
    for [a, b, c] in &body.triangles {
        for [p, q] in [[a, b], [b, c]] {
            let (p, q) = (find(&root, *p as usize), find(&root, *q as usize));
            root[p.max(q)] = p.min(q);
        }
    }
    let mut sums = BTreeMap::new();
    for [a, b, c] in &body.triangles {
        let [p, q, r] = [a, b, c].map(|k| point(body.positions[*k as usize]));
        *sums.entry(find(&root, *a as usize)).or_insert(0.0) += p.dot(&q.cross(&r)) / 6.0;
    }
    sums.into_values().collect()
}

#[test]
fn bodies_are_closed_and_face_outward() {
    for robot in arms() {
        let name = robot.name().to_owned();
        let mut bodies = bodies(&with(robot));
        bodies.push(block());
        assert!(bodies.len() > 15 && bodies.iter().all(|body| body.is_illustration));
        for body in bodies {
            let what = format!("{name}: {}", body.name);
            assert!(body.positions.iter().flatten().all(|v| v.is_finite() && v.abs() < 10.0), "{what}");
            let mut edges = BTreeMap::new();
            for [a, b, c] in &body.triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    assert!((*to as usize) < body.positions.len() && from != to, "{what}");
                    *edges.entry((from.min(to), from.max(to))).or_insert(0) += if from < to { 1 } else { 1000 };
                }
            }
            assert!(edges.values().all(|count| *count == 1001), "{what}: an edge is not shared by two triangles");
            let volumes = volumes(&body);
            assert!(!volumes.is_empty() && volumes.iter().all(|volume| *volume > 1e-9), "{what}: {volumes:?}");
        }
    }
}

/// Distance of a point from a chain of straight pieces. m
fn distance(point: &Vector3<f64>, chain: &[Vector3<f64>]) -> f64 {
    let piece = |ends: &[Vector3<f64>]| {
        let along = ends[1] - ends[0];
        let at = ((point - ends[0]).dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        (point - ends[0] - along * at).norm()
    };
    chain.windows(2).map(piece).fold(f64::INFINITY, f64::min)
}

/// A row i + 1 goes from the origin of frame i along x, then along its joint axis; the body of frame i lies about that
/// line, reaches both ends, and is as wide as an arm.
#[test]
fn bodies_follow_their_rows() {
    for robot in arms() {
        let size = scale(&robot);
        let problem = with(robot);
        let rows: [Pose<f64>; 6] = *problem.robot.rows();
        for frame in 0..6_u8 {
            let mine = if frame == 0 { BodyFrame::Base } else { BodyFrame::Link(frame) };
            let bodies: Vec<BodyMesh> = bodies(&problem).into_iter().filter(|body| body.frame == mine).collect();
            let next = rows[usize::from(frame)].translation;
            let shoulder = if frame == 2 { Vector3::z() * next.z } else { Vector3::x() * next.x };
            let below = rows[0].rotation.column(2) * problem.robot.geometry().shoulder_height.max(0.6 * size);
            let start = if frame == 0 { next - below } else { Vector3::zeros() };
            let chain = [start, shoulder, next];
            for body in &bodies {
                let far = body.positions.iter().map(|p| distance(&point(*p), &chain)).fold(0.0, f64::max);
                assert!(far < 0.5 * size, "{}, {}: {far} m from its row", problem.robot.name(), body.name);
            }
            let reaches = |end: &Vector3<f64>| {
                let near = bodies.iter().flat_map(|body| &body.positions).map(|p| (point(*p) - end).norm());
                near.fold(f64::INFINITY, f64::min) < 0.35 * size
            };
            assert!(reaches(&next), "{}: frame {frame}", problem.robot.name());
            assert!(frame == 0 || reaches(&Vector3::zeros()), "{}: frame {frame}", problem.robot.name());
        }
    }
}

/// The tool ends in the tool centre point, and the bracket begins at the flange.
#[test]
fn spindles_join_flange_and_tool() {
    for robot in arms() {
        let problem = with(robot);
        let bodies = bodies(&problem);
        let named = |name: &str| bodies.iter().find(|body| body.name == name).unwrap();
        let lowest = named("tool").positions.iter().map(|p| f64::from(p[2])).fold(f64::NEG_INFINITY, f64::max);
        assert!(lowest.abs() < 1e-6, "{lowest}");
        let tool_from_flange = problem.spindle.flange_from_tool.inverse();
        let flange: Vec<_> = named("flange").positions.iter().map(|p| tool_from_flange.point(&point(*p))).collect();
        let bracket = &named("spindle bracket").positions;
        let gap = bracket.iter().flat_map(|p| flange.iter().map(move |q| (point(*p) - q).norm()));
        assert!(gap.fold(f64::INFINITY, f64::min) < 0.12 * scale(&problem.robot), "{}", problem.robot.name());
    }
}

/// The block is on the far side of the path from the tool.
#[test]
fn the_block_is_under_the_path() {
    let (task, block) = (&problem().task, block());
    let top = block.positions.iter().map(|p| f64::from(p[2])).fold(f64::NEG_INFINITY, f64::max);
    assert!(task.points().iter().all(|p| p.axis.z > 0.99 && p.position.z > top));
    let low = |axis: usize| block.positions.iter().map(|p| f64::from(p[axis])).fold(f64::INFINITY, f64::min);
    assert!(task.points().iter().all(|p| p.position.x > low(0) && p.position.y > low(1)));
}

/// Corners of a box are drawn three times, once under the normal of each face; a round bar gets smooth sides.
#[test]
fn normals_are_sharp_at_edges_and_smooth_on_rounds() {
    let mut solid = Solid::default();
    solid.cuboid(Vector3::new(-1.0, -2.0, 0.0), Vector3::new(1.0, 2.0, 3.0));
    let cube = shaded(&illustration("box", BodyFrame::Base, Paint::Part, solid));
    assert_eq!((cube.positions.len(), cube.triangles.len()), (24, 12));
    let mut solid = Solid::default();
    solid.bar([Vector3::zeros(), Vector3::x()], [0.1; 2], [0.0; 2], 0.01, loft::Section::round());
    let corners = solid.positions.len();
    let bar = shaded(&illustration("bar", BodyFrame::Base, Paint::Part, solid));
    assert!(bar.positions.len() < 2 * corners);
    for body in bodies(problem()) {
        let drawn = shaded(&body);
        assert_eq!(drawn.positions.len(), drawn.normals.len());
        for triangle in &drawn.triangles {
            let [a, b, c] = triangle.map(|k| point(drawn.positions[k as usize]));
            let normal = (b - a).cross(&(c - a)).normalize();
            for k in triangle {
                let shown = point(drawn.normals[*k as usize]);
                assert!((shown.norm() - 1.0).abs() < 1e-5 && shown.dot(&normal) > 0.7, "{}", body.name);
            }
        }
    }
}
