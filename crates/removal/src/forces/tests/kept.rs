//! What is kept of a cut is read to the last bit, and nothing else is.

use super::*;
use crate::kept::{CutResult, load_of_row, load_rows};
use proptest::prelude::*;

/// A wall that begins within the path, so that points are added, and cut above the flutes.
fn problem() -> ForcesProblem {
    let mut problem = shoulder([4.0, 30.0], &along_x(5.0));
    problem.operation.mill.flute_length = 4e-3;
    let path = line(&[([-20.0, 0.0, -5.0], UP), ([70.0, 0.0, -5.0], UP)], 30.0);
    problem.operation.path = operation(&path, &problem.operation.mill, &Pose::identity()).path;
    problem
}

#[test]
fn what_is_kept_of_a_cut_is_read_to_the_last_bit() {
    let problem = problem();
    let made = cut(&problem, &Monitor::silent()).unwrap();
    assert!(!made.added.is_empty() && !made.events.is_empty() && !made.stock[1].triangles.is_empty());
    let rows = made.rows();
    let read = CutResult::of_rows(&rows, made.loads.len()).unwrap();
    assert_eq!((&read, read.rows()), (&made, rows));
    let forces = read.forces(&problem).unwrap();
    assert_eq!(forces, found(&problem));
    let loads = load_rows(&made.loads);
    let again: Vec<_> = loads.lines().map(|line| load_of_row(line).unwrap()).collect();
    assert_eq!(again, made.loads);
}

proptest! {
    /// Rows that are torn or changed are refused, or read as what can be kept again; nothing panics.
    #[test]
    fn other_rows_are_refused_or_those_of_a_cut(at in 0.0..1.0_f64, put in "[a-z0-9,.\n-]{0,6}", cut in 0..40_usize) {
        let rows = "cut,0.001,0,0,0,0,1e-9\nload,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,,\n\
                    load,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,,,0.5,1\n\
                    added,1,0.5,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,,\nevent,gouge,1,1e-9\n\
                    vertex,0,1,2,3\nvertex,0,1,2,4\nvertex,0,1,5,3\ntriangle,0,0,1,2\n";
        prop_assert!(CutResult::of_rows(rows, 2).is_some() && CutResult::of_rows(rows, 3).is_none());
        let from = (at * rows.len() as f64) as usize;
        let changed = format!("{}{put}{}", &rows[..from], &rows[(from + cut).min(rows.len())..]);
        if let Some(read) = CutResult::of_rows(&changed, 2) {
            prop_assert_eq!(CutResult::of_rows(&read.rows(), 2), Some(read));
        }
    }
}
