use super::*;
use nalgebra::{Matrix3, Vector3};
use std::path::PathBuf;
use stead_assessment::benchmark::{LimitsAt, StiffnessModel, Turning};
use stead_assessment::comparison::{ElbowNames, Load};
use stead_assessment::map::Elbow;
use stead_assessment::published::Quantity;
use stead_format::testing::root;

/// An assessment file without optional tables but a few, for two robots.
const TEXT: &str = "robots = ['one.toml', 'two.toml']
[benchmark]
radius_mm = 100
force_n = [-440, -1370, -635]
[map]
x_mm = [500, 1000]
y_mm = [0, 400]
step_mm = 100
[zones]
sides_mm = [100, 400]
[selection]
accuracies_mm = [0.2]
forces_n = [500]
";

const MILLING: &str = "[tool]
cutter_diameter_mm = 10
teeth = 3
kn_mpa = 750
friction = 0.4
[cut]
feed_per_tooth_mm = 0.08
axial_depth_mm = 5
engagement = 'down'
radial_depth_mm = 3
[map]";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (from, to) in [("kuka-kr270-2.toml", "one.toml"), ("kuka-kr500.toml", "two.toml")] {
        std::fs::copy(root().join("configs/robots").join(from), folder.path().join(to)).unwrap();
    }
    std::fs::copy(root().join("configs/reference/klimchik-2017-tables.toml"), folder.path().join("tables.toml"))
        .unwrap();
    folder
}

fn read(text: &str) -> Result<AssessRun, InputError> {
    let folder = folder();
    let file: PathBuf = folder.path().join("study.toml");
    std::fs::write(&file, text).unwrap();
    read_assessment(&file)
}

#[test]
fn defaults_are_equation_34_as_written_on_the_plane_xoz() {
    let run = read(TEXT).unwrap();
    let Comparison { robots, benchmark, grid, zones, elbow_names, rated_share, selection } = &run.comparison;
    assert_eq!(robots.iter().map(Robot::name).collect::<Vec<_>>(), ["KUKA KR270-2", "KUKA KR 500"]);
    assert_eq!((benchmark.plane, benchmark.radius, benchmark.points), (Plane::XOZ, 0.1, 72));
    assert_eq!(benchmark.wrench.force, Vector3::new(-440.0, -1370.0, -635.0));
    assert_eq!(benchmark.wrench.moment, Vector3::zeros());
    assert_eq!((benchmark.turning, benchmark.limits_at), (Turning::WithTool, LimitsAt::Circle));
    assert_eq!((benchmark.stiffness, benchmark.yielding), (StiffnessModel::Unloaded, [true; 6]));
    assert_eq!(benchmark.flange_from_tool, Some(Pose::identity()));
    // The tool comes from the side of -Y, its z axis pointing to +Y, its x axis along X.
    let expected = Matrix3::from_columns(&[Vector3::x(), -Vector3::z(), Vector3::y()]);
    assert!((benchmark.base_from_tool - expected).abs().max() < 1e-15);
    assert_eq!((grid.origin, grid.counts, zones.as_slice()), ([0.5, 0.0], [6, 5], [1, 4].as_slice()));
    assert_eq!((*elbow_names, run.range_share, *rated_share), (ElbowNames::Geometric, None, 0.8));
    assert_eq!((selection.accuracies[0], selection.forces[0], selection.remaining_share), (0.2e-3, 500.0, 1.0));
    assert_eq!(selection.gravity, 9.80665);
    assert!(run.published.is_none() && run.force_history.is_none());
    assert!(run.notes[0].contains("KUKA KR 500") && run.notes[0].contains("linear in the joint angle"));
    assert_eq!(run.inputs.iter().map(|input| input.role).collect::<Vec<_>>(), ["config", "robot", "robot"]);
}

#[test]
fn optional_tables_override_the_defaults() {
    let more = "[plane]\norigin_mm = [0, 0, 500]\nx = [0, 1, 0]\ny = [-1, 0, 0]\n[stiffness]\njoints = [2, 3]\n\
                range_share = 0.25\nloaded = true\n[load]\nrated_share = 0.5\ngravity_m_per_s2 = 10\n[map]";
    let keys = "radius_mm = 50\npoints = 36\nforce_turns = 'against-tool'\ntraced = 'wrist-centre'\nlimits_at = 'centre'\n\
                elbow_names = 'swapped'\nmoment_nm = [1, 2, 3]\ntool_axis = [0, 0.6, 0.8]\nbeta_deg = 90";
    let run = read(&TEXT.replace("[map]", more).replace("radius_mm = 100", keys)).unwrap();
    let benchmark = &run.comparison.benchmark;
    assert_eq!(benchmark.plane.origin, Vector3::new(0.0, 0.0, 0.5));
    assert!((benchmark.plane.normal() - Vector3::z()).norm() < 1e-15);
    assert_eq!((benchmark.radius, benchmark.points, benchmark.flange_from_tool), (0.05, 36, None));
    assert_eq!((benchmark.turning, benchmark.limits_at), (Turning::AgainstTool, LimitsAt::Centre));
    assert_eq!(benchmark.wrench.moment, Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(benchmark.yielding, [false, true, true, false, false, false]);
    assert_eq!(benchmark.stiffness, StiffnessModel::Loaded);
    // Beta turns the tool's x axis from the part of the plane's x axis normal to the tool axis towards axis x that.
    let [x, z] = [0, 2].map(|k| benchmark.base_from_tool.column(k).into_owned());
    assert!((z + Vector3::new(0.0, 0.6, 0.8)).norm() < 1e-12);
    assert!((x - Vector3::new(-1.0, 0.0, 0.0)).norm() < 1e-12);
    assert_eq!((run.comparison.elbow_names, run.range_share), (ElbowNames::Swapped, Some(0.25)));
    let quarter = Compliance::Constant(0.14 / 1e6 + 0.25 * (0.20 / 1e6 - 0.14 / 1e6));
    assert_eq!(run.comparison.robots[1].joints()[1].compliance, quarter);
    assert_eq!((run.comparison.rated_share, run.comparison.selection.gravity), (0.5, 10.0));
    // No range is left, but the KR270-2's payload is not known.
    assert!(run.notes.len() == 1 && run.notes[0].contains("no payload_kg in the robot file (KUKA KR270-2)"));
}

#[test]
fn a_cut_is_put_to_the_circle() {
    let computed = TEXT.replace("force_n = [-440, -1370, -635]\n", "").replace("[map]", MILLING);
    let run = read(&computed).unwrap();
    let mean = run.force_history.as_ref().unwrap().mean;
    // The tool axis is the normal: the feed is tangential, its left towards the centre.
    let wrench = run.comparison.benchmark.wrench;
    assert_eq!(wrench.force, Vector3::new(-mean.force.y, mean.force.x, mean.force.z));
    assert_eq!(wrench.moment, Vector3::new(-mean.moment.y, mean.moment.x, mean.moment.z));
    // From the other side of the plane the left of the feed is outwards, and the axis is against the normal.
    let other = computed.replace("radius_mm = 100", "radius_mm = 100\ntool_axis = [0, 1, 0]");
    let wrench = read(&other).unwrap().comparison.benchmark.wrench;
    assert_eq!(wrench.force, Vector3::new(mean.force.y, mean.force.x, -mean.force.z));
}

#[test]
fn the_shipped_files_are_the_published_case_and_its_tables() {
    for (name, turning) in
        [("klimchik-2017.toml", Turning::WithTool), ("klimchik-2017-table-compatible.toml", Turning::AgainstTool)]
    {
        let run = read_assessment(&root().join("configs").join(name)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((run.comparison.robots.len(), run.comparison.benchmark.turning), (5, turning));
        let published = run.published.unwrap().figures;
        // 5 robots x 2 elbows x (3 + 3 of Table 5, 4 of Table 6, 4 of Table 7).
        assert_eq!(published.readings.len(), 140);
        let dashes = published.readings.iter().filter(|reading| reading.value.is_none()).count();
        assert_eq!(dashes, 5 + 5 + 1);
        assert_eq!(published.value("KUKA KR 500", Elbow::Down, Load::Test, Quantity::Minimum), Some(Some(0.41 / 1e3)));
        assert_eq!(
            published.value("KUKA KR 360 L240", Elbow::Up, Load::Rated, Quantity::Minimum),
            Some(Some(3.34 / 1e3))
        );
        assert_eq!(published.value("KUKA KR 500", Elbow::Up, Load::Test, Quantity::MiddleZone(0.5)), Some(None));
        assert_eq!(published.value("KUKA KR 500", Elbow::Up, Load::Test, Quantity::MiddleZone(0.3)), None);
        assert_eq!(published.accuracies.iter().filter(|(_, _, value)| value.is_some()).count(), 25);
        assert_eq!(
            published.robots(0.2e-3, 1000.0),
            ["KUKA KR 100 HA", "KUKA KR 270 R2700", "KUKA KR 360 L240", "KUKA KR 500"]
        );
        assert_eq!(run.inputs.len(), 7);
    }
}

#[test]
fn each_broken_rule_names_line_field_value_and_what_is_allowed() {
    let computed = TEXT.replace("force_n = [-440, -1370, -635]\n", "").replace("[map]", MILLING);
    for (text, parts) in [
        (
            TEXT.replace("'two.toml'", "'one.toml'"),
            [":1: robots[2]: ", "second robot called 'KUKA KR270-2'", "found 'one.toml'"],
        ),
        (TEXT.replace("'two.toml'", "'three.toml'"), [":1: robots[2]: ", "cannot be read", "found 'three.toml'"]),
        (TEXT.replace("['one.toml', 'two.toml']", "[]"), [":1: robots: ", "empty", "found []"]),
        (TEXT.replace("100\nforce", "0\nforce"), [":3: benchmark.radius_mm: ", "from 0.001", "found 0;"]),
        (
            TEXT.replace("[-440, -1370, -635]", "[0, 0, -635]"),
            [":4: benchmark.force_n: ", "no force in the plane", "found [0, 0, -635]"],
        ),
        (TEXT.replace("[-440, -1370, -635]", "[nan, 1, 1]"), [":4: benchmark.force_n[1]: ", "finite", "found nan"]),
        (TEXT.replace("radius", "radios"), [":3: benchmark.radios_mm: ", "nearest known one: radius_mm", "found 100"]),
        (
            TEXT.replace("force_n = [-4", "points = 7\nforce_n = [-4"),
            [":4: benchmark.points: ", "from 8 to 100000", "found 7;"],
        ),
        (
            TEXT.replace("force_n = [-4", "tool_axis = [0, 0, 2]\nforce_n = [-4"),
            [":4: benchmark.tool_axis: ", "length 2.0000", "found [0, 0, 2]"],
        ),
        (TEXT.replace("step_mm = 100", "step_mm = 0.1"), [":8: map.step_mm: ", "20009001 places", "at most 4000000"]),
        (TEXT.replace("[500, 1000]", "[1000, 500]"), [":6: map.x_mm: ", "lower end above", "found [1000, 500]"]),
        (TEXT.replace("[100, 400]", "[100, 500]"), [":10: zones.sides_mm[2]: ", "larger than the map", "found 500;"]),
        (TEXT.replace("[100, 400]", "[150]"), [":10: zones.sides_mm[1]: ", "multiple of the step", "found 150;"]),
        (
            TEXT.replace("radius_mm = 100", "radius_mm = 100\ntraced = 'wrist-centre'")
                + "[spindle]\nxyz_mm = [0, 0, 1]\nrotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n",
            [":4: benchmark.traced: ", "leaves out the spindle", "found 'wrist-centre'"],
        ),
        (TEXT.replace("[100, 400]", "[100, 100]"), [":10: zones.sides_mm[2]: ", "twice", "found 100;"]),
        (TEXT.replace("[0.2]", "[0.2, 0.1]"), [":12: selection.accuracies_mm: ", "ascending", "found [0.2, 0.1]"]),
        (TEXT.replace("-635]", "1e300]"), [":4: benchmark.force_n[3]: ", "to 1e7", "found 1e300"]),
        (
            TEXT.replace("[-440, -1370, -635]", "[1e-300, 0, 0]"),
            [":4: benchmark.force_n: ", "no force", "found [1e-300"],
        ),
        (TEXT.replace("[0.2]", "[0]"), [":12: selection.accuracies_mm[1]: ", "above 0", "found 0;"]),
        (
            TEXT.replace("[0.2]", "[0.2]\nremaining_share = 2"),
            [":13: selection.remaining_share: ", "not above 1", "found 2;"],
        ),
        (
            TEXT.replace("[map]", "[plane]\nx = [1, 0, 0]\ny = [1, 0, 0]\n[map]"),
            [":7: plane.y: ", "not normal to x", "found [1, 0, 0]"],
        ),
        (
            TEXT.replace("[map]", "[stiffness]\njoints = [2, 7]\n[map]"),
            [":6: stiffness.joints[2]: ", "from 1 to 6", "found 7;"],
        ),
        (
            TEXT.replace("[map]", "[stiffness]\njoints = [2, 2]\n[map]"),
            [":6: stiffness.joints[2]: ", "twice", "found 2;"],
        ),
        (
            TEXT.replace("[map]", "[stiffness]\nrange_share = 1.5\n[map]"),
            [":6: stiffness.range_share: ", "from 0 to 1", "found 1.5;"],
        ),
        (TEXT.replace("[map]", "[load]\nrated_share = 0\n[map]"), [":6: load.rated_share: ", "above 0", "found 0;"]),
        (TEXT.replace("[map]", MILLING), [":4: benchmark.force_n: ", "beside a table [tool]", "found [-440"]),
        (
            computed.replace("radius_mm = 100", "radius_mm = 100\ntool_axis = [0, 0, 1]"),
            [":4: benchmark.tool_axis: ", "normal of the plane", "found [0, 0, 1]"],
        ),
        (TEXT.replace("[map]", "[reference]\ntables = 'one.toml'\n[map]"), ["one.toml:", "unknown key", "sides_mm"]),
    ] {
        let message = read(&text).unwrap_err().to_string();
        for part in parts.iter().chain(&["; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}

#[test]
fn published_rows_may_not_be_longer_than_their_heads() {
    let folder = folder();
    let file = folder.path().join("tables.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replacen("optimal_mm = [1.60, 1.73, 2.24]", "optimal_mm = [1, 2, 3, 4, 5]", 1)).unwrap();
    let comparison = folder.path().join("study.toml");
    std::fs::write(&comparison, TEXT.replace("[map]", "[reference]\ntables = 'tables.toml'\n[map]")).unwrap();
    let message = read_assessment(&comparison).unwrap_err().to_string();
    for part in ["tables.toml:", "robots[1].up.optimal_mm: ", "5 numbers under 4 heads", "found [1, 2, 3, 4, 5]"] {
        assert!(message.contains(part), "{part} in {message}");
    }
}
