//! The cutter that a statement of CLDATA describes.

use super::super::tool::ProgramTool;
use super::dialect::CutterForm;
use super::statement::Statement;

/// Kinds of cutters of `TLDATA` whose first number is a diameter.
const ROUND: [&str; 4] = ["MILL", "DRILL", "TCUTTER", "BARREL"];
/// An angle of the flank from here on is that of the point of a drill. deg
const POINT_ANGLE: f64 = 25.0;
/// Lengths that differ by less than this share are the same.
const ROUNDING: f64 = 1e-3;

/// The tool of a statement, whose unit of length is so many metres.
pub(super) fn cutter(statement: &Statement<'_>, form: CutterForm, unit: f64) -> ProgramTool {
    let number = |place: usize| statement.numbers().nth(place).unwrap_or(0.0);
    let length = |place: usize| Some(number(place) * unit).filter(|length| *length > 0.0);
    let tool = ProgramTool {
        description: format!("{}/{}", statement.word.trim_start_matches("$$->"), statement.text()),
        ..ProgramTool::default()
    };
    let taper = |deg: f64| Some(deg).filter(|deg| (1e-6..POINT_ANGLE).contains(deg)).map(f64::to_radians);
    match form {
        CutterForm::Flutes => ProgramTool { length: length(0), ..tool },
        CutterForm::Diameter => ProgramTool { diameter: length(0), ..tool },
        // Diameter, corner, length, taper, tip.
        CutterForm::Kind => {
            let is_round = ROUND.iter().any(|kind| statement.has(kind));
            let is_mill = statement.has("MILL");
            ProgramTool {
                diameter: length(0).filter(|_| is_round),
                corner_radius: length(1).filter(|_| is_mill),
                length: length(2).filter(|_| is_mill),
                taper: taper(number(3)).filter(|_| is_mill),
                is_other_shape: is_round && !statement.has("DRILL") && (!is_mill || number(3) < 0.0),
                ..tool
            }
        }
        // Diameter, corner, place of its centre from the axis and from the tip, angles of tip and flank, height.
        CutterForm::Apt | CutterForm::AptWithCentre => {
            let [diameter, corner, centre] = [0, 1, 2].map(number);
            let off = (centre + corner - diameter / 2.0).abs();
            let is_other_shape = form == CutterForm::AptWithCentre && off > ROUNDING * diameter.abs() + 1e-9;
            ProgramTool {
                diameter: length(0),
                corner_radius: length(1).filter(|_| !is_other_shape),
                length: length(6),
                taper: taper(number(5)),
                is_other_shape: is_other_shape || number(5) < 0.0,
                ..tool
            }
        }
    }
}
