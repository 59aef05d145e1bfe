//! How the arm moves while it mills, and whether that stays calm.
//!
//! [`multibody`] is a serial chain of revolute joints with bodies, [`drive`] what springs, dampers and compensators do
//! about its joints, [`arm`] the chain and drives of a robot with its spindle in one of four [`Variant`](arm::Variant)s,
//! [`motion`] the way that the joints are commanded, [`setup`] an arm with its motion, [`integrator`] Newmark's method,
//! [`modes`] what swings how fast. [`milling`] is the cutter and its force, [`surface`] the work as earlier teeth left it,
//! [`roughness`] the wall that stays, [`coupled`] all of them on a pass, [`outcome`] what that tells. [`stability`] tells whether small motions die out, [`analysis`] that of an arm in a cut, and
//! [`chatter`] the same along a tool path.

pub mod arm;
pub mod coupled;
pub mod drive;
pub mod integrator;
pub mod milling;
pub mod modes;
pub mod motion;
pub mod multibody;
pub mod outcome;
pub mod path_stability;
pub mod roughness;
pub mod setup;
pub mod stability;
pub mod stability_analysis;
pub mod surface;
