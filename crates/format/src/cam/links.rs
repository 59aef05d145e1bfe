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
/// Places that differ by less are the same. m
const SAME: f64 = 1e-9;
/// Axes that differ by less are the same.
const SAME_AXIS: f64 = 1e-5;

/// Makes links rapid moves, and notes how long they are.
pub(super) fn take_out(program: &mut Program) {
    let levels = levels(program);
    let moves = &mut program.moves;
    let (mut length, mut line, mut start) = (0.0, 0, 1);
    while start < moves.len() {
        let axis = moves[start].axis;
        let is_level = |at: usize| {
            !moves[at].is_rapid
                && moves[at - 1..=at].iter().all(|one| (one.axis - axis).norm() < SAME_AXIS)
                && along(moves, at).is_some_and(|part| part.abs() < LEVEL)
                && moves[at].position.dot(&axis) > levels[at] - SAME
        };
        let end = (start..moves.len()).find(|at| !is_level(*at)).unwrap_or(moves.len());
        let is_run = start > 1 && end > start && end < moves.len() && !moves[start - 1].is_rapid;
        let leads = |at: usize, sense: f64| along(moves, at).is_some_and(|part| sense * part > ALONG);
        if is_run && leads(start - 1, 1.0) && leads(end, -1.0) {
            line = if line == 0 { moves[start].line } else { line };
            for at in start..end {
                length += (moves[at].position - moves[at - 1].position).norm();
                moves[at].is_rapid = true;
            }
        }
        start = end.max(start + 1);
    }
    if length > 0.0 {
        let length = (length * 1e3).round();
        program
            .note(format!("links at feed, taken as rapid moves: {length} mm (--keep-links takes them as cuts)"), line);
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
    // Where the first move of an operation leads down, and the next one too, the level where it ends.
    let (mut operation, mut is_begun) = (f64::INFINITY, false);
    let mut last = (Vector3::zeros(), f64::INFINITY);
    let level = |at: usize| {
        let here = &moves[at];
        let is_down = |at: usize| along(moves, at).map(|part| part < -STRAIGHT_DOWN && !moves[at].is_rapid);
        if here.is_rapid {
            (operation, is_begun) = (f64::INFINITY, false);
        } else if let (true, false, Some(goes_down)) = (program.has_rapids_at_feed, is_begun, is_down(at)) {
            is_begun = true;
            if goes_down && is_down(at + 1) == Some(true) {
                operation = here.position.dot(&here.axis);
            }
        }
        if last.0 != here.axis {
            last = (here.axis, tops.get(&key(&here.axis)).copied().unwrap_or(f64::INFINITY));
        }
        last.1.min(operation)
    };
    (0..moves.len()).map(level).collect()
}

/// How much of the direction of a move is along its tool axis; nothing where it ends where it starts.
fn along(moves: &[Move], at: usize) -> Option<f64> {
    let (before, here) = (moves.get(at.checked_sub(1)?)?, moves.get(at)?);
    (here.position - before.position).try_normalize(SAME).map(|way| way.dot(&here.axis))
}
