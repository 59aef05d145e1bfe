//! The table of moves.

use super::geometry::{Frame, apart, turned_by_quaternion, turned_xyz};
use super::written::{Goal, Moves, Pace, Source, frame_of};
use stead_disk::input::InputError;
use stead_disk::input::csv_table::{CsvTable, Row, try_each};

/// How far apart the two ways may be in which the table states an orientation. deg
const BOTH_WAYS_DEG: f64 = 1e-3;

/// The moves of a table.
///
/// # Errors
/// [`InputError`] with line and column for a table that is not one of moves.
pub(super) fn moves(source: &Source) -> Result<Moves, InputError> {
    let mut moves = Moves::default();
    let mut table = CsvTable::new(&source.file, source.text.as_bytes())?;
    let column = |name: &str| {
        table.column(name).ok_or_else(|| table.fail(name, "missing column", "the columns that `stead export` writes"))
    };
    let kind = column("move")?;
    let position = try_each(["x_mm", "y_mm", "z_mm"], column)?;
    let [a, b, c] = try_each(["a_deg", "b_deg", "c_deg"], column)?;
    let quaternion = try_each(["q_w", "q_x", "q_y", "q_z"], column)?;
    let axes = try_each(["a1_deg", "a2_deg", "a3_deg", "a4_deg", "a5_deg", "a6_deg"], column)?;
    let feed = column("feed_mm_per_s")?;
    let external: [Option<usize>; 6] = std::array::from_fn(|axis| {
        ["mm", "deg"].into_iter().find_map(|unit| table.column(&format!("e{}_{unit}", axis + 1)))
    });
    while let Some(row) = table.next_row()? {
        let origin = try_each(position, |column| row.number(column))?;
        let by_angles = frame_of(origin, turned_xyz(row.number(c)?, row.number(b)?, row.number(a)?));
        let tool = by_quaternion(&row, quaternion, origin)?;
        if apart(&by_angles, &tool).1 > BOTH_WAYS_DEG {
            return Err(row.fail(
                quaternion[0],
                "the quaternion is another orientation than A, B, C",
                "one orientation",
            ));
        }
        let is_empty = axes.iter().all(|column| row.text(*column).is_empty());
        let angles = if is_empty { None } else { Some(try_each(axes, |column| row.number(column))?) };
        let is_joint = match row.text(kind) {
            "joint" => true,
            "linear" => false,
            _ => return Err(row.fail(kind, "no such move", "joint, linear")),
        };
        let external = try_each(external, |column| column.map(|column| row.number(column)).transpose())?;
        let feed = if is_joint { None } else { Some(row.number(feed)?) };
        moves.push(source, row.line(), (Goal::Row { tool, angles, is_joint }, external, Pace { feed, end: None }))?;
    }
    Ok(moves)
}

fn by_quaternion(row: &Row<'_>, columns: [usize; 4], origin: [f64; 3]) -> Result<Frame, InputError> {
    let parts = try_each(columns, |column| row.number(column))?;
    let turn = turned_by_quaternion(parts);
    turn.map(|turn| frame_of(origin, turn))
        .ok_or_else(|| row.fail(columns[0], "is no quaternion of length 1", "length 1"))
}
