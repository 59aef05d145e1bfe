//! Dynamics of a robot that mills: passes in the time domain, modal analysis, and stability of the cut.
//!
//! - [`drive`]: springs, dampers, backlash and gravity compensation about the joints of a
//!   [chain](stead_model::robot::chain); [`arm`]: both for a robot with its spindle, in one of four [`Variant`](arm::Variant)s.
//! - [`motion`]: the commanded joint angles of a straight pass; [`setup`]: an arm with its motion.
//! - [`integrator`]: Newmark's method; [`modes`]: natural frequencies, mode shapes, frequency response.
//! - [`milling`]: the force of the teeth; [`surface`]: the workpiece as earlier teeth left it; [`roughness`]: the wall that remains.
//! - [`coupled`]: arm and milling together over a pass; [`outcome`]: the figures of such a run; [`judgement`]: whether it stayed calm.
//! - [`stability`]: semi-discretisation and the zero-order solution; [`stability_analysis`]: both for an arm in a cut;
//!   [`path_stability`]: for every point of a tool path.

pub mod arm;
pub mod coupled;
pub mod drive;
pub mod integrator;
pub mod judgement;
pub mod milling;
pub mod modes;
pub mod motion;
pub mod outcome;
pub mod path_stability;
pub mod roughness;
pub mod setup;
pub mod stability;
pub mod stability_analysis;
pub mod surface;
