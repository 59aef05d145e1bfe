//! Links between cuts that are programmed at feed: level runs in the air.
//!
//! A run of moves at feed normal to the tool axis is a link if the move before leads out along the axis and the one
//! behind in along it, and if it is as high as rapid moves end. Where rapid moves are made at feed throughout, an
//! operation goes down to its level of links in one move and into the part in the next.

use super::{Move, Program};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Moves closer to a direction than this are along it. cos
const ALONG: f64 = 0.99;
/// As [`ALONG`], for the first move down of an operation. cos
const STRAIGHT_DOWN: f64 = 0.999;
/// Moves closer to the plane normal to the axis than this are in it. sin
const LEVEL: f64 = 1e-4;
/// Places and axes that differ by less are the same. m
const SAME: f64 = 1e-9;
/// A rounding of directions under which they are counted as one.
const SAME_AXIS: f64 = 1e-5;

/// Makes links rapid moves, and notes how long they are.
pub(super) fn take_out(program: &mut Program) {
    let levels = levels(program);
    let moves = &mut program.moves;
    let mut length = 0.0;
    let mut start = 1;
    while start < moves.len() {
        let axis = moves[start].axis;
        let is_level = |at: usize| {
            let (before, here) = (&moves[at - 1], &moves[at]);
            let way = direction(before, here);
            !here.is_rapid
                && (here.axis - before.axis).norm() < SAME_AXIS
                && (here.axis - axis).norm() < SAME_AXIS
                && way.is_some_and(|way| way.dot(&axis).abs() < LEVEL)
                && here.position.dot(&axis) > levels[at] - 1e-9
        };
        let end = (start..moves.len()).find(|at| !is_level(*at)).unwrap_or(moves.len());
        let leads = |at: usize, sense: f64| {
            direction(&moves[at - 1], &moves[at]).is_some_and(|way| sense * way.dot(&axis) > ALONG)
        };
        let is_link = end > start && start > 1 && end < moves.len() && !moves[start - 1].is_rapid;
        if is_link && leads(start - 1, 1.0) && leads(end, -1.0) {
            for at in start..end {
                length += (moves[at].position - moves[at - 1].position).norm();
                moves[at].is_rapid = true;
            }
        }
        start = end.max(start + 1);
    }
    if length > 0.0 {
        let millimetres = (length * 1e3).round();
        program
            .note(format!("links at feed, taken as rapid moves: {millimetres} mm (--keep-links takes them as cuts)"));
    }
}

/// How high a link is at least, move by move. m
fn levels(program: &Program) -> Vec<f64> {
    let moves = &program.moves;
    let key = |axis: &Vector3<f64>| [axis.x, axis.y, axis.z].map(|value| (value / SAME_AXIS).round() as i64);
    let mut tops: BTreeMap<[i64; 3], f64> = BTreeMap::new();
    for one in moves.iter().filter(|one| one.is_rapid) {
        let top = tops.entry(key(&one.axis)).or_insert(f64::NEG_INFINITY);
        *top = top.max(one.position.dot(&one.axis));
    }
    // Where the first move of an operation that moves leads down, and the next one too, the level where it ends.
    let mut operation = None;
    let mut is_begun = false;
    let mut top_of = (Vector3::zeros(), f64::INFINITY);
    (0..moves.len())
        .map(|at| {
            let here = &moves[at];
            if here.is_rapid {
                (operation, is_begun) = (None, false);
            } else if program.has_rapids_at_feed && !is_begun && at > 0 {
                let goes_down = |at: usize| {
                    let (before, here) = (&moves[at - 1], moves.get(at)?);
                    direction(before, here).map(|way| !here.is_rapid && way.dot(&here.axis) < -STRAIGHT_DOWN)
                };
                if let Some(is_down) = goes_down(at) {
                    is_begun = true;
                    let is_stop = is_down && goes_down(at + 1) == Some(true);
                    operation = is_stop.then(|| here.position.dot(&here.axis));
                }
            }
            if top_of.0 != here.axis {
                top_of = (here.axis, tops.get(&key(&here.axis)).copied().unwrap_or(f64::INFINITY));
            }
            top_of.1.min(operation.unwrap_or(f64::INFINITY))
        })
        .collect()
}

/// The direction of a move, nothing where it ends where it starts.
fn direction(before: &Move, here: &Move) -> Option<Vector3<f64>> {
    (here.position - before.position).try_normalize(SAME)
}
