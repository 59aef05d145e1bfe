//! Lines through the stock: a sheared lattice, so that no wall or floor is parallel to its rows, in square tiles.

use nalgebra::Vector3;
use std::collections::BTreeMap;

/// The golden section, whose multiples fall most evenly between whole numbers.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// Lines of a tile along either side.
pub const TILE: i64 = 32;

/// A tile of lines along one axis, by the axis and the numbers of its first lines over [`TILE`].
pub type TileKey = (usize, i64, i64);

/// What a row is shifted by. Cells
fn shift(number: i64) -> f64 {
    let shifted = number as f64 * GOLDEN;
    shifted - shifted.floor()
}

/// Where line (i, j) stands, in lengths of a cell.
pub fn place(i: i64, j: i64) -> [f64; 2] {
    [i as f64 + shift(j), j as f64 + shift(i)]
}

/// The axes across lines along an axis, in the order of the lattice.
pub fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// The tiles that a stretch of an axis (m) meets; a line is shifted by less than a cell.
pub fn tiles(span: [f64; 2], cell: f64) -> std::ops::RangeInclusive<i64> {
    ((span[0] / cell).floor() as i64 - 1).div_euclid(TILE)..=((span[1] / cell).ceil() as i64).div_euclid(TILE)
}

/// The tiles of lines along every axis that a box (m) meets, in the order of their keys.
pub fn tiles_within(reach: &[[f64; 2]; 3], cell: f64) -> impl Iterator<Item = TileKey> + use<> {
    let sides = reach.map(|span| tiles(span, cell));
    (0..3).flat_map(move |axis| {
        let [rows, columns] = others(axis).map(|side| sides[side].clone());
        rows.flat_map(move |i| columns.clone().map(move |j| (axis, i, j)))
    })
}

/// The numbers of boxes (m) by the tiles that they meet.
pub fn by_tile(boxes: impl Iterator<Item = (u32, [[f64; 2]; 3])>, cell: f64) -> BTreeMap<TileKey, Vec<u32>> {
    let mut numbers: BTreeMap<TileKey, Vec<u32>> = BTreeMap::new();
    for (number, reach) in boxes {
        tiles_within(&reach, cell).for_each(|key| numbers.entry(key).or_default().push(number));
    }
    numbers
}

/// The rows of a tile, by its number, that a stretch of an axis (m) may meet; a line is shifted by less than a cell.
pub fn lines_of(tile: i64, span: [f64; 2], cell: f64) -> std::ops::Range<i64> {
    let first = (span[0] / cell).floor() as i64 - 1 - tile * TILE;
    let last = (span[1] / cell).ceil() as i64 - tile * TILE;
    first.max(0)..last.min(TILE - 1) + 1
}

/// The lines of a tile, with where they stand.
pub struct TileLines {
    key: TileKey,
    cell: f64,
    /// Where lines begin along their axis. m
    low: f64,
    columns: [f64; TILE as usize],
    rows: [f64; TILE as usize],
}

impl TileLines {
    /// The lines of a tile at a distance from each other (m), which begin at a place along their axis (m).
    pub fn new(key: TileKey, cell: f64, low: f64) -> Self {
        let (_, i, j) = key;
        let columns = std::array::from_fn(|column| place(0, j * TILE + column as i64)[0]);
        let rows = std::array::from_fn(|row| place(i * TILE + row as i64, 0)[1]);
        Self { key, cell, low, columns, rows }
    }

    /// Goes through those within a box (m), with their number and where they begin.
    pub fn within(&self, reach: &[[f64; 2]; 3], each: &mut dyn FnMut(usize, &Vector3<f64>)) {
        let (axis, i, j) = self.key;
        let [a, b] = others(axis);
        for row in lines_of(i, reach[a], self.cell) {
            for column in lines_of(j, reach[b], self.cell) {
                let x = ((i * TILE + row) as f64 + self.columns[column as usize]) * self.cell;
                let y = ((j * TILE + column) as f64 + self.rows[row as usize]) * self.cell;
                if x < reach[a][0] || x > reach[a][1] || y < reach[b][0] || y > reach[b][1] {
                    continue;
                }
                let mut o = Vector3::zeros();
                (o[a], o[b], o[axis]) = (x, y, self.low);
                each((row * TILE + column) as usize, &o);
            }
        }
    }
}

/// The line nearest to a place, in lengths of a cell.
pub fn nearest(x: f64, y: f64) -> (i64, i64) {
    let (i, j) = (x.round() as i64, y.round() as i64);
    let apart = |(i, j): &(i64, i64)| {
        let [at_x, at_y] = place(*i, *j);
        libm::hypot(at_x - x, at_y - y)
    };
    let near = (i - 2..=i + 1).flat_map(|i| (j - 2..=j + 1).map(move |j| (i, j)));
    near.min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or((i, j))
}
