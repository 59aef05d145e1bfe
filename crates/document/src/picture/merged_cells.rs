//! Cells of a grid as few polygons: neighbours of one content are one polygon.

/// Cells of one content in neighbouring rows, one run of them in each.
#[derive(Debug, PartialEq)]
pub struct MergedCells<T> {
    /// What is in them.
    pub content: T,
    /// The first row.
    row: usize,
    /// In each row the first column and the one behind the last.
    runs: Vec<[usize; 2]>,
}

impl<T> MergedCells<T> {
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

/// The polygons of a grid with `columns` cells to a row; cells without a content belong to none. Every other cell is in
/// exactly one polygon.
pub fn merged_cells<T: Copy + PartialEq>(columns: usize, cells: &[Option<T>]) -> Vec<MergedCells<T>> {
    let mut polygons: Vec<MergedCells<T>> = Vec::new();
    // Those with a run in the row before, in the order of their columns.
    let mut open: Vec<usize> = Vec::new();
    for (row, cells) in cells.chunks_exact(columns.max(1)).enumerate() {
        let mut column = 0;
        let mut grown = Vec::new();
        for run in cells.chunk_by(|a, b| a == b) {
            let columns = [column, column + run.len()];
            column = columns[1];
            let Some(content) = run[0] else { continue };
            let touches = |polygon: &MergedCells<T>| {
                let last = polygon.runs.last();
                polygon.content == content && last.is_some_and(|last| last[0] < columns[1] && columns[0] < last[1])
            };
            if let Some(place) = open.iter().position(|polygon| touches(&polygons[*polygon])) {
                let polygon = open.remove(place);
                polygons[polygon].runs.push(columns);
                grown.push(polygon);
            } else {
                grown.push(polygons.len());
                polygons.push(MergedCells { content, row, runs: vec![columns] });
            }
        }
        open = grown;
    }
    polygons
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
        let polygons = merged_cells(4, &levels);
        assert_eq!(polygons.len(), 2);
        assert_eq!(polygons[0].outline(), [[0, 0], [0, 3], [1, 3], [1, 2], [2, 2], [2, 0]]);
        assert_eq!(polygons[1].outline(), [[2, 0], [2, 2], [1, 2], [1, 3], [4, 3], [4, 1], [3, 1], [3, 0]]);
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
            let polygons = merged_cells(columns, &levels);
            let outlines: Vec<_> = polygons.iter().map(|polygon| (polygon.content, polygon.outline())).collect();
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
