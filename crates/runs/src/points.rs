//! Measured points from CSV, as coordinate measuring machines export them.

use std::path::{Path, PathBuf};
use stead_assessment::circle::CircleError;
use stead_assessment::roundness::{Measured, RoundnessError};
use stead_disk::files;
use stead_disk::input::csv_table::CsvTable;
use stead_disk::input::{InputError, InputFile, input_file};
use stead_disk::manifest::{self, Unlisted};
use stead_disk::quote::shorten;

/// What a file of points holds.
#[derive(Debug, Clone, PartialEq)]
pub struct PointFile {
    /// The points, in mm: dividing them would cost digits that a circularity of micrometres has need of.
    pub measured: Measured,
    /// Line of each point in the file, from 1.
    pub lines: Vec<usize>,
    /// The file as the user named it.
    pub file: PathBuf,
    /// The file with its digest.
    pub input: InputFile,
}

/// Reads measured points: columns `x_mm,y_mm` or `x_mm,y_mm,z_mm` in any order; other columns are passed over.
///
/// # Errors
/// [`InputError`] naming line and column: a file that cannot be read, a missing or doubled column, a value that is no
/// finite number.
pub fn read_points(file: &Path) -> Result<PointFile, InputError> {
    let bytes = files::read(file).map_err(|e| {
        InputError::new(file, format!("cannot be read: {e}")).allowed("the name of a readable CSV file of points")
    })?;
    manifest::check(file, &bytes, Unlisted::Accepted)?;
    let mut table = CsvTable::new(file, &bytes)?;
    let fail =
        |name: &str, problem: &str| table.fail(name, problem, "a header with x_mm,y_mm or x_mm,y_mm,z_mm, each once");
    for name in ["x_mm", "y_mm", "z_mm"] {
        if table.is_doubled(name) {
            return Err(fail(name, "this column is there twice"));
        }
    }
    let missing = |name: &str| {
        let found = shorten(&table.header().collect::<Vec<_>>().join(","));
        fail(name, "missing column").found(format!("'{found}'"))
    };
    let x = table.column("x_mm").ok_or_else(|| missing("x_mm"))?;
    let y = table.column("y_mm").ok_or_else(|| missing("y_mm"))?;
    let z = table.column("z_mm");
    let (mut planar, mut spatial, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    while let Some(row) = table.next_row()? {
        match z {
            None => planar.push([row.number(x)?, row.number(y)?]),
            Some(z) => spatial.push([row.number(x)?, row.number(y)?, row.number(z)?]),
        }
        lines.push(row.line());
    }
    let measured = if z.is_some() { Measured::Spatial(spatial) } else { Measured::Planar(planar) };
    let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(PointFile { measured, lines, file: file.to_owned(), input: input_file("points", name, &bytes) })
}

impl PointFile {
    /// What is wrong with the points, at the line that is at fault.
    pub fn locate(&self, error: RoundnessError) -> InputError {
        const ALLOWED: &str = "at least three different points that are not on one straight line";
        let (cause, excluded) = match error {
            RoundnessError::Points(cause) => (cause, None),
            RoundnessError::Left { count, cause } => (cause, Some(count)),
        };
        let columns = match self.measured {
            Measured::Planar(_) => "x_mm,y_mm",
            Measured::Spatial(_) => "x_mm,y_mm,z_mm",
        };
        let first = self.lines.first().copied().unwrap_or(1);
        let (line, found, allowed) = match cause {
            CircleError::NotFinite(point) => (self.lines.get(point).copied().unwrap_or(first), None, "finite numbers"),
            CircleError::TooFew(distinct) => (first, Some(format!("{distinct} different points")), ALLOWED),
            CircleError::Collinear => (first, Some(format!("{} points on a line", self.lines.len())), ALLOWED),
            CircleError::Straight => {
                (first, None, "points of a circle, or of an arc that is bent more than it is rough")
            }
        };
        let located = match excluded {
            None => InputError::new(&self.file, cause.to_string()).at_line(line).in_field(columns),
            Some(count) => {
                let all = self.lines.len();
                InputError::new(&self.file, format!("with {count} of {all} points left, {cause}"))
                    .in_field("--exclude-deg")
            }
        };
        located.found_if(found).allowed(allowed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<PointFile, InputError> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read_points(file.path())
    }

    #[test]
    fn columns_are_found_by_name_and_others_passed_over() {
        let flat = read("name,y_mm,x_mm\na,2,1\n\nb,4,3.5\n").unwrap();
        assert_eq!(flat.measured, Measured::Planar(vec![[1.0, 2.0], [3.5, 4.0]]));
        assert_eq!(flat.lines, [2, 4]);
        let spatial = read("\u{feff}x_mm,y_mm,z_mm\r\n1,2,3\r\n").unwrap();
        assert_eq!(spatial.measured, Measured::Spatial(vec![[1.0, 2.0, 3.0]]));
    }

    #[test]
    fn names_line_column_value_and_what_is_allowed() {
        for (text, parts) in [
            ("x_mm,y_mm\n1,nan\n", [":2: y_mm: ", "'nan'", "allowed: a finite"]),
            ("x_mm,y_mm\n1,2\n-inf,2\n", [":3: x_mm: ", "'-inf'", "allowed: a finite"]),
            ("x_mm,y_mm\n1,2\n3,1e10\n", [":3: y_mm: ", "'1e10'", "at most 1e9"]),
            ("x_mm,y_mm\n1,\n", [":2: y_mm: ", "''", "allowed: a finite"]),
            ("x_mm,y\n1,2\n", [":1: y_mm: missing column", "'x_mm,y'", "x_mm,y_mm,z_mm"]),
            ("x_mm,y_mm,x_mm\n1,2,3\n", [":1: x_mm: ", "there twice", "each once"]),
            ("x_mm;y_mm\n1;2\n", [":1: ", "';'", "separated by commas"]),
            ("x_mm,y_mm\n1,2,3\n", [":2: ", "found 3 values", "allowed: 2 values"]),
            ("", [":1: x_mm: missing column", "found ''", "allowed"]),
        ] {
            let message = read(text).unwrap_err().to_string();
            for part in parts {
                assert!(message.contains(part), "{part} in {message}");
            }
        }
    }
}
