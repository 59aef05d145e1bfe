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

    /// By what people know it, which is its key in a run file where it has one, and its name in the table of a study.
    pub fn names(self) -> [String; 2] {
        let (known, in_table) = match self {
            Self::Joint(joint) => return [format!("limit of joint {joint}"), format!("joint_{joint}")],
            Self::JointStep(joint) => return [format!("speed of joint {joint}"), format!("joint_{joint}_step")],
            Self::CellX => ("cell.x_mm", "x"),
            Self::CellY => ("cell.y_mm", "y"),
            Self::CellZ => ("cell.z_mm", "z"),
            Self::CellYaw => ("cell.yaw_deg", "yaw"),
            Self::AxesSum => ("limit of axes 2+3", "axes_2_3"),
            Self::Conditioning => ("constraints.min_inverse_condition", "inverse_condition"),
            Self::BetaRate => ("redundancy.max_beta_rate_deg_per_mm", "beta_rate"),
            Self::SpindleTurn => ("redundancy.max_spindle_turn_deg_per_mm", "spindle_turn"),
            Self::SpindleSpeed => ("redundancy.max_spindle_turn_deg_per_s", "spindle_turn"),
            Self::MaxDeflection => ("constraints.max_deflection_mm", "deflection"),
            Self::BaseDistance => ("constraints.min_base_distance_mm", "base_distance"),
            Self::Clearance(_) => ("collision.clearance_mm", "clearance"),
            Self::KeepOut(_) => ("keep_out", "keep_out"),
            Self::Lead => ("lean.lead_deg", "lead"),
            Self::Tilt => ("lean.tilt_deg", "tilt"),
            Self::MaxLean => ("lean.max_lean_deg", "lean"),
            Self::Scallop => ("lean.scallop_mm", "scallop"),
            Self::StepOver => ("lean.step_over_mm", "step_over"),
            Self::ContactTolerance => ("lean.contact_tolerance_mm", "contact_tolerance"),
        };
        [known, in_table].map(str::to_owned)
    }
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
