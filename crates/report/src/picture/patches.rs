//! Coloured cells of a grid as few polygons: neighbours of one colour are drawn as one.

/// Cells of one level in neighbouring rows, one run of them in each.
#[derive(Debug, PartialEq)]
pub(super) struct Patch {
    /// Their level.
    pub level: usize,
    /// The first row.
    row: usize,
    /// In each row the first column and the one behind the last.
    runs: Vec<[usize; 2]>,
}

impl Patch {
    /// The corners of the outline, counted in cells along the first axis and along the second.
    pub fn outline(&self) -> Vec<[usize; 2]> {
        let side = |k: usize| {
            self.runs.iter().enumerate().flat_map(move |(up, run)| [0, 1].map(|end| [run[k], self.row + up + end]))
        };
        let mut corners: Vec<[usize; 2]> = side(0).chain(side(1).rev()).collect();
        corners.dedup();
        // Along a straight side only its ends are corners.
        let straight =
            |before: &[usize; 2], at: &[usize; 2], after: &[usize; 2]| before[0] == at[0] && at[0] == after[0];
        let mut outline: Vec<[usize; 2]> = Vec::with_capacity(corners.len());
        for (index, corner) in corners.iter().enumerate() {
            let after = corners.get(index + 1);
            if !outline.last().zip(after).is_some_and(|(before, after)| straight(before, corner, after)) {
                outline.push(*corner);
            }
        }
        outline
    }
}

/// The patches of a grid with `columns` cells to a row; cells without a level belong to none. Every other cell is in exactly
/// one patch.
pub(super) fn patches(columns: usize, levels: &[Option<usize>]) -> Vec<Patch> {
    let mut patches: Vec<Patch> = Vec::new();
    // Patches with a run in the row before, in the order of their columns.
    let mut open: Vec<usize> = Vec::new();
    for (row, levels) in levels.chunks_exact(columns.max(1)).enumerate() {
        let mut column = 0;
        let mut grown = Vec::new();
        for run in levels.chunk_by(|a, b| a == b) {
            let columns = [column, column + run.len()];
            column = columns[1];
            let Some(level) = run[0] else { continue };
            let touches = |patch: &Patch| {
                let last = patch.runs.last();
                patch.level == level && last.is_some_and(|last| last[0] < columns[1] && columns[0] < last[1])
            };
            if let Some(place) = open.iter().position(|patch| touches(&patches[*patch])) {
                let patch = open.remove(place);
                patches[patch].runs.push(columns);
                grown.push(patch);
            } else {
                grown.push(patches.len());
                patches.push(Patch { level, row, runs: vec![columns] });
            }
        }
        open = grown;
    }
    patches
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_staircase_is_one_polygon() {
        #[rustfmt::skip]
        let levels = [Some(1), Some(1), Some(2), None,
                      Some(1), Some(1), Some(2), Some(2),
                      Some(1), Some(2), Some(2), Some(2)];
        let patches = patches(4, &levels);
        assert_eq!(patches.len(), 2);
        assert_eq!(patches[0].outline(), [[0, 0], [0, 3], [1, 3], [1, 2], [2, 2], [2, 0]]);
        assert_eq!(patches[1].outline(), [[2, 0], [2, 2], [1, 2], [1, 3], [4, 3], [4, 1], [3, 1], [3, 0]]);
    }

    /// Whether the middle of a cell is inside a polygon, by the crossings of a ray.
    fn inside(outline: &[[usize; 2]], column: usize, row: usize) -> bool {
        let ends = outline.iter().zip(outline.iter().cycle().skip(1));
        let crossed =
            ends.filter(|(a, b)| a[0] == b[0] && a[0] > column && a[1].min(b[1]) <= row && row < a[1].max(b[1]));
        crossed.count() % 2 == 1
    }

    proptest! {
        #[test]
        fn every_cell_is_in_the_polygon_of_its_level(
            columns in 1..8_usize,
            levels in prop::collection::vec(prop_oneof![1 => Just(None), 4 => (0..3_usize).prop_map(Some)], 0..64),
        ) {
            let patches = patches(columns, &levels);
            let outlines: Vec<_> = patches.iter().map(|patch| (patch.level, patch.outline())).collect();
            for (_, outline) in &outlines {
                // Sides follow the grid.
                let mut ends = outline.iter().zip(outline.iter().cycle().skip(1));
                prop_assert!(ends.all(|(a, b)| (a[0] == b[0]) != (a[1] == b[1])), "{:?}", outline);
            }
            for (index, level) in levels[..levels.len() / columns * columns].iter().enumerate() {
                let holding = outlines.iter().filter(|(_, outline)| inside(outline, index % columns, index / columns));
                let holding: Vec<usize> = holding.map(|(level, _)| *level).collect();
                prop_assert_eq!(holding, Vec::from_iter(*level));
            }
        }
    }
}
