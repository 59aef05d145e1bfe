//! Numbers as files state them.

pub use stead_numerics::digits::{figures, fixed};
pub use stead_numerics::unit::Unit;
