//! Programs of small runs on imported arms: what is in them, what is refused, and what the reader of programs finds.

mod bench;
mod external_axes;
mod imported_arms;
mod reading;
mod status;
mod transfer_paths;
mod writers;
