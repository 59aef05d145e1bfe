//! The `[milling]` table: a cutter with the geometry of its teeth, and its cut.

use super::cutting::ROTATIONS;
use super::reader::{Field, Table};
use crate::input::InputError;
use stead_model::cutting::{Cutter, CuttingForce, Engagement, ForceHistory, RakeFace, Rotation};
use stead_model::task::Wrench;

/// The ways of milling that the field `engagement` names.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Slot,
    Up,
    Down,
    Centred,
    OpenSlot,
}

/// A cutter in the work.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct EngagedCutter {
    cutter: Cutter,
    axial_depth: f64,
    feed_per_tooth: f64,
    engagement: Engagement,
}

impl EngagedCutter {
    /// The forces over the engagement and over a turn.
    pub fn force_history(&self) -> ForceHistory {
        let Self { cutter, axial_depth, feed_per_tooth, engagement } = self;
        let force = CuttingForce { cutter, axial_depth: *axial_depth, feed_per_tooth: *feed_per_tooth };
        ForceHistory::new(&force, engagement)
    }
}

/// Reads the table: the cutter (`cutter_diameter_mm`, `teeth`, `rotation`, `entering_angle_deg`, `helix_deg`, `rake_deg`), its
/// coefficients (`friction`, `kn_mpa`) and the cut (`feed_per_tooth_mm`, `axial_depth_mm`) of [`EngagedCutter`], and the
/// [`Engagement`] (`engagement`, with `radial_depth_mm` for up, down and centred, `open_width_mm` for open-slot). Left out,
/// the rotation is clockwise, the entering angle 90 deg, and helix, rake and friction are 0.
///
/// # Errors
/// [`InputError`] with file, line and field: a missing or unknown key, a value of the wrong kind or out of range, a width that
/// the engagement does not have.
pub(super) fn milling_from(table: &Table<'_>) -> Result<EngagedCutter, InputError> {
    let [
        diameter,
        teeth,
        rotation,
        entering_angle,
        helix,
        rake,
        friction,
        kn,
        feed_per_tooth,
        axial_depth,
        way,
        radial_depth,
        open_width,
    ] = table.fields([
        "cutter_diameter_mm",
        "teeth",
        "rotation",
        "entering_angle_deg",
        "helix_deg",
        "rake_deg",
        "friction",
        "kn_mpa",
        "feed_per_tooth_mm",
        "axial_depth_mm",
        "engagement",
        "radial_depth_mm",
        "open_width_mm",
    ])?;
    let entering = |field: &Field<'_>| field.number_where("a number above 0 and below 180", |v| v > 0.0 && v < 180.0);
    let inclined = |field: &Field<'_>| field.number_where("a number above -90 and below 90", |v| v.abs() < 90.0);
    let not_negative = |field: &Field<'_>| field.number_where("a finite number not below 0", |v| v >= 0.0);
    let diameter_mm = diameter.positive()?;
    let count = teeth.integer(1..=100)? as usize;
    let rotation = rotation.optional(|field| field.one_of(&ROTATIONS))?.unwrap_or(Rotation::Clockwise);
    let entering_angle = entering_angle.optional(entering)?.unwrap_or(90.0).to_radians();
    let helix = helix.optional(inclined)?.unwrap_or_default().to_radians();
    let face = RakeFace {
        entering_angle,
        rake: rake.optional(inclined)?.unwrap_or_default().to_radians(),
        friction: friction.optional(not_negative)?.unwrap_or_default(),
        normal_pressure: kn.positive()? * 1e6,
    };
    let (feed_per_tooth, axial_depth) = (feed_per_tooth.positive()? / 1e3, axial_depth.positive()? / 1e3);
    let engagement = engagement_from(&way, &radial_depth, &open_width, diameter_mm)?;
    let cutter = Cutter::even(count, diameter_mm / 2e3, helix, rotation, face.coefficients(helix)).ok();
    let is_finite = |cutter: &Cutter| {
        let Wrench { force, moment } = CuttingForce { cutter, axial_depth, feed_per_tooth }.mean_wrench(&engagement);
        force.iter().chain(moment.iter()).all(|part| part.is_finite())
    };
    match cutter.filter(is_finite) {
        Some(cutter) => Ok(EngagedCutter { cutter, axial_depth, feed_per_tooth, engagement }),
        None => {
            Err(kn
                .error("gives, with the other values of the table, no finite force", "values whose forces are finite"))
        }
    }
}

fn engagement_from(
    field: &Field<'_>,
    radial_depth: &Field<'_>,
    open_width: &Field<'_>,
    diameter_mm: f64,
) -> Result<Engagement, InputError> {
    let way = field.one_of(&[
        ("slot", Way::Slot),
        ("up", Way::Up),
        ("down", Way::Down),
        ("centred", Way::Centred),
        ("open-slot", Way::OpenSlot),
    ])?;
    let has_depth = matches!(way, Way::Up | Way::Down | Way::Centred);
    let taken = [
        (radial_depth, has_depth, "with engagement = \"up\", \"down\" or \"centred\" alone"),
        (open_width, way == Way::OpenSlot, "with engagement = \"open-slot\" alone"),
    ];
    for (width, expected, allowed) in taken {
        if width.is_given() && !expected {
            return Err(width.error(format!("does not go with engagement = {}", field.written()), allowed));
        }
    }
    let diameter = diameter_mm / 1e3;
    let up_to = format!("a number above 0 and not above cutter_diameter_mm = {diameter_mm}");
    let below = format!("a number above 0 and below cutter_diameter_mm = {diameter_mm}");
    let depth = || radial_depth.number_where(&up_to, |width| width > 0.0 && width <= diameter_mm);
    let open = || open_width.number_where(&below, |width| width > 0.0 && width < diameter_mm);
    let (at, made) = match way {
        Way::Slot => (field, Ok(Engagement::slot())),
        Way::Up => (radial_depth, Engagement::up(depth()? / 1e3, diameter)),
        Way::Down => (radial_depth, Engagement::down(depth()? / 1e3, diameter)),
        Way::Centred => (radial_depth, Engagement::centred(depth()? / 1e3, diameter)),
        Way::OpenSlot => (open_width, Engagement::open_slot(open()? / 1e3, diameter)),
    };
    made.map_err(|error| at.error(format!("makes no engagement: {error}"), up_to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use std::path::Path;

    /// The table on line 1, `cutter_diameter_mm` on line 2 and so on in the order of the fields.
    const TEXT: &str = "[milling]
cutter_diameter_mm = 10
teeth = 3
rotation = 'counterclockwise'
entering_angle_deg = 45
helix_deg = -30
rake_deg = 7
friction = 0.4
kn_mpa = 750
feed_per_tooth_mm = 0.08
axial_depth_mm = 5
engagement = 'up'
radial_depth_mm = 2.5
";

    fn read(text: &str) -> Result<EngagedCutter, InputError> {
        let source = Source::new(Path::new("run.toml"), text.as_bytes().to_vec())?;
        let document = source.parse()?;
        milling_from(&Table::root(&document).field("milling").table()?)
    }

    #[test]
    fn units_become_si_and_defaults_are_filled_in() {
        let face = RakeFace {
            entering_angle: 45_f64.to_radians(),
            rake: 7_f64.to_radians(),
            friction: 0.4,
            normal_pressure: 750e6,
        };
        let helix = -30_f64.to_radians();
        let cutter = |rotation, helix, face: RakeFace| {
            Cutter::even(3, 0.005, helix, rotation, face.coefficients(helix)).unwrap()
        };
        let expected = EngagedCutter {
            cutter: cutter(Rotation::Counterclockwise, helix, face),
            axial_depth: 0.005,
            feed_per_tooth: 0.08e-3,
            engagement: Engagement::up(0.0025, 0.01).unwrap(),
        };
        assert_eq!(read(TEXT).unwrap(), expected);
        let kept =
            |line: &&str| !["rotation", "entering", "helix", "rake", "friction"].iter().any(|k| line.starts_with(k));
        let bare = TEXT.lines().filter(kept).collect::<Vec<_>>().join("\n");
        let plain = RakeFace { entering_angle: 90_f64.to_radians(), rake: 0.0, friction: 0.0, ..face };
        let expected = EngagedCutter { cutter: cutter(Rotation::Clockwise, 0.0, plain), ..expected };
        assert_eq!(read(&bare).unwrap(), expected);
    }

    #[test]
    fn each_engagement_is_read_with_its_width() {
        let up = "engagement = 'up'\nradial_depth_mm = 2.5\n";
        for (text, expected) in [
            ("engagement = 'slot'\n", Ok(Engagement::slot())),
            ("engagement = 'up'\nradial_depth_mm = 10\n", Ok(Engagement::slot())),
            ("engagement = 'down'\nradial_depth_mm = 2.5\n", Engagement::down(0.0025, 0.01)),
            ("engagement = 'centred'\nradial_depth_mm = 7.5\n", Engagement::centred(0.0075, 0.01)),
            ("engagement = 'open-slot'\nopen_width_mm = 4\n", Engagement::open_slot(0.004, 0.01)),
        ] {
            assert_eq!(read(&TEXT.replace(up, text)).unwrap().engagement, expected.unwrap(), "{text}");
        }
    }

    #[test]
    fn each_broken_rule_names_line_field_value_and_what_is_allowed() {
        for (from, to, parts) in [
            ("mm = 10", "mm = 0", &[":2: milling.cutter_diameter_mm: ", "found 0;", "above 0"][..]),
            ("teeth = 3", "teeth = 0", &[":3: milling.teeth: ", "found 0;", "from 1 to 100"]),
            ("'counterclockwise'", "'left'", &[":4: milling.rotation: ", "found 'left'", "\"clockwise\" or"]),
            ("deg = 45", "deg = 180", &[":5: milling.entering_angle_deg: ", "found 180;", "above 0 and below 180"]),
            ("deg = -30", "deg = -90", &[":6: milling.helix_deg: ", "found -90;", "above -90 and below 90"]),
            ("deg = 7", "deg = 90", &[":7: milling.rake_deg: ", "found 90;", "above -90 and below 90"]),
            ("friction = 0.4", "friction = -0.4", &[":8: milling.friction: ", "found -0.4;", "not below 0"]),
            ("kn_mpa = 750", "kn_mpa = nan", &[":9: milling.kn_mpa: ", "found nan;", "above 0"]),
            ("kn_mpa = 750", "kn_mpa = 1e305", &[":9: milling.kn_mpa: ", "found 1e305;", "no finite force"]),
            ("0.08", "inf", &[":10: milling.feed_per_tooth_mm: ", "found inf;", "above 0"]),
            ("mm = 5", "mm = -5", &[":11: milling.axial_depth_mm: ", "found -5;", "above 0"]),
            ("'up'", "'Up'", &[":12: milling.engagement: ", "found 'Up'", "\"up\" or \"down\" or \"centred\""]),
            ("mm = 2.5", "mm = 10.1", &[":13: milling.radial_depth_mm: ", "found 10.1", "diameter_mm = 10"]),
            ("radial_depth_mm = 2.5\n", "", &[":1: milling.radial_depth_mm: ", "missing", "diameter_mm = 10"]),
            ("'up'", "'slot'", &[":13: milling.radial_depth_mm: ", "engagement = 'slot'", "found 2.5", "\"up\""]),
            ("'up'", "'open-slot'", &[":13: milling.radial_depth_mm: ", "= 'open-slot'", "found 2.5", "\"up\""]),
            ("= 2.5", "= 2.5\nopen_width_mm = 1", &[":14: milling.open_width_mm: ", "= 'up'", "found 1", "open-slot"]),
            (
                "'up'\nradial_depth_mm = 2.5",
                "'open-slot'",
                &[":1: milling.open_width_mm: ", "missing", "below cutter_"],
            ),
            (
                "'up'\nradial_depth_mm = 2.5",
                "'open-slot'\nopen_width_mm = 10",
                &[":13: milling.open_width_mm: ", "found 10", "below cutter_diameter_mm = 10"],
            ),
            ("helix_deg", "helix", &[":6: milling.helix: ", "nearest known one: helix_deg", "found -30"]),
        ] {
            assert!(TEXT.contains(from), "{from}");
            let message = read(&TEXT.replacen(from, to, 1)).unwrap_err().to_string();
            for part in parts.iter().chain(&["run.toml", "; allowed: "]) {
                assert!(message.contains(part), "{part} in {message}");
            }
        }
    }
}
