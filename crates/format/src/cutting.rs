//! The `[cutting]` table of a run: cutter and cut.

use super::reader::{Field, Table};
use crate::input::InputError;
use stead_model::cutting::{Coefficients, Cut, Cutter, MillingDirection, PathForces, Rotation, Side};

/// The words for the senses of rotation of a cutter.
pub(super) const ROTATIONS: [(&str, Rotation); 2] =
    [("clockwise", Rotation::Clockwise), ("counterclockwise", Rotation::Counterclockwise)];

/// The words for the directions of milling.
pub(super) const DIRECTIONS: [(&str, MillingDirection); 2] =
    [("conventional", MillingDirection::Conventional), ("climb", MillingDirection::Climb)];

/// Reads the table: the cutter (`cutter_diameter_mm`, `teeth`, `rotation`), the cut (`milling`, `radial_depth_mm`,
/// `axial_depth_mm`, `feed_per_tooth_mm`, `concave_corners`) and the coefficients (`kt_mpa`, `kr`, `kte_n_per_mm`,
/// `kre_n_per_mm`) of [`PathForces`].
pub(super) fn cutting_from(table: &Table<'_>) -> Result<PathForces, InputError> {
    let [diameter, teeth, rotation, milling, radial_depth, axial_depth, feed_per_tooth, kt, kr, kte, kre, corners] =
        table.fields([
            "cutter_diameter_mm",
            "teeth",
            "rotation",
            "milling",
            "radial_depth_mm",
            "axial_depth_mm",
            "feed_per_tooth_mm",
            "kt_mpa",
            "kr",
            "kte_n_per_mm",
            "kre_n_per_mm",
            "concave_corners",
        ])?;
    let not_negative = |field: &Field<'_>| field.number_where("a finite number not below 0", |value| value >= 0.0);
    let sides = [("left", Some(Side::Left)), ("right", Some(Side::Right)), ("none", None)];
    let diameter_mm = diameter.positive()?;
    let slot = format!("a number above 0 and not above cutter_diameter_mm = {diameter_mm}");
    let count = teeth.integer(1..=100)? as usize;
    let rotation = rotation.optional(|field| field.one_of(&ROTATIONS))?.unwrap_or(Rotation::Clockwise);
    let tangential = kt.positive()? * 1e6;
    let coefficients = Coefficients {
        tangential,
        radial: not_negative(&kr)? * tangential,
        axial: 0.0,
        tangential_edge: not_negative(&kte)? * 1e3,
        radial_edge: not_negative(&kre)? * 1e3,
    };
    let cutter = Cutter::even(count, diameter_mm / 2e3, 0.0, rotation, coefficients)
        .map_err(|error| kt.error(format!("makes no cutter: {error}"), "values whose forces are finite"))?;
    Ok(PathForces {
        cut: Cut {
            direction: milling.one_of(&DIRECTIONS)?,
            radial_depth: radial_depth.number_where(&slot, |depth| depth > 0.0 && depth <= diameter_mm)? / 1e3,
            axial_depth: axial_depth.positive()? / 1e3,
        },
        cutter,
        feed_per_tooth: feed_per_tooth.positive()? / 1e3,
        concave_corners: corners.optional(|field| field.one_of(&sides))?.flatten(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use std::path::Path;

    /// The table on line 1, `cutter_diameter_mm` on line 2 and so on in the order of the fields.
    const TEXT: &str = "[cutting]
cutter_diameter_mm = 16
teeth = 4
rotation = 'counterclockwise'
milling = 'climb'
radial_depth_mm = 2
axial_depth_mm = 5
feed_per_tooth_mm = 0.05
kt_mpa = 800
kr = 0.4
kte_n_per_mm = 20
kre_n_per_mm = 0
concave_corners = 'right'
";

    fn read(text: &str) -> Result<PathForces, InputError> {
        let source = Source::new(Path::new("run.toml"), text.as_bytes().to_vec())?;
        let document = source.parse()?;
        cutting_from(&Table::root(&document).field("cutting").table()?)
    }

    #[test]
    fn units_become_si_and_defaults_are_filled_in() {
        let model = read(TEXT).unwrap();
        let coefficients =
            Coefficients { tangential: 800e6, radial: 320e6, axial: 0.0, tangential_edge: 20e3, radial_edge: 0.0 };
        let cutter = |rotation| Cutter::even(4, 0.008, 0.0, rotation, coefficients).unwrap();
        let expected = PathForces {
            cutter: cutter(Rotation::Counterclockwise),
            cut: Cut { direction: MillingDirection::Climb, radial_depth: 0.002, axial_depth: 0.005 },
            feed_per_tooth: 0.05e-3,
            concave_corners: Some(Side::Right),
        };
        assert_eq!(model, expected);
        let bare = TEXT.replace("rotation = 'counterclockwise'\n", "").replace("concave_corners = 'right'\n", "");
        let expected = PathForces { cutter: cutter(Rotation::Clockwise), concave_corners: None, ..expected };
        assert_eq!(read(&bare).unwrap(), expected);
    }

    #[test]
    fn each_broken_rule_names_line_field_value_and_what_is_allowed() {
        for (from, to, parts) in [
            ("mm = 16", "mm = 0", [":2: cutting.cutter_diameter_mm: ", "found 0;", "above 0"]),
            ("teeth = 4", "teeth = 101", [":3: cutting.teeth: ", "found 101;", "from 1 to 100"]),
            ("'counterclockwise'", "'left'", [":4: cutting.rotation: ", "found 'left'", "\"clockwise\" or"]),
            ("'climb'", "'Climb'", [":5: cutting.milling: ", "found 'Climb'", "\"conventional\" or \"climb\""]),
            ("depth_mm = 2", "depth_mm = 16.1", [":6: cutting.radial_depth_mm: ", "found 16.1", "diameter_mm = 16"]),
            ("depth_mm = 5", "depth_mm = -5", [":7: cutting.axial_depth_mm: ", "found -5;", "above 0"]),
            ("0.05", "inf", [":8: cutting.feed_per_tooth_mm: ", "found inf;", "above 0"]),
            ("kr = 0.4", "kr = -0.4", [":10: cutting.kr: ", "found -0.4;", "not below 0"]),
            ("'right'", "'both'", [":13: cutting.concave_corners: ", "found 'both'", "\"none\""]),
            ("kt_mpa", "kt_mp", [":9: cutting.kt_mp: ", "nearest known one: kt_mpa", "found 800"]),
            ("kt_mpa = 800\n", "", [":1: cutting.kt_mpa: ", "missing", "above 0"]),
        ] {
            let message = read(&TEXT.replacen(from, to, 1)).unwrap_err().to_string();
            for part in parts.iter().chain(&["run.toml", "; allowed: "]) {
                assert!(message.contains(part), "{part} in {message}");
            }
        }
    }
}
