//! What every job computes with: numbers that carry derivatives, the widest vectors of the processor, rotations, warnings, and
//! the monitor of long jobs.

pub mod digits;
pub mod mean_max;
pub mod message;
pub mod monitor;
pub mod rotation;
pub mod scalar;
pub mod simd;
pub mod unit;
