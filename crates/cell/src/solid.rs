//! The forms that shapes have.

mod solids;

use nalgebra::Vector3;
use solids::{merged, solids_of};
use std::sync::Arc;
use stead_model::robot::Pose;

/// Triangles, as a mesh file holds them, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleMesh {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// Where the triangles are not those of one closed surface alone, the closed surfaces that they make; else none.
    solids: Vec<Vec<[u32; 3]>>,
    is_closed: bool,
    is_touching: bool,
}

/// Why triangles are no mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// There are none.
    #[error("has no triangles")]
    Empty,
    /// A coordinate is not finite.
    #[error("has a coordinate that is not finite in vertex {0}")]
    NotFinite(usize),
    /// A triangle names a vertex that is not there.
    #[error("names vertex {1} in triangle {0}, and there is none")]
    NoVertex(usize, u32),
    /// All triangles are without area.
    #[error("has only triangles without area")]
    Flat,
}

impl TriangleMesh {
    /// From vertices (m) and triangles of three vertex numbers, from 0. Vertices within 1e-6 of the size of the mesh
    /// are one, and triangles without area are left out.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn new(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        if let Some(place) = vertices.iter().position(|v| !v.iter().all(|c| c.is_finite())) {
            return Err(MeshError::NotFinite(place));
        }
        if triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        let (merged, number_of) = merged(vertices);
        let mut kept = Vec::with_capacity(triangles.len());
        for (place, triangle) in triangles.iter().enumerate() {
            if let Some(missing) = triangle.iter().find(|number| **number as usize >= vertices.len()) {
                return Err(MeshError::NoVertex(place, *missing));
            }
            let numbers = triangle.map(|number| number_of[number as usize]);
            let [a, b, c] = numbers.map(|number| merged[number as usize]);
            if (b - a).cross(&(c - a)).norm_squared() > 0.0 {
                kept.push(numbers);
            }
        }
        if kept.is_empty() {
            return Err(MeshError::Flat);
        }
        let (solids, is_closed, is_touching) = match solids_of(&merged, &kept) {
            Some(found) if found.solids.len() > 1 => (found.solids, true, found.is_touching),
            found => (Vec::new(), found.is_some(), false),
        };
        Ok(Self { vertices: merged, triangles: kept, solids, is_closed, is_touching })
    }

    /// The vertices. m
    pub fn vertices(&self) -> &[Vector3<f64>] {
        &self.vertices
    }

    /// The triangles, by numbers of vertices from 0.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The triangles of each closed surface, where there are several of them; else none.
    pub fn solids(&self) -> &[Vec<[u32; 3]>] {
        &self.solids
    }

    /// Whether it is made of closed surfaces alone, so that it has an inside: in each of them every edge belongs to two
    /// triangles that turn the same way.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Whether it is made of closed surfaces some of which have a vertex in common: solids that touch.
    pub fn is_touching(&self) -> bool {
        self.is_touching
    }
}

/// A form in a frame of its own: a box, cylinder or capsule about the origin, along z.
#[derive(Debug, Clone, PartialEq)]
pub enum Solid {
    /// A box by its edges along x, y and z. m
    Box(Vector3<f64>),
    /// A cylinder. m
    Cylinder {
        /// Its radius. m
        radius: f64,
        /// Its length along z. m
        length: f64,
    },
    /// A cylinder with half spheres at its ends. m
    Capsule {
        /// Its radius. m
        radius: f64,
        /// The distance of the centres of its ends along z. m
        length: f64,
    },
    /// The convex hull of the vertices of a mesh.
    Hull(Arc<TriangleMesh>),
    /// Triangles as they are; a closed mesh is solid.
    Mesh(Arc<TriangleMesh>),
}

impl Solid {
    /// The ends along x, y and z of all that it fills, in its own frame: lower and upper. m
    pub fn extent(&self) -> [Vector3<f64>; 2] {
        self.extent_at(&Pose::identity())
    }

    /// The same in another frame, in which its own has a pose. m
    pub fn extent_at(&self, pose: &Pose<f64>) -> [Vector3<f64>; 2] {
        // How far it reaches from its origin along each axis of the frame, by the direction of that in its own.
        let about = |half: &dyn Fn(Vector3<f64>) -> f64| {
            let half = Vector3::from_fn(|axis, _| half(pose.rotation.row(axis).transpose()));
            [pose.translation - half, pose.translation + half]
        };
        match self {
            Self::Box(edges) => about(&|along| along.abs().dot(edges) / 2.0),
            Self::Cylinder { radius, length } => {
                about(&|along| along.z.abs() * length / 2.0 + radius * libm::hypot(along.x, along.y))
            }
            Self::Capsule { radius, length } => about(&|along| along.z.abs() * length / 2.0 + radius),
            Self::Hull(mesh) | Self::Mesh(mesh) => {
                let first = pose.point(&mesh.vertices[0]);
                mesh.vertices
                    .iter()
                    .map(|v| pose.point(v))
                    .fold([first, first], |[low, high], v| [low.inf(&v), high.sup(&v)])
            }
        }
    }

    /// The mesh that it is made of, where there is one.
    pub fn mesh(&self) -> Option<&TriangleMesh> {
        match self {
            Self::Hull(mesh) | Self::Mesh(mesh) => Some(mesh),
            _ => None,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The surface of a box of these edges about the origin, closed. m
    pub(crate) fn box_mesh(edges: Vector3<f64>) -> TriangleMesh {
        let corner = |k: usize| {
            let side = |bit: usize| if k >> bit & 1 == 1 { 0.5 } else { -0.5 };
            Vector3::new(side(0) * edges.x, side(1) * edges.y, side(2) * edges.z)
        };
        let vertices: Vec<Vector3<f64>> = (0..8).map(corner).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        TriangleMesh::new(&vertices, &triangles).unwrap()
    }

    #[test]
    fn a_box_is_closed_and_a_box_without_a_side_is_not() {
        let whole = box_mesh(Vector3::new(1.0, 2.0, 3.0));
        assert!(whole.is_closed());
        let open = TriangleMesh::new(whole.vertices(), &whole.triangles()[1..]).unwrap();
        assert!(!open.is_closed());
        let [low, high] = Solid::Mesh(Arc::new(whole)).extent();
        assert_eq!((low, high), (Vector3::new(-0.5, -1.0, -1.5), Vector3::new(0.5, 1.0, 1.5)));
    }

    #[test]
    fn extents_in_a_turned_frame_are_those_of_all_points() {
        let (sine, cosine) = libm::sincos(0.5);
        let rotation = nalgebra::Matrix3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0)
            * nalgebra::Matrix3::new(1.0, 0.0, 0.0, 0.0, cosine, -sine, 0.0, sine, cosine);
        let pose = Pose { rotation, translation: Vector3::new(1.0, -2.0, 0.5) };
        let edges = Vector3::new(0.3, 0.2, 0.7);
        let of_box = Solid::Box(edges).extent_at(&pose);
        let of_mesh = Solid::Mesh(Arc::new(box_mesh(edges))).extent_at(&pose);
        // Points on the rims of a cylinder, and on the spheres of a capsule.
        let (radius, length) = (0.2, 0.7);
        let mut rims = [pose.translation; 2];
        for k in 0..3600 {
            let (sine, cosine) = libm::sincos(f64::from(k) * std::f64::consts::TAU / 3600.0);
            for z in [-length / 2.0, length / 2.0] {
                let point = pose.point(&Vector3::new(radius * cosine, radius * sine, z));
                rims = [rims[0].inf(&point), rims[1].sup(&point)];
            }
        }
        let of_cylinder = Solid::Cylinder { radius, length }.extent_at(&pose);
        let ends = [-length / 2.0, length / 2.0].map(|z| pose.point(&Vector3::new(0.0, 0.0, z)));
        let ball = Vector3::from_element(radius);
        let balls = [ends[0].inf(&ends[1]) - ball, ends[0].sup(&ends[1]) + ball];
        let of_capsule = Solid::Capsule { radius, length }.extent_at(&pose);
        for (found, expected) in [(of_box, of_mesh), (of_cylinder, rims), (of_capsule, balls)] {
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).amax() < 1e-6, "{found} {expected}");
            }
        }
    }

    /// Boxes side by side in one file, each with corners of its own that rounding has moved by some nanometres.
    pub(crate) fn boxes(places: &[Vector3<f64>]) -> TriangleMesh {
        let one = box_mesh(Vector3::new(1.0, 1.0, 1.0));
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        for (number, place) in places.iter().enumerate() {
            // Every triangle with corners of its own, as STL has them.
            for (k, corner) in one.triangles().iter().flatten().enumerate() {
                let off = 2e-8 * ((k + number) % 7) as f64;
                vertices.push(one.vertices()[*corner as usize] + place + Vector3::new(off, -off, off));
            }
        }
        for first in (0..vertices.len() as u32).step_by(3) {
            triangles.push([first, first + 1, first + 2]);
        }
        TriangleMesh::new(&vertices, &triangles).unwrap()
    }

    #[test]
    fn corners_that_rounding_has_moved_are_one() {
        let one = boxes(&[Vector3::zeros()]);
        assert_eq!((one.vertices().len(), one.is_closed(), one.solids().len()), (8, true, 0));
        // By a thousandth of its size they are not.
        let whole = box_mesh(Vector3::new(1.0, 1.0, 1.0));
        let mut vertices = whole.vertices().to_vec();
        vertices.push(vertices[0] + Vector3::new(1e-3, 0.0, 0.0));
        let mut triangles = whole.triangles().to_vec();
        triangles[0] = triangles[0].map(|corner| if corner == 0 { 8 } else { corner });
        assert!(!TriangleMesh::new(&vertices, &triangles).unwrap().is_closed());
    }

    #[test]
    fn solids_that_touch_are_closed_and_told() {
        let at = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        for beside in [at(1.0, 0.0, 0.0), at(1.0, 1.0, 0.0), at(1.0, 1.0, 1.0)] {
            let two = boxes(&[at(0.0, 0.0, 0.0), beside]);
            assert_eq!((two.is_closed(), two.is_touching(), two.solids().len()), (true, true, 2), "{beside}");
        }
        let apart = boxes(&[at(0.0, 0.0, 0.0), at(2.0, 0.0, 0.0)]);
        assert_eq!((apart.is_closed(), apart.is_touching(), apart.solids().len()), (true, false, 2));
        let two = boxes(&[at(0.0, 0.0, 0.0), at(1.0, 1.0, 0.0)]);
        let open = TriangleMesh::new(two.vertices(), &two.triangles()[1..]).unwrap();
        assert!(!open.is_closed() && !open.is_touching());
    }

    #[test]
    fn what_is_no_mesh_is_refused() {
        let at = |x: f64| Vector3::new(x, 0.0, 0.0);
        let error =
            |vertices: &[Vector3<f64>], triangles: &[[u32; 3]]| TriangleMesh::new(vertices, triangles).unwrap_err();
        assert_eq!(error(&[at(0.0), at(f64::NAN)], &[[0, 1, 0]]), MeshError::NotFinite(1));
        assert_eq!(error(&[at(0.0)], &[]), MeshError::Empty);
        assert_eq!(error(&[at(0.0)], &[[0, 0, 1]]), MeshError::NoVertex(0, 1));
        assert_eq!(error(&[at(0.0), at(1.0), at(2.0)], &[[0, 1, 2]]), MeshError::Flat);
    }
}
