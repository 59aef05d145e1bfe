//! What people look at in a browser or a 3-D viewer: the shapes of a cell, pages, and the animated scene.

pub mod gltf;
pub mod shapes;
