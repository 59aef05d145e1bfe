//! Blocks of a [descent](super::descent): each improves some of what may vary at a placement, the rest held.

pub(super) mod ahead;
pub(super) mod axis;
pub(super) mod gradient;
pub(super) mod motion;
pub(super) mod neighbours;
