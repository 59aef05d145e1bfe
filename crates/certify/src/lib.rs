//! Certificates: how far a placement is from the best possible.
//!
//! For an upright tool a state depends on the radius and height of the tool centre point and on the spindle's heading
//! against its azimuth ([`stead_problem::symmetry`]), and, by the direction of the feed against the azimuth, on one
//! more angle. That makes bounds possible that hold for every placement of the cell, every posture scheme and every
//! plan of beta.
//!
//! 1. `arm` is the closed form, evaluated in the two number types (`number`) of `enclosure`: value and gradient, and
//!    intervals for value, gradient and second derivatives over a region (`interval_simd`, `continuation`).
//! 2. `compliance_table` holds, node by node, an affine model of the compliance with its remainder (of how the arm
//!    yields to moments too, `moment`), or that no state is allowed.
//! 3. `load` is what acts on a point and what of its deflection is scored, with the lower bound of the score that is
//!    linear in the compliance; `coarse_bounds` minimises it over the heading once for all placements:
//!    minorants over radius, height and direction of the load (`minorant`), for kinds of load (`kind`).
//! 4. `cell` is the cell seen along axis 1, `region` a box of placements, `cost` a bound of a path point's score over
//!    it.
//! 5. `model` puts these together. `lower_bound` adds the points up by dynamic programming over cells of heading
//!    (`active_cells`, `sliding_min`), with the limits on beta, at the corners of a box.
//! 6. `branch_and_bound` goes through the boxes, most promising first: from below for the best placement (`best`).
//!    `keeps_open` counts what a bound that falls short leaves undecided, `forecast` says when a gap will be reached.
//!    `leaning` is all of this for tools that lean, in other coordinates.
//! 7. `part` is a problem as a tree of what is bounded by itself: orientations of the part, of which the least bound
//!    holds, and segments where external axes have another position for each. `requirements` is what bounds need of
//!    each, with external axes at one position as part of the cell.
//! 8. `worst` is the same for the worst placement, from above (`upper_bound`) and with the rate of beta dropped;
//!    `relaxed` is the objective of a placement then.
//!
//! ```
//! use stead_certify::certify;
//! use stead_numerics::monitor::Monitor;
//! use stead_problem::problem::{Cell, Interval, Placement};
//! use stead_problem::{settings::CertificateSettings, testing::five_segments};
//! // The published case where the workpiece may be moved by 2 mm and turned by 2 deg: nothing in there is better than
//! // the placement found, with 0.1075 mm in the mean, by more than a twentieth.
//! let range = |min, max| Interval { min, max };
//! let position = [range(-1e-3, 1e-3), range(-1.642, -1.64), range(-0.216, -0.214)];
//! let cell = Cell { position, yaw: range(78_f64.to_radians(), 80_f64.to_radians()) };
//! let found = Placement::from_mm_deg([0.0284, -1640.0, -214.0], 78.9664);
//! let settings = CertificateSettings::new(0.05);
//! let proof = certify(&five_segments().in_cell(cell), &found, 0.1075e-3, None, settings, &Monitor::silent()).best?;
//! assert!(proof.bound.bound >= 0.95 * 0.1075e-3 && proof.bound.bound <= 0.1075e-3, "{:?}", proof.bound);
//! # Ok::<(), stead_certify::NoProof>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

mod active_cells;
mod apart;
mod arm;
mod best;
mod branch_and_bound;
mod cell;
mod certificate;
mod coarse_bounds;
mod compliance_table;
mod continuation;
mod cost;
mod enclosure;
mod forecast;
mod interval_simd;
mod keeps_open;
mod kind;
mod leaning;
mod load;
mod lower_bound;
mod minorant;
mod model;
mod moment;
mod number;
mod part;
mod region;
mod relaxed;
mod requirements;
mod shared_cells;
mod sliding_min;
mod upper_bound;
mod worst;

#[cfg(test)]
mod tests;

pub use branch_and_bound::{Bound, OpenIn, Status};
pub use certificate::{
    BOUND_DECIMALS, Certificate, MAX_GAP_PERCENT, NoProof, OpenBox, Proof, Relaxation, certify, no_certificate,
};
pub use forecast::{Forecast, Outlook};
pub use keeps_open::KeepsOpen;
pub use part::{best, certifiable, expected_cost};
pub use region::Region;
pub use relaxed::relaxed_value;
pub use worst::worst;
