use super::engagement::EngagedCutter;
use super::*;
use crate::toml_file::TomlFile;
use std::path::Path;
use stead_model::cutting::{Coefficients, Cut, Cutter, Engagement, PathForces, RakeFace};

/// The tables of a file with nothing else in it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tables {
    tool: Option<ToolTable>,
    cut: Option<CutTable>,
}

fn with<T>(text: &str, read: impl FnOnce(&Cutting<'_>) -> Result<T, InputError>) -> Result<T, InputError> {
    let file = TomlFile::new(Path::new("run.toml"), text.as_bytes().to_vec())?;
    let document = file.parse()?;
    let tables: Tables = document.read()?;
    let at = document.root();
    read(&Cutting::required(Cutting::of(&tables.tool, &tables.cut, &at)?.as_ref(), &at)?)
}

#[track_caller]
fn assert_refused<T: std::fmt::Debug>(read: Result<T, InputError>, parts: &[&str]) {
    let message = read.unwrap_err().to_string();
    for part in parts.iter().chain(&["run.toml", "; allowed: "]) {
        assert!(message.contains(part), "{part} in {message}");
    }
}

mod forces {
    use super::*;

    /// `[tool]` on line 1, `[cut]` on line 9.
    const TEXT: &str = "[tool]
cutter_diameter_mm = 16
teeth = 4
rotation = 'counterclockwise'
kt_mpa = 800
kr = 0.4
kte_n_per_mm = 20
kre_n_per_mm = 0
[cut]
milling = 'climb'
radial_depth_mm = 2
axial_depth_mm = 5
feed_per_tooth_mm = 0.05
concave_corners = 'right'
";

    fn read(text: &str) -> Result<PathForces, InputError> {
        with(text, |cutting| cutting.path_forces())
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
            ("mm = 16", "mm = 0", [":2: tool.cutter_diameter_mm: ", "found 0;", "above 0"]),
            ("teeth = 4", "teeth = 101", [":3: tool.teeth: ", "found 101;", "from 1 to 100"]),
            ("'counterclockwise'", "'left'", [":4: tool.rotation: ", "found 'left'", "\"clockwise\" or"]),
            ("'climb'", "'Climb'", [":10: cut.milling: ", "found 'Climb'", "\"conventional\" or \"climb\""]),
            ("depth_mm = 2", "depth_mm = 16.1", [":11: cut.radial_depth_mm: ", "found 16.1", "diameter_mm = 16"]),
            ("depth_mm = 5", "depth_mm = -5", [":12: cut.axial_depth_mm: ", "found -5;", "above 0"]),
            ("0.05", "inf", [":13: cut.feed_per_tooth_mm: ", "found inf;", "above 0"]),
            ("kr = 0.4", "kr = -0.4", [":6: tool.kr: ", "found -0.4;", "not below 0"]),
            ("'right'", "'both'", [":14: cut.concave_corners: ", "found 'both'", "\"none\""]),
            ("kt_mpa", "kt_mp", [":5: tool.kt_mp: ", "nearest known one: kt_mpa", "found 800"]),
            ("kr = 0.4\n", "", [":1: tool.kr_mpa: ", "missing", "kr_mpa or kr"]),
            ("kr = 0.4", "kr = 0.4\nkr_mpa = 320", [":6: tool.kr: ", "beside kr_mpa", "found 0.4"]),
            ("kr = 0.4", "kr_mpa = -320", [":6: tool.kr_mpa: ", "found -320;", "not below 0"]),
            ("milling = 'climb'\n", "", [":9: cut.milling: ", "missing", "\"climb\""]),
            ("kt_mpa = 800\n", "", [":1: tool.kt_mpa: ", "missing", "above 0"]),
        ] {
            assert_refused(read(&TEXT.replacen(from, to, 1)), &parts);
        }
    }

    /// The order of the lists is that in which the teeth pass (what each pitch is counted from: `milling::tests` of the
    /// simulation).
    #[test]
    fn pitches_and_radii_are_those_of_the_teeth_in_their_order() {
        let listed = "teeth = 3\npitch_deg = [100, 120, 140]\nrunout_um = [6, 0, -4]";
        let cutter = read(&TEXT.replace("teeth = 4", listed)).unwrap().cutter;
        let found: Vec<[f64; 2]> =
            cutter.teeth().iter().map(|tooth| [tooth.pitch.to_degrees(), tooth.radius]).collect();
        for (found, expected) in found.iter().zip([[100.0, 8.006e-3], [120.0, 8e-3], [140.0, 7.996e-3]]) {
            assert!((found[0] - expected[0]).abs() < 1e-12 && (found[1] - expected[1]).abs() < 1e-15, "{found:?}");
        }
        // The second tooth passes 120 deg after the first, and the first 100 deg after the third.
        let offsets: Vec<f64> = cutter.offsets().iter().map(|offset| offset.to_degrees().round()).collect();
        assert_eq!(offsets, [0.0, 120.0, 260.0]);
    }

    #[test]
    fn the_radial_coefficient_is_given_by_itself_or_over_the_tangential_one() {
        assert_eq!(read(&TEXT.replace("kr = 0.4", "kr_mpa = 320")).unwrap(), read(TEXT).unwrap());
    }

    #[test]
    fn one_table_is_not_enough() {
        let (tool, cut) = TEXT.split_at(TEXT.find("[cut]").unwrap());
        assert_refused(read(tool), &["run.toml:1: cut: is missing", "[cut] beside [tool]"]);
        assert_refused(read(cut), &["run.toml:1: tool: is missing", "[tool] beside [cut]"]);
        assert_refused(read(""), &["run.toml:1: tool: is missing", "[tool] and [cut]"]);
    }
}

mod engagements {
    use super::*;

    /// `[tool]` on line 1, `[cut]` on line 10.
    const TEXT: &str = "[tool]
cutter_diameter_mm = 10
teeth = 3
rotation = 'counterclockwise'
entering_angle_deg = 45
helix_deg = -30
rake_deg = 7
friction = 0.4
kn_mpa = 750
[cut]
feed_per_tooth_mm = 0.08
axial_depth_mm = 5
engagement = 'up'
radial_depth_mm = 2.5
";

    fn read(text: &str) -> Result<EngagedCutter, InputError> {
        with(text, |cutting| cutting.engaged_cutter())
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
            ("mm = 10", "mm = 0", &[":2: tool.cutter_diameter_mm: ", "found 0;", "above 0"][..]),
            ("teeth = 3", "teeth = 0", &[":3: tool.teeth: ", "found 0;", "from 1 to 100"]),
            ("'counterclockwise'", "'left'", &[":4: tool.rotation: ", "found 'left'", "\"clockwise\" or"]),
            ("deg = 45", "deg = 180", &[":5: tool.entering_angle_deg: ", "found 180;", "above 0 and below 180"]),
            ("deg = -30", "deg = -90", &[":6: tool.helix_deg: ", "found -90;", "above -90 and below 90"]),
            ("deg = 7", "deg = 90", &[":7: tool.rake_deg: ", "found 90;", "above -90 and below 90"]),
            ("friction = 0.4", "friction = -0.4", &[":8: tool.friction: ", "found -0.4;", "not below 0"]),
            ("kn_mpa = 750", "kn_mpa = nan", &[":9: tool.kn_mpa: ", "found nan;", "above 0"]),
            ("kn_mpa = 750", "kn_mpa = 1e305", &[":9: tool.kn_mpa: ", "found 1e305;", "not above 1e7"]),
            ("friction = 0.4", "friction = 1e308", &[":8: tool.friction: ", "found 1e308;", "not above 1e12"]),
            ("0.08", "inf", &[":11: cut.feed_per_tooth_mm: ", "found inf;", "above 0"]),
            ("mm = 5", "mm = -5", &[":12: cut.axial_depth_mm: ", "found -5;", "above 0"]),
            ("'up'", "'Up'", &[":13: cut.engagement: ", "found 'Up'", "\"up\" or \"down\" or \"centred\""]),
            ("mm = 2.5", "mm = 10.1", &[":14: cut.radial_depth_mm: ", "found 10.1", "diameter_mm = 10"]),
            ("radial_depth_mm = 2.5\n", "", &[":10: cut.radial_depth_mm: ", "missing", "diameter_mm = 10"]),
            ("'up'", "'slot'", &[":14: cut.radial_depth_mm: ", "engagement = 'slot'", "found 2.5", "\"up\""]),
            ("'up'", "'open-slot'", &[":14: cut.radial_depth_mm: ", "= 'open-slot'", "found 2.5", "\"up\""]),
            ("= 2.5", "= 2.5\nopen_width_mm = 1", &[":15: cut.open_width_mm: ", "= 'up'", "found 1", "open-slot"]),
            ("'up'\nradial_depth_mm = 2.5", "'open-slot'", &[":10: cut.open_width_mm: ", "missing", "below cutter_"]),
            (
                "'up'\nradial_depth_mm = 2.5",
                "'open-slot'\nopen_width_mm = 10",
                &[":14: cut.open_width_mm: ", "found 10", "below cutter_diameter_mm = 10"],
            ),
            ("helix_deg", "helix", &[":6: tool.helix: ", "nearest known one: helix_deg", "found -30"]),
        ] {
            assert!(TEXT.contains(from), "{from}");
            assert_refused(read(&TEXT.replacen(from, to, 1)), parts);
        }
    }
}

/// What is kept apart from the part is as wide as the cutter wherever it is cut across.
#[test]
fn a_tapered_cutter_widens_and_its_holder_stands_above_it() {
    let body = |keys: &str| {
        let text = format!("cutter_diameter_mm = 4\nflute_length_mm = 30\nholder_mm = [[20, 12]]\n{keys}");
        toml::from_str::<ToolTable>(&text).unwrap().body()
    };
    let straight = body("");
    assert_eq!((straight.taper.len(), straight.cutter.unwrap().radius), (0, 0.002));
    let tapered = body("corner_radius_mm = 2\ntaper_deg = 10");
    assert_eq!(tapered.holder, straight.holder);
    let parts: Vec<_> = tapered.cutter.iter().chain(&tapered.taper).collect();
    assert!(parts.len() > 5);
    // A ball of 2 mm with a side that leans by 10 deg: at the tip that is 2 / cos(10 deg) - 2 tan(10 deg) off the axis.
    let (sine, cosine) = libm::sincos(10_f64.to_radians());
    let side = |height: f64| 0.002 / cosine + (height - 0.002) * sine / cosine;
    for (part, next) in parts.iter().zip(&parts[1..]) {
        assert!((part.to - next.from).abs() < 1e-12);
    }
    for part in &parts {
        assert!((part.radius - side(part.to)).abs() < 1e-12, "{part:?}");
    }
    assert!((parts[parts.len() - 1].to - 0.03).abs() < 1e-12 && parts[0].from == 0.0);
}
