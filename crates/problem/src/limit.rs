//! The limits that can hold an optimum, and a bound that does.

use serde::Serialize;

/// A limit that can hold an optimum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// A wall of the cell in x.
    CellX,
    /// A wall of the cell in y.
    CellY,
    /// A wall of the cell in z.
    CellZ,
    /// A bound of the cell on the yaw.
    CellYaw,
    /// A limit of a joint, from 1.
    Joint(u8),
    /// A limit of the sum of joints 2 and 3.
    AxesSum,
    /// The speed of a joint, from 1: what bounds its steps between path points; of joint 3 of an arm with a linkage
    /// those of the sum of joints 2 and 3.
    JointStep(u8),
    /// The bound on 1/kappa_F.
    Conditioning,
    /// The rate of beta along the path.
    BetaRate,
    /// The turn of the spindle in space along the path, by the length of the path.
    SpindleTurn,
    /// The same by the time that it takes.
    SpindleSpeed,
    /// The largest score of a point.
    MaxDeflection,
    /// The smallest distance of the path from axis 1.
    BaseDistance,
    /// The distance that two shapes have to keep: the number of their pair in the scene.
    Clearance(usize),
    /// A zone that a point of the arm stays out of: the number of their pair in the scene.
    KeepOut(usize),
    /// The range of the lead.
    Lead,
    /// The range of the tilt.
    Tilt,
    /// The largest angle between the tool axis and that of the path.
    MaxLean,
    /// The highest ridge between passes.
    Scallop,
    /// The distance between passes, half of which the contact may move aside.
    StepOver,
    /// How far the contact may leave its line between points.
    ContactTolerance,
}

impl Limit {
    /// The walls of the cell: x, y, z, yaw.
    pub const ALL_WALLS: [Self; 4] = [Self::CellX, Self::CellY, Self::CellZ, Self::CellYaw];
}

/// One side of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Side {
    /// The limit.
    pub limit: Limit,
    /// Whether it is the upper one.
    pub is_upper: bool,
}

/// A bound that holds an optimum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ActiveBound {
    /// Which.
    pub side: Side,
    /// Of two shapes that have to keep a distance, or a point of the arm and a zone: their names.
    pub names: Option<[String; 2]>,
    /// How much the objective improves (falls for the best placement, rises for the worst) when the bound gives way by
    /// one unit, to first order: m per m for walls of x, y, z, distances and deflections, m per rad for angles, m per
    /// rad/m for the rate of beta and the turn of the spindle along the path, m per rad/s for speeds of joints and
    /// spindle, m per unit of 1/kappa_F.
    pub gain: f64,
}
