//! Where the files of the shapes are.

use super::read::Urdf;
use crate::mesh::{ENDINGS, MeshUnit};
use nalgebra::Vector3;
use std::path::{Path, PathBuf};

/// The unit of a mesh file by its scale in the URDF, which is in metres; nothing of another scale.
pub(super) fn unit_of(scale: &Vector3<f64>) -> Option<MeshUnit> {
    let is_of = |unit: &MeshUnit| (scale - Vector3::repeat(unit.metres())).amax() <= 1e-9 * unit.metres();
    [MeshUnit::Metre, MeshUnit::Millimetre].into_iter().find(is_of)
}

/// A name, with a number behind it where it is that of another thing.
pub(super) fn free_name(plain: String, mut is_free: impl FnMut(&str) -> bool) -> String {
    let numbered = (2..).map(|number| format!("{plain} {number}"));
    std::iter::once(plain.clone()).chain(numbered).find(|name| is_free(name)).unwrap_or_default()
}

/// Whether a mesh file is of a format that is read.
pub(super) fn is_read(file: &str) -> bool {
    Path::new(file).extension().is_some_and(|own| ENDINGS.iter().any(|ending| own.eq_ignore_ascii_case(ending)))
}

/// The files of the shapes that are not found.
pub(super) fn missing(urdf: &Urdf) -> Vec<String> {
    let names = urdf.links.iter().flat_map(|link| &link.meshes);
    let mut missing: Vec<String> = names.filter(|name| found(urdf, name).is_none()).cloned().collect();
    missing.sort();
    missing.dedup();
    missing
}

/// The file of a shape, where it is found: by a relative path from the folder of the URDF, one of a package
/// (`package://name/..`) from the nearest folder above it that has the package, or the rest of the path, in it.
pub(super) fn found(urdf: &Urdf, name: &str) -> Option<PathBuf> {
    let folder = std::path::absolute(&urdf.file).unwrap_or_default();
    let folder = folder.parent().unwrap_or(Path::new("."));
    let places: Vec<PathBuf> = if let Some(path) = name.strip_prefix("package://") {
        let rest = path.split_once('/').map_or(path, |(_, rest)| rest);
        folder.ancestors().flat_map(|above| [above.join(path), above.join(rest)]).collect()
    } else {
        vec![folder.join(name.strip_prefix("file://").unwrap_or(name))]
    };
    places.into_iter().find(|place| place.is_file())
}
