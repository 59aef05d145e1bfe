//! The workpiece surface as earlier teeth left it, exactly (the "eraser of matter" method).
//!
//! Frame: x along the feed, y along the outward normal of the wall that is made. The nominal wall is y = 0, the stock
//! reaches from there up to y = a_e, and from x = 0 to its length. Below y = 0 it goes on.
//!
//! A tooth sweeps the disc sector between tool centre and its edge. What it leaves is known from where the centre was
//! when it passed: an arc about that centre. So the surface is not stored as points or chords but as the [`Trail`] of
//! the centre, common to all slices and teeth, and the material on a ray from the present centre begins at the farthest
//! of the arcs of all earlier passes ([`Passes::clear`]). Regeneration, runout, unequal pitch, loss of contact and the
//! teeth before the last one need nothing more.

mod passes;
mod rays;
mod trail;

pub use passes::{Passes, Predecessor, ToothQuery};
pub(super) use rays::starts;
pub use rays::{LANES, Rays, Stock};
pub use trail::{Extent, Extents, Node, Trail};
