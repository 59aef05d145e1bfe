//! Critical depth of cut over spindle speed.

use super::floquet::SemiDiscretisation;
use super::plant::Plant;
use super::zero_order::ZeroOrder;
use crate::stability_error::StabilityError;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_model::cutting::{Cutter, PassCut};
use stead_numerics::monitor::{Monitor, Progress};

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
/// [`StabilityError::ZeroOrder`] for a width of cut that is none, and for speeds that are too slow for the zero-order
/// solution; [`StabilityError::Stopped`] when `monitor` asked to stop before the last.
pub fn lobes(
    plant: &Plant,
    cutter: &Cutter,
    cut: &PassCut,
    spindle_speeds: &[f64],
    max_depth: f64,
    monitor: &Monitor,
) -> Result<Vec<Lobe>, StabilityError> {
    let zero_order = ZeroOrder::new(plant);
    let (done, total) = (AtomicUsize::new(0), spindle_speeds.len());
    let lobe = |&spindle_speed: &f64| {
        monitor.go_on()?;
        let cut = PassCut { spindle_speed, ..*cut };
        let lobe = Lobe {
            spindle_speed,
            semi_discretisation: SemiDiscretisation::new(plant, cutter, &cut)?.critical_depth(max_depth),
            zero_order: zero_order.critical_depth(cutter, &cut, max_depth)?,
        };
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        monitor.report(Progress::Steps { stage: "stability lobes", done, total });
        Ok(lobe)
    };
    spindle_speeds.par_iter().map(lobe).collect()
}
