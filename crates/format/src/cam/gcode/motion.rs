//! How the tool moves from block to block.

/// How the tool moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    Rapid,
    Line,
    /// A hole at each position, by a canned cycle.
    Cycle,
    /// Seen against the normal of the plane.
    Clockwise,
    CounterClockwise,
}
