//! Critical depth of cut over spindle speed.

use super::floquet::SemiDiscretisation;
use super::plant::Plant;
use super::zero_order::{ZeroOrder, ZeroOrderError};
use crate::milling::PassCut;
use rayon::prelude::*;
use serde::Serialize;
use stead_model::cutting::Cutter;

/// Critical depths of cut at a spindle speed; `None` where all depths up to the largest are stable.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Lobe {
    /// Angular speed of the spindle. rad/s
    pub spindle_speed: f64,
    /// By semi-discretisation. m
    pub semi_discretisation: Option<f64>,
    /// By the zero-order solution. m
    pub zero_order: Option<f64>,
}

/// Critical depths up to `max_depth` (m) at spindle speeds (rad/s), in their order, for the cut at hand otherwise.
///
/// # Errors
/// [`ZeroOrderError`] for a width of cut that is none, and for speeds that are too slow for the zero-order solution.
pub fn lobes(
    plant: &Plant,
    cutter: &Cutter,
    cut: &PassCut,
    spindle_speeds: &[f64],
    max_depth: f64,
) -> Result<Vec<Lobe>, ZeroOrderError> {
    let zero_order = ZeroOrder::new(plant);
    let lobe = |&spindle_speed: &f64| {
        let cut = PassCut { spindle_speed, ..*cut };
        Ok(Lobe {
            spindle_speed,
            semi_discretisation: SemiDiscretisation::new(plant, cutter, &cut)?.critical_depth(max_depth),
            zero_order: zero_order.critical_depth(cutter, &cut, max_depth)?,
        })
    };
    spindle_speeds.par_iter().map(lobe).collect()
}
