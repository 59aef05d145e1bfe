//! Bodies that stand for things whose shape is not known, in the paints of such illustrations.

use super::loft::Solid;
use super::{BodyFrame, BodyMesh};

/// The paints of the illustrations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Paint {
    Body,
    Dark,
    Steel,
    Spindle,
    Tool,
    Part,
}

impl Paint {
    /// Red, green and blue, sRGB from 0 to 1.
    fn color(self) -> [f32; 3] {
        let bytes: [u8; 3] = match self {
            Self::Body => [198, 204, 212],
            Self::Dark => [58, 64, 74],
            Self::Steel => [176, 186, 198],
            Self::Spindle => [43, 92, 138],
            Self::Tool => [214, 178, 72],
            Self::Part => [186, 197, 209],
        };
        bytes.map(|byte| f32::from(byte) / 255.0)
    }
}

/// An illustration out of closed surfaces.
pub(super) fn illustration(name: &str, frame: BodyFrame, paint: Paint, solid: Solid) -> BodyMesh {
    let Solid { positions, triangles } = solid;
    BodyMesh { name: name.to_owned(), frame, color: paint.color(), positions, triangles, is_illustration: true }
}
