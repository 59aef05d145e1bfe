//! What every job computes with: numbers that carry derivatives, the widest vectors of the processor, and the
//! monitor of long jobs.

pub mod monitor;
pub mod scalar;
pub mod simd;
