//! Tool paths from CSV (one row per point; the columns are listed in [`read_csv`]).

mod lean;

pub use lean::{LEAN, PointLean};

use crate::file_kind::FileKind;
use crate::shapes::SEMIDEFINITE;
use lean::LeanColumns;
use nalgebra::{Matrix3, Vector3};
use std::path::Path;
use stead_disk::files;
use stead_disk::input::InputError;
use stead_disk::input::csv_table::{CsvTable, Row, try_each};
use stead_disk::manifest::{self, Unlisted};
use stead_disk::quote::shorten;
use stead_model::stiffness::matrix::checked;
use stead_model::task::{PathPoint, TaskError, ToolPath, UNIT_TOLERANCE, Wrench};

/// What a task file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The geometry.
    pub path: ToolPath,
    /// The wrenches, where the file has force columns.
    pub wrenches: Option<Vec<Wrench>>,
    /// How the part yields at every point, where the file has columns for it. m/N
    pub part: Option<Vec<Matrix3<f64>>>,
    /// How far the tool may lean at every point, where the file has columns for it.
    pub leans: Option<Vec<PointLean>>,
    /// Line of each point in the file, from 1.
    pub lines: Vec<usize>,
}

const REQUIRED: [&str; 10] =
    ["segment", "x_mm", "y_mm", "z_mm", "feed_x", "feed_y", "feed_z", "axis_x", "axis_y", "axis_z"];
const FORCE: [&str; 3] = ["force_x_n", "force_y_n", "force_z_n"];
const NORMAL: [&str; 3] = ["normal_x", "normal_y", "normal_z"];
/// Feed of the move to the point, and whether it is scored.
const FOLLOWING: [&str; 2] = ["feed_mm_per_s", "scored"];
const MOMENT: [&str; 3] = ["moment_x_nm", "moment_y_nm", "moment_z_nm"];
/// How the part yields: the entries of a symmetric matrix.
pub const PART: [&str; 6] = [
    "part_xx_um_per_n",
    "part_yy_um_per_n",
    "part_zz_um_per_n",
    "part_xy_um_per_n",
    "part_xz_um_per_n",
    "part_yz_um_per_n",
];

/// Reads a tool path: columns `segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z`, optionally
/// `force_x_n,force_y_n,force_z_n` (what the workpiece does to the tool) and with them
/// `moment_x_nm,moment_y_nm,moment_z_nm`, `normal_x,normal_y,normal_z`, the normal of the surface that is cut,
/// `feed_mm_per_s`, the feed of the move to the point, `scored`, 0 for a point that only has to be reached and else 1,
/// `part_xx_um_per_n` .. `part_yz_um_per_n`, how the part yields at the point, and `lead_min_deg,lead_max_deg` and
/// `tilt_min_deg,tilt_max_deg`, how far the tool may lean there; in any order, all in the workpiece frame.
///
/// # Errors
/// [`InputError`] naming line and column: a file that cannot be read, a missing, doubled or unknown column, a value
/// that is no finite number, or a point that breaks a rule of [`ToolPath::new`].
pub fn read_csv(file: &Path) -> Result<Imported, InputError> {
    let bytes =
        files::read(file).map_err(|e| InputError::new(file, format!("cannot be read: {e}")).in_field("task"))?;
    manifest::check(file, &bytes, Unlisted::Accepted)?;
    parse_csv(file, &bytes)
}

/// As [`read_csv`], from the bytes of a file already read; `file` is its name in messages.
///
/// # Errors
/// As [`read_csv`].
pub fn parse_csv(file: &Path, bytes: &[u8]) -> Result<Imported, InputError> {
    let other_kind = |error: InputError| FileKind::foreign(bytes).map_or(error, |kind| kind.refused(file));
    let mut table = CsvTable::new(file, bytes).map_err(other_kind)?;
    let columns = Columns::find(&table).map_err(other_kind)?;
    let (mut points, mut lines, mut feeds, mut normals) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut wrenches, mut part, mut leans) = (Vec::new(), Vec::new(), Vec::new());
    while let Some(row) = table.next_row()? {
        let segment = segment(&row, columns.required[0])?;
        let at = |k: usize| row.vector([0, 1, 2].map(|axis| columns.required[k + axis]));
        let is_scored = columns.scored.map_or(Ok(true), |scored| flag(&row, scored))?;
        if let Some(feed) = columns.feed {
            feeds.push(positive(&row, feed)? * 1e-3);
        }
        points.push((segment, PathPoint { position: at(1)? * 1e-3, feed: at(4)?, axis: at(7)? }, is_scored));
        if let Some(force) = columns.force {
            let moment = columns.moment.map_or(Ok(Vector3::zeros()), |moment| row.vector(moment))?;
            wrenches.push(Wrench { force: row.vector(force)?, moment });
        }
        if let Some(normal) = columns.normal {
            normals.push(row.vector(normal)?);
        }
        if let Some(entries) = columns.part {
            part.push(part_compliance(&row, entries)?);
        }
        if columns.lean.is_there() {
            leans.push(columns.lean.of(&row)?);
        }
        lines.push(row.line());
    }
    let with_normals = |path: ToolPath| match columns.normal {
        Some(_) => path.with_surface_normals(normals),
        None => Ok(path),
    };
    let with_feeds = |path: ToolPath| match columns.feed {
        Some(_) => path.with_feeds(feeds),
        None => Ok(path),
    };
    let path = ToolPath::partly_scored(points).and_then(with_normals).and_then(with_feeds);
    let path = path.map_err(|e| locate(file, &lines, &e))?;
    let (wrenches, part) = (columns.force.map(|_| wrenches), columns.part.map(|_| part));
    Ok(Imported { path, wrenches, part, leans: columns.lean.is_there().then_some(leans), lines })
}

/// Where each column of the contract stands in this file.
struct Columns {
    required: [usize; 10],
    force: Option<[usize; 3]>,
    moment: Option<[usize; 3]>,
    normal: Option<[usize; 3]>,
    feed: Option<usize>,
    scored: Option<usize>,
    part: Option<[usize; 6]>,
    lean: LeanColumns,
}

impl Columns {
    fn find(table: &CsvTable<'_>) -> Result<Self, InputError> {
        let all =
            || REQUIRED.iter().chain(&FORCE).chain(&MOMENT).chain(&NORMAL).chain(&FOLLOWING).chain(&PART).chain(&LEAN);
        let allowed = all().copied().collect::<Vec<_>>().join(",");
        let fail = |column: &str, problem: &str| table.fail(column, problem, &allowed);
        for name in table.header() {
            if !all().any(|known| *known == name) {
                let nearest = all().max_by(|a, b| strsim::jaro(a, name).total_cmp(&strsim::jaro(b, name)));
                let hint = nearest.map(|n| format!(" (nearest known one: {n})")).unwrap_or_default();
                return Err(fail(&shorten(name), &format!("unknown column{hint}")));
            }
            if table.is_doubled(name) {
                return Err(fail(name, "this column is there twice"));
            }
        }
        let place = |name: &str| table.column(name);
        let required = try_each(REQUIRED, |name| place(name).ok_or_else(|| fail(name, "missing column")))?;
        let group = |names: [&'static str; 3]| -> Result<Option<[usize; 3]>, InputError> {
            let places = names.map(place);
            match places {
                [Some(x), Some(y), Some(z)] => Ok(Some([x, y, z])),
                [None, None, None] => Ok(None),
                _ => {
                    let missing = names[places.iter().position(Option::is_none).unwrap_or(0)];
                    Err(fail(missing, "missing column: the three components go together"))
                }
            }
        };
        let (force, moment, normal) = (group(FORCE)?, group(MOMENT)?, group(NORMAL)?);
        if moment.is_some() && force.is_none() {
            return Err(fail(FORCE[0], "missing column: moments need forces beside them"));
        }
        let [feed, scored] = FOLLOWING.map(place);
        let part = PART.map(place);
        let part = match part.iter().position(Option::is_none) {
            Some(missing) if part.iter().any(Option::is_some) => {
                let problem = "missing column: the six entries of the compliance of the part go together";
                return Err(fail(PART[missing], problem));
            }
            Some(_) => None,
            None => Some(part.map(Option::unwrap_or_default)),
        };
        let lean = LeanColumns::find(table, &fail)?;
        Ok(Self { required, force, moment, normal, feed, scored, part, lean })
    }
}

fn segment(row: &Row<'_>, column: usize) -> Result<u32, InputError> {
    row.text(column).parse().map_err(|_| row.fail(column, "not a segment number", "whole numbers from 1"))
}

/// The compliance of the part at a point. m/N
fn part_compliance(row: &Row<'_>, columns: [usize; 6]) -> Result<Matrix3<f64>, InputError> {
    let [xx, yy, zz, xy, xz, yz] = try_each(columns, |column| Ok(row.number(column)? * 1e-6))?;
    let matrix = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    checked(matrix)
        .map_err(|_| row.fail(columns[0], "the compliance of the part has a negative eigenvalue", SEMIDEFINITE))
}

fn flag(row: &Row<'_>, column: usize) -> Result<bool, InputError> {
    match row.text(column) {
        "0" => Ok(false),
        "1" => Ok(true),
        _ => Err(row.fail(column, "not 0 or 1", "1 for a point that is scored, 0 for one that only has to be reached")),
    }
}

fn positive(row: &Row<'_>, column: usize) -> Result<f64, InputError> {
    let value = row.number(column)?;
    if value > 0.0 { Ok(value) } else { Err(row.fail(column, "not above zero", "a feed above 0 mm/s")) }
}

/// A broken rule of the path, at its line of the file.
fn locate(file: &Path, lines: &[usize], error: &TaskError) -> InputError {
    let (point, field, found, allowed) = match error {
        TaskError::NothingScored => {
            return InputError::new(file, error.to_string()).in_field("scored").allowed("1 in at least one row");
        }
        TaskError::Feed { point, feed } => {
            (*point, "feed_mm_per_s", Some(format!("{}", feed * 1e3)), "a feed above 0 mm/s".to_owned())
        }
        TaskError::Empty
        | TaskError::Wrenches { .. }
        | TaskError::Normals { .. }
        | TaskError::PartCompliances { .. }
        | TaskError::Feeds { .. } => {
            return InputError::new(file, error.to_string()).allowed("at least one row under the header");
        }
        TaskError::PartCompliance { point, .. } => (*point, PART[0], None, SEMIDEFINITE.to_owned()),
        TaskError::NotFinite { point, field } => (*point, *field, None, "finite numbers".to_owned()),
        TaskError::NotUnit { point, field, length } => {
            (*point, *field, Some(format!("length {length:.6}")), format!("length 1 within {UNIT_TOLERANCE}"))
        }
        TaskError::FeedAlongAxis { point, angle_deg } => (
            *point,
            "feed",
            Some(format!("{angle_deg:.2} deg")),
            format!("at least {} deg from the tool axis", stead_model::task::MIN_FEED_TO_AXIS_DEG),
        ),
        TaskError::Repeated(point) => (*point, "x_mm,y_mm,z_mm", None, "each point at a new place".to_owned()),
        TaskError::SegmentOrder { point, before, found } => {
            let allowed = match before {
                0 => "1 at the start".to_owned(),
                n => format!("{n} or {}", n + 1),
            };
            (*point, "segment", Some(found.to_string()), allowed)
        }
    };
    InputError::new(file, error.to_string())
        .at_line(lines.get(point).copied().unwrap_or(0))
        .in_field(field)
        .found_if(found)
        .allowed(allowed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    const HEADER: &str =
        "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n\n";

    fn read(text: &str) -> Result<Imported, InputError> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        read_csv(file.path())
    }

    #[test]
    fn reads_units_and_lines() {
        let task = read(&format!("{HEADER}1,10,20,30,1,0,0,0,0,1,5,6,7\n1,11,20,30,1,0,0,0,0,1,5,6,7\n")).unwrap();
        assert_eq!(task.lines, [2, 3]);
        assert_eq!(task.path.points()[0].position, Vector3::new(0.01, 0.02, 0.03));
        assert_eq!(task.wrenches.unwrap()[1].force, Vector3::new(5.0, 6.0, 7.0));
        let bare = read("segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z\n1,1,2,3,1,0,0,0,0,1\n");
        assert_eq!(bare.unwrap().wrenches, None);
    }

    #[test]
    fn names_line_column_value_and_what_is_allowed() {
        for (text, parts) in [
            (format!("{HEADER}1,10,nan,30,1,0,0,0,0,1,5,6,7\n"), [":2:", "y_mm", "'nan'", "finite"]),
            (format!("{HEADER}1,10,20,30,1,0,0,0,0,1,5,6,inf\n"), [":2:", "force_z_n", "'inf'", "finite"]),
            (HEADER.replace("y_mm", "y_m"), [":1:", "y_m:", "nearest known one: y_mm", "allowed"]),
            (HEADER.replace("feed_y,", ""), [":1:", "feed_y", "missing column", "allowed"]),
            (HEADER.replace("force_y_n,", ""), [":1:", "force_y_n", "missing column", "go together"]),
            (HEADER.to_owned(), ["no points", "allowed", "at least one row", ""]),
            (format!("{HEADER}2,10,20,30,1,0,0,0,0,1,5,6,7\n"), [":2:", "segment", "found 2", "1 at the start"]),
            (format!("{HEADER}1,10,20,30,1,0,0,0,0,2,5,6,7\n"), [":2:", "axis", "length 2", "length 1"]),
            (format!("{HEADER}1,10,20,30,1,0,0\n"), [":2:", "found 7 values", "allowed: 13 values", ""]),
            (HEADER.replace(',', ";"), [":1:", "found ';'", "allowed", "separated by commas"]),
            (HEADER.replace(',', "\t"), [":1:", "found '\\t'", "allowed", "separated by commas"]),
            (format!("{HEADER}x,10,20,30,1,0,0,0,0,1,5,6,7\n"), [":2:", "segment", "'x'", "whole numbers"]),
        ] {
            let message = read(&text).map(|_| ()).unwrap_err().to_string();
            for part in parts {
                assert!(message.contains(part), "{part} in {message}");
            }
        }
    }

    #[test]
    fn the_part_yields_at_each_point_as_its_columns_say() {
        let header = HEADER.trim_end().to_owned() + "," + &PART.join(",") + "\n";
        let row = |x: u32, part: &str| format!("1,{x},20,30,1,0,0,0,0,1,5,6,7,{part}\n");
        let task = read(&[header.clone(), row(10, "0.5,0.25,2,0.1,0,-0.1"), row(11, "1,1,1,0,0,0")].concat()).unwrap();
        let part = task.part.unwrap();
        let expected = Matrix3::new(0.5, 0.1, 0.0, 0.1, 0.25, -0.1, 0.0, -0.1, 2.0) * 1e-6;
        assert!((part[0] - expected).norm() < 1e-18 && (part[1] - Matrix3::identity() * 1e-6).norm() < 1e-18);
        assert_eq!(read(&format!("{HEADER}1,10,20,30,1,0,0,0,0,1,5,6,7\n")).unwrap().part, None);
        for (text, parts) in [
            (header.replace("part_yy_um_per_n,", ""), [":1:", "part_yy_um_per_n", "missing column", "go together"]),
            (
                format!("{header}{}", row(10, "0.5,0.25,2,0.4,0,0")),
                [":2:", "part_xx_um_per_n", "negative", "no eigenvalue"],
            ),
            (format!("{header}{}", row(10, "0.5,0.25,inf,0,0,0")), [":2:", "part_zz_um_per_n", "'inf'", "finite"]),
        ] {
            let message = read(&text).map(|_| ()).unwrap_err().to_string();
            parts.iter().for_each(|part| assert!(message.contains(part), "{part} in {message}"));
        }
    }

    #[test]
    fn lines_are_those_of_an_editor_whatever_ends_them() {
        let good = ["1,10,20,30,1,0,0,0,0,1,5,6,7", "1,11,20,30,1,0,0,0,0,1,5,6,7", "1,12,20,30,1,0,0,0,0,1,5,6,7"];
        for end in ["\n", "\r\n", "\r"] {
            let blank = end.repeat(3);
            // The mark at the start is what spreadsheets put there.
            let text = ["\u{feff}", HEADER.trim_end(), end, good[0], end, good[1], &blank, good[2], end].concat();
            assert_eq!(read(&text).unwrap().lines, [2, 3, 6], "{end:?}");
            let bad = text.replace("1,12,20,30", "1,12,2O,30");
            assert!(read(&bad).map(drop).unwrap_err().to_string().contains(":6: y_mm: "), "{end:?}");
            let short = text.replace("1,12,20,30", "1,12,20");
            assert!(read(&short).map(drop).unwrap_err().to_string().contains(":6: this row"), "{end:?}");
        }
    }
}
