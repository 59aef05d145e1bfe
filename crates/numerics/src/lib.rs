//! What every job computes with: numbers that carry derivatives, the widest vectors of the processor, rotations,
//! warnings, and the monitor of long jobs.
//!
//! ```
//! use stead_numerics::monitor::Monitor;
//! use stead_numerics::scalar::{Dual, Scalar};
//! // A function of numbers with or without derivatives: the square of the distance from the origin.
//! fn square<T: Scalar>(x: T, y: T) -> T {
//!     x * x + y * y
//! }
//! let there = square(Dual::<2>::variable(3.0, 0), Dual::variable(4.0, 1));
//! assert_eq!(there.value, square(3.0, 4.0));
//! assert_eq!(there.gradient, [6.0, 8.0]);
//!
//! let monitor = Monitor::new(|progress| println!("{progress:?}"));
//! monitor.stop_handle().stop();
//! assert!(monitor.should_stop());
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod digits;
pub mod mean_max;
pub mod message;
pub mod monitor;
pub mod rotation;
pub mod scalar;
pub mod simd;
pub mod unit;
pub mod word;
