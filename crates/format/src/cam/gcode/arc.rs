//! Arcs of G-code: the centre by I, J, K or the radius R, in one of three planes, with a rise along its normal.

use super::super::ReadSettings;
use super::super::arc::{Arc, ArcError};
use super::block::Block;
use super::state::State;
use nalgebra::Vector3;
use stead_disk::input::InputError;

/// A radius may be so much less than half the way to the end: digits as printed. m
const ROUNDING: f64 = 5e-5;

/// The states along an arc in the plane normal to an axis of the machine, about which it turns as a right-handed screw;
/// the end last.
pub(super) fn arc_of(
    settings: &ReadSettings,
    block: &Block<'_>,
    axis: Vector3<f64>,
    [from, end]: [&State; 2],
    metres: f64,
) -> Result<Vec<State>, InputError> {
    let word = |letters: &str| block.words.iter().find(|(letter, _)| letters.contains(*letter)).copied();
    let fail =
        |letters: &str, problem: &str, allowed: &str| block.fail(word(letters).unwrap_or(('G', 2.0)), problem, allowed);
    if end.angles != from.angles {
        return Err(fail("ABC", "an arc that turns the tool", "arcs at a constant tool axis"));
    }
    let turns_workpiece = settings.machine.is_some() && end.angles != [0.0; 3];
    if turns_workpiece {
        return Err(fail(
            "IJKR",
            "an arc with a tilted tool, whose plane is that of the machine",
            "straight moves there",
        ));
    }
    if let Some(turns) = block.get('P') {
        return Err(block.fail(('P', turns), "an arc of several turns", "one turn or less in a block"));
    }
    let [start, last] = [from.programmed(), end.programmed()];
    let offsets = ['I', 'J', 'K'].map(|letter| block.get(letter));
    let centre = match (block.get('R'), offsets.iter().any(Option::is_some)) {
        (Some(_), true) => return Err(fail("R", "a radius and a centre", "R, or I, J and K")),
        (None, false) => return Err(fail("XYZ", "an arc without a centre or radius", "I, J, K or R")),
        (None, true) => {
            if offsets[axis.iamax()].is_some_and(|offset| offset != 0.0) {
                return Err(fail(
                    "IJK",
                    "a centre out of the plane of the arc",
                    "I and J with G17, I and K with G18, J and K with G19",
                ));
            }
            start + Vector3::from(offsets.map(|offset| offset.unwrap_or(0.0) * metres))
        }
        (Some(radius), false) => {
            let way = last - start;
            let way = way - axis * way.dot(&axis);
            let (half, size) = (way.norm() / 2.0, (radius * metres).abs());
            if half < 1e-9 {
                return Err(fail("R", "a full circle by its radius", "I, J, K for a full circle"));
            }
            if size < half - ROUNDING {
                return Err(fail("R", "a radius that is less than half the way to the end", "a larger radius"));
            }
            // With a negative radius the longer of the two arcs.
            let aside = libm::sqrt((size * size - half * half).max(0.0)) * radius.signum();
            start + way / 2.0 + axis.cross(&way).normalize() * aside
        }
    };
    let arc = Arc { start, end: last, centre, axis, more_turns: 0 };
    let points = arc.points(&settings.resampling).map_err(|error| match error {
        ArcError::Axis => fail("IJKR", "an arc without a normal", "G17, G18 or G19"),
        ArcError::Radius(from, to) => {
            let [from, to] = [from, to].map(|radius| format!("{:.4} mm", radius * 1e3));
            let problem = format!("the arc misses its end: radius {from} at its start, {to} there");
            fail("IJKR", &problem, "the same radius, above 0, within 0.05 mm")
        }
    })?;
    Ok(points.into_iter().map(|point| State { position: [point.x, point.y, point.z].map(Some), ..*end }).collect())
}
