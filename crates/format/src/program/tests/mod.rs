//! Programs of small runs on imported arms: what is in them, what is refused, and what the reader of programs finds.

pub(crate) mod bench;
mod external_axes;
mod reading;
mod status;
mod ways;
mod writers;
