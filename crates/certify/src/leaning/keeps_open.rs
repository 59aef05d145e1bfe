//! Why boxes stay open, of tools that lean.

use super::super::interval_simd::WIDTH;
use super::super::keeps_open::{KeepsOpen, counted_points};
use super::super::number::LEANING;
use super::super::over_regions::sure_to_hold;
use super::cells::Cells;
use super::states::{Known, States, enclosed, judged};
use super::{Box3, Classes, Leaning, level_of};
use stead_model::robot::PostureClass;

impl Leaning {
    /// What is known of the states that the bounds of boxes still count, in the classes that are of interest in each.
    pub fn keeps_open(&self, boxes: &[(Box3, &Classes)]) -> KeepsOpen {
        let mut counted = KeepsOpen::default();
        for (region, classes) in boxes {
            for number in counted_points(self.points.len()) {
                let point = &self.points[number];
                let segment = self.segments.iter().position(|span| span.contains(&number)).unwrap_or(0);
                let active = classes.as_ref().map_or(15, |classes| classes[segment]);
                let (cells, level) = (&self.axes[point.axis], level_of(region));
                // One cell for all that the box is in: that of its middle.
                let at = std::array::from_fn(|k| {
                    let middle = region.middle[k] + point.at[k];
                    cells.between(level, k, middle, middle).0
                });
                for class in PostureClass::ALL.into_iter().filter(|class| active >> class.index() & 1 == 1) {
                    for (place, half) in cells.pieces(level, at, class) {
                        add(&mut counted, cells, place, half, class);
                    }
                }
            }
        }
        counted
    }
}

/// Counts what is known of the states of a piece of a cell.
fn add(counted: &mut KeepsOpen, cells: &Cells, place: [f64; LEANING], half: [f64; LEANING], class: PostureClass) {
    let Some(y) = enclosed(&cells.arm, &[place; WIDTH], half, class) else { return };
    match judged(&cells.arm, &y, 0, half) {
        Known::Empty => {}
        Known::Unknown => counted.add_unknown(),
        Known::Yields(States { sure: true, .. }) => counted.states += 1,
        Known::Yields(_) => counted.add_undecided(sure_to_hold(&cells.arm, &y.margins, 0)),
    }
}
