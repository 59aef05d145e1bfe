//! Elastic calibration: joint compliances from measurements, which measurements to take, and what to command so that the
//! loaded tool follows its path.

pub mod compensation;
pub mod identification;
