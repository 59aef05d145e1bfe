//! Lines through the stock: a sheared lattice, so that no wall or floor is parallel to its rows, in square tiles.

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
pub fn tiles([low, high]: [f64; 2], cell: f64) -> std::ops::RangeInclusive<i64> {
    ((low / cell).floor() as i64 - 1).div_euclid(TILE)..=((high / cell).ceil() as i64).div_euclid(TILE)
}

/// The line nearest to a place, in lengths of a cell.
pub fn nearest(x: f64, y: f64) -> (i64, i64) {
    let (i, j) = (x.round() as i64, y.round() as i64);
    let mut best = (f64::INFINITY, (i, j));
    for i in i - 2..=i + 1 {
        for j in j - 2..=j + 1 {
            let [at_x, at_y] = place(i, j);
            let apart = libm::hypot(at_x - x, at_y - y);
            if apart < best.0 {
                best = (apart, (i, j));
            }
        }
    }
    best.1
}
