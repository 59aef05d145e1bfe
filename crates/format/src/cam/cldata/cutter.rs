//! The cutter that a statement of CLDATA describes.

use super::super::tool::ProgramTool;
use super::statement::Statement;

/// Kinds of cutters of `TLDATA` whose first number is a diameter.
const ROUND: [&str; 4] = ["MILL", "DRILL", "TCUTTER", "BARREL"];

/// The tool of a `TLDATA` or `CUTTER` statement, whose unit of length is so many metres.
pub(super) fn cutter(statement: &Statement<'_>, unit: f64) -> ProgramTool {
    let is_apt = statement.word.eq_ignore_ascii_case("CUTTER");
    let is_mill = is_apt || statement.has("MILL");
    let length = |place: usize| {
        let number = statement.numbers().nth(place);
        number.filter(|number| *number > 0.0).map(|number| number * unit)
    };
    ProgramTool {
        description: format!("{}/{}", statement.word, statement.text()),
        diameter: length(0).filter(|_| is_apt || ROUND.iter().any(|kind| statement.has(kind))),
        // TLDATA/MILL, diameter, corner, length, ..; CUTTER/diameter, corner, four numbers of its place and flanks,
        // height.
        corner_radius: length(1).filter(|_| is_mill),
        length: length(if is_apt { 6 } else { 2 }).filter(|_| is_mill),
        ..ProgramTool::default()
    }
}
