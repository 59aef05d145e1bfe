//! Stability of milling (chatter) with a flexible tool tip.
//!
//! The tip moves as `x' = A x + B F`, `u = C x` ([`Plant`]), and the force of milling follows the chip, which is what
//! the tip has moved since the tooth before it passed: `F = b sum_j K_j(t) (u(t) - u(t - tau_j))` for a depth of cut b.
//! The coefficients `K_j` repeat with the turn, and every tooth has its own delay, so any pitch can be analysed. A
//! force along the tool axis moves the tip in the plane of the cut as well.
//!
//! - [`SemiDiscretisation`] follows small motions over one period (Insperger and Stépán 2004) and has the multiplier by
//!   which they grow: stable or not, flip or Hopf, how fast.
//! - [`ZeroOrder`] puts the mean of `K_j` over a turn in its place (Altintas and Budak 1995): quick, for comparison; it
//!   cannot see flips, and misses what hangs on short contact.
//! - [`lobes`] has both over the spindle speed.

mod directional;
mod floquet;
mod lobes;
mod plant;
#[cfg(test)]
mod tests;
mod zero_order;

pub use floquet::{Kind, SemiDiscretisation, Verdict};
pub use lobes::{Lobe, lobes};
pub use plant::{Plant, PlantError};
pub use zero_order::{ZeroOrder, ZeroOrderError};
