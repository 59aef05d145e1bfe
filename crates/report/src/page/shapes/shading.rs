//! Normals for drawing: smooth over what is round, sharp at edges.

use super::BodyMesh;
use nalgebra::Vector3;

/// Faces that meet at a smaller angle are drawn as one smooth surface: its cosine, of 40 deg.
const SMOOTH: f64 = 0.766;

/// A mesh as it is drawn: a corner for each direction that a corner is seen under.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shaded {
    /// Corners. m
    pub positions: Vec<[f32; 3]>,
    /// Unit normal at each corner, outward.
    pub normals: Vec<[f32; 3]>,
    /// Corners of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A body with normals. Triangles without area are left out.
pub fn shaded(body: &BodyMesh) -> Shaded {
    let corner = |k: u32| Vector3::from(body.positions[k as usize].map(f64::from));
    // Twice the area of each triangle along its normal.
    let areas: Vec<Vector3<f64>> =
        body.triangles.iter().map(|&[a, b, c]| (corner(b) - corner(a)).cross(&(corner(c) - corner(a)))).collect();
    let units: Vec<Option<Vector3<f64>>> = areas.iter().map(|area| area.try_normalize(0.0)).collect();
    let mut around = vec![Vec::new(); body.positions.len()];
    for (face, triangle) in body.triangles.iter().enumerate() {
        triangle.iter().for_each(|k| around[*k as usize].push(face));
    }
    let mut drawn = Shaded::default();
    // The drawn corners of each corner, by their normals.
    let mut known: Vec<Vec<(u32, [f32; 3])>> = vec![Vec::new(); body.positions.len()];
    for (triangle, unit) in body.triangles.iter().zip(&units) {
        let Some(unit) = unit else { continue };
        let indices = triangle.map(|k| {
            let near =
                around[k as usize].iter().filter(|face| units[**face].is_some_and(|other| other.dot(unit) > SMOOTH));
            let sum: Vector3<f64> = near.map(|face| areas[*face]).sum();
            let normal = sum.try_normalize(0.0).unwrap_or(*unit);
            let normal: [f32; 3] = [normal.x as f32, normal.y as f32, normal.z as f32];
            let same = known[k as usize].iter().find(|(_, other)| (0..3).all(|i| (other[i] - normal[i]).abs() < 1e-5));
            if let Some((index, _)) = same {
                return *index;
            }
            let index = drawn.positions.len() as u32;
            drawn.positions.push(body.positions[k as usize]);
            drawn.normals.push(normal);
            known[k as usize].push((index, normal));
            index
        });
        drawn.triangles.push(indices);
    }
    drawn
}
