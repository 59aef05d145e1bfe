//! How far the rows, as they are written, are from the URDF.

use super::arm::Arm;
use super::forward::tip_at;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_model::robot::Pose;

/// Random postures that rows and URDF are compared in.
pub const POSTURES: usize = 2000;

/// The largest differences of the tip link's pose by the rows from that by the URDF, over random postures within the
/// limits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// Of the position. mm
    pub position_mm: f64,
    /// Of the orientation. deg
    pub angle_deg: f64,
}

/// Compares rows with their URDF, within the limits of the URDF.
pub(super) fn deviation(arm: &Arm<'_>) -> Deviation {
    let Arm { urdf, chain, rows, robot, limits, .. } = arm;
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut largest = Deviation::default();
    for _ in 0..POSTURES {
        let values = limits.map(|[lower, upper]| lower + (upper - lower) * random.random::<f64>());
        let theta = std::array::from_fn(|k| {
            let row = &rows.rows[k];
            row.sign * values[k] + row.offset_deg.to_radians()
        });
        let by_rows = rows.link_from_base.then(&robot.forward(&theta)).then(&rows.flange_from_tip);
        let here = difference(&by_rows, &tip_at(urdf, chain, &values));
        largest.position_mm = largest.position_mm.max(here.position_mm);
        largest.angle_deg = largest.angle_deg.max(here.angle_deg);
    }
    largest
}

fn difference(a: &Pose<f64>, b: &Pose<f64>) -> Deviation {
    // A rotation by an angle changes a frame by 2 sqrt(2) sin(angle / 2) in the Frobenius norm.
    let half = (a.rotation - b.rotation).norm() / (2.0 * std::f64::consts::SQRT_2);
    Deviation {
        position_mm: (a.translation - b.translation).norm() * 1e3,
        angle_deg: 2.0 * libm::asin(half.min(1.0)).to_degrees(),
    }
}
