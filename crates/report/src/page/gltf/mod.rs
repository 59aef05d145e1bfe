//! `cell.glb`: the cell as an animated scene for any viewer of glTF 2.0 (Khronos 2021), the robot moving along its best
//! plan.
//!
//! glTF has y upwards: the node of the base is turned by -90 deg about x, and everything below it is in the robot's own
//! frames, in m. Row i of the arm is a node that stands still and in it the node `joint i`, whose rotation is animated;
//! an external axis is a node whose place or rotation is animated, with all that it carries.

mod axes;
use stead_document::gltf_buffer as buffer;
mod document;
mod kept;
mod motion;
mod path;
mod scene;

pub(crate) use kept::scene;
pub use motion::{Motion, Stop};
pub use scene::{Cell, glb};

/// `cell.glb`.
pub(crate) const SCENE: &str = "cell.glb";

#[cfg(test)]
mod tests;
