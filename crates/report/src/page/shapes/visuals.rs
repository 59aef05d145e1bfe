//! What an arm looks like, where its meshes are known: in place of the illustrations of its links.

use super::maker::body_color;
use super::{BodyFrame, BodyMesh};
use crate::page::thinned::thinned_to;
use nalgebra::Vector3;
use stead_cell::{Attachment, Visual};
use stead_model::robot::Robot;
use stead_removal::surface::Surface;

/// Triangles of all meshes together at most.
const TRIANGLES: usize = 20_000;
/// Those that a mesh has at least, however many others have.
const LEAST: usize = 12;

/// The frame that a part of the arm moves with; `None` for what is none.
fn frame(attached: Attachment) -> Option<BodyFrame> {
    match attached {
        Attachment::Base => Some(BodyFrame::Base),
        Attachment::Link(number) => Some(BodyFrame::Link(number)),
        Attachment::Flange => Some(BodyFrame::Link(6)),
        Attachment::Workpiece | Attachment::Axis(_) => None,
    }
}

/// Puts the meshes of an arm in the place of the illustrations of what they show.
pub(super) fn put(bodies: &mut Vec<BodyMesh>, robot: &Robot, visuals: &[Visual]) {
    bodies.retain(|body| !visuals.iter().any(|visual| frame(visual.attached) == Some(body.frame)));
    let all: usize = visuals.iter().map(|visual| visual.mesh.triangles().len()).sum();
    let room = TRIANGLES.saturating_sub(LEAST * visuals.len());
    bodies.extend(visuals.iter().filter_map(|visual| {
        let count = visual.mesh.triangles().len();
        let most = if all <= TRIANGLES { count } else { LEAST + room * count / all };
        drawn(visual, frame(visual.attached)?, most, robot)
    }));
}

fn drawn(visual: &Visual, frame: BodyFrame, most: usize, robot: &Robot) -> Option<BodyMesh> {
    let place = |corner: &Vector3<f64>| visual.pose.point(corner);
    let whole = Surface {
        vertices: visual.mesh.vertices().iter().map(place).collect(),
        triangles: visual.mesh.triangles().to_vec(),
    };
    let few = if whole.triangles.len() > most { thinned_to(&whole, most) } else { whole };
    let corner = |corner: &Vector3<f64>| <[f64; 3]>::from(*corner).map(|part| part as f32);
    Some(BodyMesh {
        name: visual.name.clone(),
        frame,
        color: visual.color.map_or_else(|| body_color(robot), |color| color.map(|part| part as f32)),
        positions: few.vertices.iter().map(corner).collect(),
        triangles: few.triangles,
        is_illustration: false,
    })
}

#[cfg(test)]
mod tests {
    use super::super::bodies;
    use super::*;
    use std::sync::Arc;
    use stead_cell::{Scene, Shape, Solid, Surroundings, TriangleMesh};
    use stead_model::robot::Pose;
    use stead_problem::testing::five_segments;

    /// A ball of many triangles, its corners on a grid of angles.
    fn ball(around: u32) -> Arc<TriangleMesh> {
        let up = around / 2;
        let point = |i: u32, k: u32| {
            let (a, b) = (f64::from(i % around) / f64::from(around), f64::from(k) / f64::from(up));
            let ((s, c), (sb, cb)) = (libm::sincos(std::f64::consts::TAU * a), libm::sincos(std::f64::consts::PI * b));
            Vector3::new(c * sb, s * sb, cb) * 0.2
        };
        let mut vertices = vec![point(0, 0)];
        (1..up).for_each(|k| vertices.extend((0..around).map(|i| point(i, k))));
        vertices.push(point(0, up));
        let at = |i: u32, k: u32| match k {
            0 => 0,
            k if k == up => vertices.len() as u32 - 1,
            k => 1 + (k - 1) * around + i % around,
        };
        let quads = (0..up).flat_map(|k| (0..around).map(move |i| (i, k)));
        let triangles: Vec<[u32; 3]> = quads
            .flat_map(|(i, k)| [[at(i, k), at(i, k + 1), at(i + 1, k + 1)], [at(i, k), at(i + 1, k + 1), at(i + 1, k)]])
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        Arc::new(TriangleMesh::new(&vertices, &triangles).unwrap())
    }

    #[test]
    fn meshes_take_the_place_of_illustrations_and_are_thinned_together() {
        let problem = five_segments();
        let illustrated = bodies(&problem);
        let visual = |name: &str, attached, mesh: &Arc<TriangleMesh>, color| Visual {
            name: name.to_owned(),
            attached,
            mesh: Arc::clone(mesh),
            pose: Pose { translation: Vector3::new(0.0, 0.0, 1.0), ..Pose::identity() },
            color,
        };
        let (fine, coarse) = (ball(200), ball(8));
        let red = [0.9, 0.1, 0.1];
        let visuals = vec![
            visual("base visual", Attachment::Base, &fine, None),
            visual("link_2 visual", Attachment::Link(2), &fine, Some(red)),
            visual("flange visual", Attachment::Flange, &coarse, None),
        ];
        let shape = Shape {
            name: "table".to_owned(),
            attached: Attachment::Base,
            solid: Solid::Box(Vector3::repeat(0.1)),
            pose: Pose { translation: Vector3::new(5.0, 0.0, 0.0), ..Pose::identity() },
        };
        let around = Surroundings::new(vec![shape], Vec::new(), 0.01, Vec::new()).unwrap().with_visuals(visuals);
        let scene = Scene::new(&problem.robot, &problem.spindle.flange_from_tool, around).unwrap();
        let problem = problem.with(|parts| parts.scene = Some(Arc::new(scene)));
        let drawn = bodies(&problem);
        let of = |frame: BodyFrame| drawn.iter().filter(|body| body.frame == frame).collect::<Vec<_>>();
        for frame in [BodyFrame::Base, BodyFrame::Link(2), BodyFrame::Link(6)] {
            assert!(of(frame).len() == 1 && !of(frame)[0].is_illustration, "{frame:?}");
        }
        let kept = |all: &[BodyMesh]| {
            let other =
                [BodyFrame::Link(1), BodyFrame::Link(3), BodyFrame::Link(4), BodyFrame::Link(5), BodyFrame::Tool];
            all.iter().filter(|body| other.contains(&body.frame)).cloned().collect::<Vec<_>>()
        };
        assert_eq!(kept(&drawn), kept(&illustrated));
        let count: usize = drawn.iter().filter(|body| !body.is_illustration).map(|body| body.triangles.len()).sum();
        assert!(count <= TRIANGLES && count > TRIANGLES * 9 / 10, "{count}");
        assert_eq!(of(BodyFrame::Link(2))[0].color, red.map(|part| part as f32));
        assert_eq!(of(BodyFrame::Base)[0].color, body_color(&problem.robot));
        // A ball of 0.2 m about a point 1 m up, still round.
        for corner in &of(BodyFrame::Base)[0].positions {
            let far = (Vector3::from(*corner) - Vector3::new(0.0, 0.0, 1.0)).norm();
            assert!((far - 0.2).abs() < 0.01, "{far}");
        }
    }
}
