//! What people look at in a browser or a 3-D viewer: the shapes of a cell, pages, and the animated scene.

mod base64;
pub mod cards;
pub mod gltf;
pub mod shapes;

/// The name of a page.
pub(crate) const PAGE: &str = "report.html";
