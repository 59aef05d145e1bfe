//! Columns of `study.csv` in the words of its page, and its numbers.

use crate::units::figures;
use stead_study::analysis::Layout;

/// Columns of what is found, with their words and units.
const COLUMNS: [(&str, &str, &str); 8] = [
    ("objective_mm", "score", "mm"),
    ("cycle_s", "cycle time", "s"),
    ("min_inverse_condition", "smallest 1/κ", ""),
    ("min_joint_margin_deg", "least distance from a joint limit", "deg"),
    ("min_base_distance_mm", "least distance of the path from axis 1", "mm"),
    ("min_clearance_mm", "least clearance", "mm"),
    ("max_feed_mm_per_s", "highest feed", "mm/s"),
    ("price_eur", "price of the arm", "EUR"),
];

/// Endings of names and the units that they are, the longer ones first.
const UNITS: &str = "_mnm_per_rad:MN m/rad,_urad_per_nm:µrad/(N m),_deg_per_mm:deg/mm,_deg_per_s:deg/s,_mm_per_s:mm/s,\
                     _n_per_mm:N/mm,_percent:%,_mpa:MPa,_rpm:1/min,_deg:deg,_mm:mm,_kg:kg,_hz:Hz,_nm:N m,_n:N,_s:s";

/// Which case of a placement a figure is of.
const CASES: [(&str, &str); 4] = [
    ("best_worst_plan_", ", worst plan"),
    ("worst_worst_plan_", ", worst placement and plan"),
    ("best_", ""),
    ("worst_", ", worst placement"),
];

/// A column in words, and its unit: `objective_mm` is the score in mm, `best_mean_total_mm` the mean of the whole
/// deflection; names of axes are those of the study.
pub(super) fn words(name: &str) -> (String, &'static str) {
    if let Some((_, words, unit)) = COLUMNS.iter().find(|(column, ..)| *column == name) {
        return ((*words).to_owned(), unit);
    }
    let mut units = UNITS.split(',').filter_map(|unit| unit.split_once(':'));
    let ending = units.find_map(|(ending, unit)| Some((name.strip_suffix(ending)?, unit)));
    let (bare, unit) = ending.filter(|(bare, _)| !bare.is_empty()).unwrap_or((name, ""));
    let words = deflection(bare).unwrap_or_else(|| bare.replace(['_', '.'], " "));
    (words, unit)
}

/// A figure of a case.
fn deflection(bare: &str) -> Option<String> {
    let (rest, case) = CASES.iter().find_map(|(start, words)| Some((bare.strip_prefix(start)?, words)))?;
    let (of, part) = match rest.split_once('_')? {
        ("mean", part) => ("mean", part),
        ("max", part) => ("largest", part),
        _ => return None,
    };
    let parts = [("wall", "wall deflection"), ("axis", "deflection along the axis"), ("total", "whole deflection")];
    let (_, part) = parts.iter().find(|(key, _)| *key == part)?;
    Some(format!("{part}, {of}{case}"))
}

/// The same as a heading: `score (mm)`.
pub(super) fn heading(name: &str) -> String {
    match words(name) {
        (words, "") => words,
        (words, unit) => format!("{words} ({unit})"),
    }
}

/// A value of an axis, long numbers with three significant digits.
pub(super) fn value(written: &str) -> String {
    let number = written.parse::<f64>().ok().filter(|_| written.len() > 6);
    number.map_or_else(|| written.to_owned(), figures)
}

/// The numbers of the cases of a layout.
pub(super) fn cases(layout: &Layout) -> String {
    layout.cases.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// A number with the nine digits that are more than rounding.
pub(super) fn number(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(f64::NAN)
}

/// A share in per cent.
pub(super) fn percent(share: f64) -> f64 {
    number(100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_have_words_and_units() {
        for (name, expected) in [
            ("objective_mm", "score (mm)"),
            ("best_mean_total_mm", "whole deflection, mean (mm)"),
            ("worst_worst_plan_max_wall_mm", "wall deflection, largest, worst placement and plan (mm)"),
            ("k1_mnm_per_rad", "k1 (MN m/rad)"),
            ("robot.joints[1].stiffness_mnm_per_rad", "robot joints[1] stiffness (MN m/rad)"),
            ("best_robot", "best robot"),
            ("_mm", " mm"),
            ("height", "height"),
        ] {
            assert_eq!(heading(name), expected);
        }
        assert_eq!(["4.70589886352", "6", "a.toml", "123456.7"].map(value), ["4.71", "6", "a.toml", "123457"]);
        // Every column of what is found has words that are no key.
        for column in stead_study::cases::result_columns() {
            assert!(!heading(&column.name).contains('_'), "{}", column.name);
        }
    }
}
