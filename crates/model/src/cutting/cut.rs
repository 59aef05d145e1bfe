//! The cut: how wide, how deep and in which direction, on which side the wall stands, and its frame.

use super::cutter::Cutter;
use super::rotation::Rotation;
use nalgebra::Vector3;
use serde::Serialize;

/// A side of the path, seen in the feed direction with the tool axis pointing up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Side {
    /// Towards `axis x feed`.
    Left,
    /// Away from it.
    Right,
}

impl Side {
    /// +1 for left, -1 for right.
    pub(super) fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// How the teeth meet the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum MillingDirection {
    /// Up milling: the chip starts at zero thickness.
    Conventional,
    /// Down milling: the chip ends at zero thickness.
    Climb,
}

impl MillingDirection {
    /// The side of the path on which the machined wall stands.
    pub fn wall(self, rotation: Rotation) -> Side {
        match (rotation, self) {
            (Rotation::Clockwise, Self::Conventional) | (Rotation::Counterclockwise, Self::Climb) => Side::Left,
            (Rotation::Clockwise, Self::Climb) | (Rotation::Counterclockwise, Self::Conventional) => Side::Right,
        }
    }
}

/// The cross section of a cut along a wall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cut {
    /// Conventional (up) or climb (down) milling; with the rotation of the cutter this says on which side the wall is.
    pub direction: MillingDirection,
    /// Width of cut a_e; the whole diameter is a slot, with work on both sides of the tool. m
    pub radial_depth: f64,
    /// Depth of cut a_p. m
    pub axial_depth: f64,
}

impl Cut {
    /// The sign with which the angle psi of a tooth from the wall changes: climb milling ends at the wall, conventional
    /// milling starts there.
    pub fn sense(&self) -> f64 {
        match self.direction {
            MillingDirection::Climb => -1.0,
            MillingDirection::Conventional => 1.0,
        }
    }

    /// Whether the work is on both sides of the tool.
    pub fn is_slot(&self, cutter: &Cutter) -> bool {
        self.radial_depth >= cutter.diameter()
    }
}

/// The directions of a cut in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutFrame {
    /// Of the feed.
    pub feed: Vector3<f64>,
    /// Out of the wall.
    pub normal: Vector3<f64>,
    /// From the work to the spindle.
    pub axis: Vector3<f64>,
}

impl CutFrame {
    /// With the wall on a side of the feed; `axis` points from the work to the spindle. The component of the feed along
    /// the axis is left out.
    pub fn new(feed: Vector3<f64>, axis: Vector3<f64>, wall: Side) -> Self {
        let left = axis.cross(&feed).normalize();
        Self { feed: left.cross(&axis), normal: if wall == Side::Right { left } else { -left }, axis }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wall_of_climb_milling_is_to_the_right_of_the_feed() {
        let (feed, up) = (Vector3::x(), Vector3::z());
        let frame = |feed, direction: MillingDirection, rotation| CutFrame::new(feed, up, direction.wall(rotation));
        let climb = frame(feed, MillingDirection::Climb, Rotation::Clockwise);
        assert_eq!((climb.feed, climb.normal), (feed, Vector3::y()));
        let conventional = frame(feed, MillingDirection::Conventional, Rotation::Clockwise);
        assert_eq!((conventional.feed, conventional.normal), (feed, -Vector3::y()));
        // A left-hand cutter has it on the other side.
        assert_eq!(frame(feed, MillingDirection::Climb, Rotation::Counterclockwise), conventional);
        // A feed that goes down a little is one in the plane of the cut.
        let sloping = frame(Vector3::new(0.8, 0.0, -0.6), MillingDirection::Climb, Rotation::Clockwise);
        assert!((sloping.feed - feed).norm() < 1e-15 && (sloping.normal - Vector3::y()).norm() < 1e-15);
    }
}
