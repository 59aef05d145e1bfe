//! The forms that shapes have.

use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Triangles, as a mesh file holds them, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleMesh {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    is_closed: bool,
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
    /// From vertices (m) and triangles of three vertex numbers, from 0. Vertices at one place are taken once, and triangles without
    /// area are left out.
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
        let mut known: BTreeMap<[u64; 3], u32> = BTreeMap::new();
        let mut merged = Vec::new();
        let mut number_of = Vec::with_capacity(vertices.len());
        for vertex in vertices {
            // Minus zero is zero.
            let key = [vertex.x + 0.0, vertex.y + 0.0, vertex.z + 0.0].map(f64::to_bits);
            let number = *known.entry(key).or_insert_with(|| {
                merged.push(*vertex);
                merged.len() as u32 - 1
            });
            number_of.push(number);
        }
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
        let is_closed = is_closed(&kept);
        Ok(Self { vertices: merged, triangles: kept, is_closed })
    }

    /// The vertices. m
    pub fn vertices(&self) -> &[Vector3<f64>] {
        &self.vertices
    }

    /// The triangles, by numbers of vertices from 0.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Whether every edge belongs to two triangles that turn the same way, so that the mesh has an inside.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }
}

/// Whether each directed edge has its opposite, once.
fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for [a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((*from, *to)).or_insert(0) += 1;
        }
    }
    edges.iter().all(|((from, to), count)| *count == 1 && edges.get(&(*to, *from)) == Some(&1))
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
        let about = |half: Vector3<f64>| [-half, half];
        match self {
            Self::Box(edges) => about(edges / 2.0),
            Self::Cylinder { radius, length } => about(Vector3::new(*radius, *radius, length / 2.0)),
            Self::Capsule { radius, length } => about(Vector3::new(*radius, *radius, length / 2.0 + radius)),
            Self::Hull(mesh) | Self::Mesh(mesh) => {
                let first = mesh.vertices[0];
                mesh.vertices.iter().fold([first, first], |[low, high], v| [low.inf(v), high.sup(v)])
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
