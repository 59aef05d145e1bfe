//! Certificates: how far a placement is from the best possible.
//!
//! For an upright tool a state depends on the radius and height of the tool centre point and on the spindle's heading against
//! its azimuth, and, by the direction of the feed against the azimuth, on one more angle. That makes bounds possible that hold
//! for every placement of the cell, every posture scheme and every plan of beta.
//!
//! 1. `arm` is the closed form, evaluated in two number types: `number` (slopes) and `enclosure` (intervals for value,
//!    gradient and second derivatives; `interval`, `elbow`, `conditioning`, `limits`).
//! 2. `table` holds, node by node, an affine model of the compliance with what it leaves out, or that no state is allowed.
//! 3. `coarse` minimises over the heading once for all placements: minorants over radius, height and direction of the feed
//!    (`minorant`).
//! 4. `region` is a box of placements (radius, height, yaw less azimuth), `cost` what a path point costs over it at least.
//! 5. `bound` adds the points up by dynamic programming over cells of heading, with the rate of beta, at the corners of a box.
//! 6. `frontier` goes through the boxes, most promising first: from below for the best placement (`best`).
//! 7. `worst` is the same for the worst placement, from above (`above`) and with the rate of beta dropped; `relaxed` what a
//!    placement is worth then.

mod active_cells;
mod arm;
mod best;
mod branch_and_bound;
mod coarse_bounds;
mod compliance_table;
mod conditioning;
mod cost;
mod elbow;
mod enclosure;
mod interval;
mod interval_simd;
mod limits;
mod lower_bound;
mod minorant;
mod model;
mod number;
mod region;
mod relaxed;
mod sliding_min;
mod upper_bound;
mod worst;

#[cfg(test)]
mod tests;

pub use best::best;
pub use branch_and_bound::{Bound, End};
pub use model::{Unfit, certifiable};
pub use region::Region;
pub use relaxed::relaxed_value;
pub use worst::worst;
