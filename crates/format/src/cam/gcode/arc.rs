//! Arcs of G-code: the centre by I, J, K or the radius R, in one of three planes, with a rise along its normal.

use super::super::arc::Arc;
use super::block::Block;
use nalgebra::Vector3;
use stead_disk::input::InputError;

/// A radius may be so much less than half the way to the end: digits as printed. m
const ROUNDING: f64 = 5e-5;

/// The arc of a block in the plane normal to an axis, about which it turns as a right-handed screw, from a place to
/// another.
pub(super) fn arc_of(
    block: &Block<'_>,
    axis: Vector3<f64>,
    [start, end]: [Vector3<f64>; 2],
    metres: f64,
) -> Result<Arc, InputError> {
    let fail = |letters: &str, problem: &str, allowed: &str| block.fail(block.first(letters), problem, allowed);
    ensure!(block.get('P').is_none(), fail("P", "an arc of several turns", "one turn or less in a block"));
    let offsets = ['I', 'J', 'K'].map(|letter| block.get(letter));
    let centre = match (block.get('R'), offsets.iter().any(Option::is_some)) {
        (Some(_), true) => return Err(fail("R", "a radius and a centre", "R, or I, J and K")),
        (None, false) => return Err(fail("XYZ", "an arc without a centre or radius", "I, J, K or R")),
        (None, true) => {
            let out = axis.iamax();
            let problem = "a centre out of the plane of the arc, or the lead of a helix";
            let allowed = "I and J with G17, I and K with G18, J and K with G19; a helix by its end alone";
            ensure!(offsets[out].is_none_or(|offset| offset == 0.0), fail(["I", "J", "K"][out], problem, allowed));
            start + Vector3::from(offsets.map(|offset| offset.unwrap_or(0.0) * metres))
        }
        (Some(radius), false) => {
            let way = end - start;
            let way = way - axis * way.dot(&axis);
            let (half, size) = (way.norm() / 2.0, (radius * metres).abs());
            ensure!(half > 1e-9, fail("R", "a full circle by its radius", "I, J, K for a full circle"));
            let problem = "a radius that is less than half the way to the end";
            ensure!(size > half - ROUNDING, fail("R", problem, "a larger radius"));
            // With a negative radius the longer of the two arcs.
            let aside = libm::sqrt((size * size - half * half).max(0.0)) * radius.signum();
            start + way / 2.0 + axis.cross(&way).normalize() * aside
        }
    };
    Ok(Arc { start, end, centre, axis, more_turns: 0 })
}
