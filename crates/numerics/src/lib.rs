//! What every job computes with: numbers that carry derivatives, and the widest vectors of the processor.

pub mod scalar;
pub mod simd;
