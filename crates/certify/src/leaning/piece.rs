//! Pieces of cells: boxes of the place of the tool centre point and of the turn of the spindle, how they are cut and
//! when they are good enough.

use super::super::interval_simd::WIDTH;
use super::super::number::LEANING;
use super::states::TURN;
use std::f64::consts::PI;

/// Half width of the largest cells (m), and ranges of the turn there. Those of a level are half as wide as those of the
/// level before.
pub(super) const LARGEST: f64 = 0.05;
pub(super) const TURNS: usize = 64;
/// Levels that a piece may be finer than its cell, and levels of pieces.
const FINER: u8 = 2;
const FINEST: u8 = 9;
/// Share of a score that a piece of the largest cells may leave out; half of that at each further level.
const SHARE: f32 = 0.2;

/// A box of x, y, z and turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// The levels whose widths it has, and its numbers there.
    pub level: [u8; LEANING],
    pub number: [u16; LEANING],
    /// The variables in the order in which it is to be cut.
    pub order: [u8; LEANING],
    /// What share of a score its bound leaves out.
    pub share: f32,
    /// Whether all its states are sure to be allowed.
    pub sure: bool,
}

/// Half the width of the cells of a level. m
pub(super) fn half_of(level: usize) -> f64 {
    LARGEST / (1u64 << level) as f64
}

impl Piece {
    /// Half the width along one of the variables. m, rad
    pub fn half(&self, k: usize) -> f64 {
        if k == TURN { PI / (TURNS << self.level[k]) as f64 } else { half_of(usize::from(self.level[k])) }
    }

    /// Whether it is good enough for cells of a level.
    pub fn is_fine(&self, level: usize) -> bool {
        let level = level as u8;
        let is_small = self.level.iter().all(|own| *own >= level);
        let is_smallest = self.level.iter().all(|own| *own >= (level + FINER).min(FINEST));
        is_smallest || (self.share <= SHARE / f32::from(1u16 << level) && (self.sure || is_small))
    }

    /// The part of it in a cell.
    pub fn within(mut self, level: usize, at: [usize; 3]) -> Self {
        for k in 0..3 {
            if usize::from(self.level[k]) < level {
                (self.level[k], self.number[k]) = (level as u8, at[k] as u16);
            }
        }
        self
    }

    /// Whether it has anything in common with a cell.
    pub fn meets(&self, level: usize, at: [usize; 3]) -> bool {
        (0..3).all(|k| {
            let (own, number) = (usize::from(self.level[k]), usize::from(self.number[k]));
            if own <= level { at[k] >> (level - own) == number } else { number >> (own - level) == at[k] }
        })
    }

    /// The four parts of it, cut along the first two variables that are not as short as cells of this level allow.
    pub fn cut(&self, level: usize) -> [Self; WIDTH] {
        let shortest = (level as u8 + FINER).min(FINEST);
        let mut order = self.order;
        // What is not sure to be allowed is cut where it is longest.
        if !self.sure && self.share <= SHARE / f32::from(1u16 << level) {
            order.sort_by_key(|k| self.level[usize::from(*k)]);
        }
        let mut parts = [*self; WIDTH];
        let sides = order.into_iter().map(usize::from).filter(|k| self.level[*k] < shortest).take(2);
        for (place, side) in sides.enumerate() {
            for (number, part) in parts.iter_mut().enumerate() {
                part.level[side] += 1;
                part.number[side] = 2 * part.number[side] + (number >> place & 1) as u16;
            }
        }
        parts
    }
}
