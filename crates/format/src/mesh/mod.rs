//! Mesh files: STL, binary and ASCII, OBJ, and DAE.
//!
//! Only DAE states its unit, which is taken into account. What a file can get wrong is refused with its name, the line
//! or the triangle, and the value.

mod dae;
mod obj;
#[cfg(test)]
mod shipped_part;
mod stl;
#[cfg(test)]
mod tests;

use crate::file_kind::FileKind;
use nalgebra::Vector3;
use std::path::Path;
use stead_cell::{MeshError, TriangleMesh};
use stead_disk::input::InputError;

/// The unit of length of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeshUnit {
    /// Millimetres.
    Millimetre,
    /// Metres.
    Metre,
}

impl MeshUnit {
    /// Its length. m
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Metre => 1.0,
        }
    }
}

/// The role of mesh files among the inputs of a run.
pub const MESH: &str = "mesh";

/// Endings of the names of mesh files that are read.
pub(crate) const ENDINGS: [&str; 3] = ["stl", "obj", "dae"];

/// Vertices as a file has them, and triangles of three of them, from 0.
#[derive(Debug, Default)]
struct Triangles {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
}

/// No coordinate of a cell is larger. m
const LARGEST: f64 = 1e3;
/// A finer mesh costs more than it tells.
const MAX_TRIANGLES: usize = 1_000_000;
const THINNER: &str = "at most 1000000 triangles: a mesh for collision checks needs no more than some thousands";

/// The triangles of a mesh file: OBJ where its name ends with `.obj`, DAE where it ends with `.dae`, whose metres by
/// its own unit are taken in the unit given, else STL. Vertices at one place are one, and the triangles of a closed
/// mesh face outwards.
///
/// # Errors
/// [`InputError`] with file and line, or the number of the triangle from 1: what is no STL, OBJ or DAE, a file that is
/// cut off, a number that is not finite, coordinates beyond 1000 m, no triangles, or none with an area.
pub fn read_mesh(file: &Path, bytes: &[u8], unit: MeshUnit) -> Result<TriangleMesh, InputError> {
    let is = |ending: &str| file.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending));
    match FileKind::of(bytes) {
        Some(kind @ FileKind::Step) => return Err(kind.refused(file)),
        // A DAE is XML, and names in an OBJ may look like words of other files.
        _ if is("dae") || is("obj") => (),
        _ => FileKind::expect(&[], file, bytes, "a mesh file: STL, OBJ or DAE, each with its ending")?,
    }
    let read = if is("obj") {
        obj::read(file, bytes)?
    } else if is("dae") {
        dae::read(file, bytes)?
    } else {
        stl::read(file, bytes)?
    };
    let vertices: Vec<Vector3<f64>> = read.vertices.iter().map(|vertex| vertex * unit.metres()).collect();
    if let Some(far) = vertices.iter().position(|vertex| vertex.iter().any(|c| c.abs() > LARGEST)) {
        let found =
            read.vertices[far].iter().fold(0.0_f64, |largest, c| if c.abs() > largest.abs() { *c } else { largest });
        let problem = format!("has a coordinate beyond {} m in vertex {}", LARGEST, far + 1);
        return Err(InputError::new(file, problem)
            .found(found.to_string())
            .allowed("coordinates within 1000 m; is the unit right?"));
    }
    let no_mesh =
        |error: MeshError| InputError::new(file, error.to_string()).allowed("a mesh of triangles with an area");
    let mesh = TriangleMesh::new(&vertices, &read.triangles).map_err(no_mesh)?;
    if !(mesh.is_closed() && volume(&mesh) < 0.0) {
        return Ok(mesh);
    }
    // Its triangles face inwards: what is inside of it would count as outside.
    let turned: Vec<[u32; 3]> = mesh.triangles().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    TriangleMesh::new(mesh.vertices(), &turned).map_err(no_mesh)
}

/// The volume within a closed mesh; below zero where its triangles face inwards. m^3
fn volume(mesh: &TriangleMesh) -> f64 {
    // About a vertex, so that no large coordinates cancel.
    let about = mesh.vertices().first().copied().unwrap_or_default();
    let corners = |triangle: &[u32; 3]| triangle.map(|number| mesh.vertices()[number as usize] - about);
    mesh.triangles().iter().map(corners).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
}
