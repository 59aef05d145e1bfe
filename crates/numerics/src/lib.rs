//! What every job computes with: numbers that carry derivatives, the widest vectors of the processor, and warnings.

pub mod message;
pub mod scalar;
pub mod simd;
