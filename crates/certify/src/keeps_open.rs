//! Why boxes stay open: what is known of the states that their bounds still count.

use super::active_cells::ActiveCells;
use super::compliance_table::{AffineModel, Node, enclosed};
use super::interval_simd::WIDTH;
use super::model::Model;
use super::region::Region;
use serde::Serialize;
use std::fmt;
use stead_model::robot::PostureClass;

/// What is known of the states that the bounds of the boxes of least bound still count: of path points, cells of
/// heading and posture classes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct KeepsOpen {
    /// States looked at.
    pub states: usize,
    /// Of these, those of which nothing is known: too near to a singularity.
    pub unknown: usize,
    /// Those that count as allowed because a constraint is not decided over all of them.
    pub undecided: usize,
    /// How many of these each constraint leaves undecided: the elbow's, the wrist's and the general share of
    /// conditioning, and the limits of joints 2, 3 and 5.
    pub by: [usize; 6],
    /// What the points come to in these boxes in terms of the value, in the mean, where that is known: as the bounds
    /// have it; without what the models of the tables leave out; and without the width of the cells of heading too.
    /// What is missing to 1 then is of the limits that are relaxed, or of states that are not decided.
    pub sums: Option<[f64; 3]>,
    /// Seconds of all threads: in coarse tables with their finer levels, and in cells of heading. Only where the time
    /// limit ended the search: they differ from run to run.
    pub seconds: Option<[f64; 2]>,
}

/// Path points of which states are counted, of so many.
pub(super) fn some_points(points: usize) -> impl Iterator<Item = usize> {
    (0..points).step_by(points.div_ceil(POINTS).max(1))
}

/// Names of the constraints, in the order of [`KeepsOpen::by`].
const NAMES: [&str; 6] =
    ["elbow near its singularity", "wrist near its singularity", "conditioning", "joint 2", "joint 3", "joint 5"];
/// Boxes, and path points of each, that are counted.
const BOXES: usize = 8;
const POINTS: usize = 8;

impl KeepsOpen {
    /// Of open boxes with what is known of each, by what `count` adds of each; `None` where no state counts.
    pub(super) fn of<T>(open: &[(Region, f64)], known: &[T], count: impl Fn(&mut Self, &Region, &T)) -> Option<Self> {
        let mut all: Vec<_> = open.iter().zip(known).collect();
        all.sort_by(|((_, a), _), ((_, b), _)| a.total_cmp(b));
        let mut counted = Self::default();
        for ((region, _), known) in all.into_iter().take(BOXES) {
            count(&mut counted, region, known);
        }
        let boxes = open.len().min(BOXES) as f64;
        let mean = counted.sums.map(|sums| sums.map(|sum| sum / boxes));
        counted.sums = mean.filter(|sums| sums.iter().all(|sum| sum.is_finite()));
        Some(counted).filter(|counted| counted.states > 0)
    }

    /// Counts the states of a path point in a box, with the cells of heading that are still of interest.
    pub(super) fn add_point(&mut self, model: &Model, region: &Region, active: &ActiveCells, point: usize) {
        let Model { table, arm, .. } = model;
        let level = active.level;
        let Some(placed) = model.placed(point, region) else { return };
        let Some((nodes, _)) = table.answer(arm, level, &placed) else { return };
        for class in PostureClass::ALL {
            for cell in active.cells(point, class.index()).map(usize::from) {
                match nodes.known(cell, class).0 {
                    Node::Empty => {}
                    Node::Unknown => self.add(None),
                    Node::Known(AffineModel { sure: true, .. }) => self.states += 1,
                    Node::Known(_) => {
                        let y = enclosed(arm, &[nodes.place(cell); WIDTH], table.half(level), class);
                        self.add(Some(y.map_or([true; 6], |y| arm.sure_to_hold(&y.margins, 0))));
                    }
                }
            }
        }
    }

    /// Counts a state that may be allowed or not, where it is known which constraints hold, or one of which nothing is
    /// known.
    pub(super) fn add(&mut self, holds: Option<[bool; 6]>) {
        self.states += 1;
        let Some(holds) = holds else {
            self.unknown += 1;
            return;
        };
        self.undecided += 1;
        self.by.iter_mut().zip(holds).for_each(|(count, holds)| *count += usize::from(!holds));
    }

    /// Adds what the points come to in a box; where that is not known of one it is of none.
    pub(super) fn add_sums(&mut self, of_box: Option<[f64; 3]>) {
        let more = of_box.unwrap_or([f64::NAN; 3]);
        let sums = self.sums.get_or_insert([0.0; 3]);
        sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
    }

    /// A share of the states in per cent.
    fn percent(&self, count: usize) -> usize {
        (100 * count + self.states / 2) / self.states.max(1)
    }
}

impl fmt::Display for KeepsOpen {
    /// `of the states that still count 3 % are unknown and 61 % undecided (conditioning 60 %, joint 3 2 %); in these
    /// boxes the points come to 0.852 of the value, ..; 58 s of all threads went into coarse tables, ..`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [unknown, undecided] = [self.unknown, self.undecided].map(|count| self.percent(count));
        write!(f, "of the states that still count {unknown} % are unknown and {undecided} % undecided")?;
        let mut by: Vec<(usize, &str)> = self.by.iter().map(|count| self.percent(*count)).zip(NAMES).collect();
        by.retain(|(share, _)| *share > 0);
        by.sort_by_key(|(share, _)| std::cmp::Reverse(*share));
        let named: Vec<String> = by.iter().map(|(share, name)| format!("{name} {share} %")).collect();
        if !named.is_empty() {
            write!(f, " ({})", named.join(", "))?;
        }
        if let Some([bound, models, headings]) = self.sums {
            write!(
                f,
                "; in these boxes the points come to {bound:.3} of the value, without remainders of the tables to \
                 {models:.3}, without the width of cells of heading too to {headings:.3}"
            )?;
        }
        let Some([coarse, cells]) = self.seconds else { return Ok(()) };
        write!(f, "; {coarse:.0} s of all threads went into coarse tables, {cells:.0} s into cells of heading")
    }
}
