use super::*;
use std::f64::consts::TAU;
use std::path::PathBuf;
use stead_model::cutting::MillingDirection;
use stead_simulation::arm::Variant;
use stead_simulation::arm::testing::{spindle, start};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn shipped(name: &str) -> String {
    std::fs::read_to_string(root().join("configs").join(name)).unwrap()
}

/// What the shipped file says of the spindle's body.
const MASSES: &str = "\
mass_kg = 44.4                         # Table 4: spindle and its support, in the flange frame
centre_of_mass_mm = [-4.0, 0.0, 158.0]
inertia_kg_m2 = { xx = 0.095, yy = 0.106, zz = 0.098, xz = 0.035 }
";

/// Reads a text as a simulation file beside the shipped robots.
fn read(text: &str) -> Result<SimulationRun, InputError> {
    read_by(read_simulation, text)
}

fn read_by(
    reader: fn(&Path, &Overrides) -> Result<SimulationRun, InputError>,
    text: &str,
) -> Result<SimulationRun, InputError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("robots")).unwrap();
    for name in ["staubli-tx200.toml", "kuka-kr270-2.toml"] {
        let robot = root().join("configs/robots").join(name);
        std::fs::copy(robot, folder.path().join("robots").join(name)).unwrap();
    }
    let file = folder.path().join("run.toml");
    std::fs::write(&file, text).unwrap();
    reader(&file, &Overrides::default())
}

#[test]
fn the_shipped_files_are_the_published_passes() {
    let file = root().join("configs/umons-aluminium.toml");
    let run = read_simulation(&file, &Overrides::default()).unwrap();
    let (motors, _) = run.setup.motion.motors(0.0);
    for (found, expected) in motors.iter().zip(start()) {
        assert!((found - expected).abs() < 1e-12);
    }
    assert!((run.setup.motion.duration() - 1.85).abs() < 1e-6);
    assert!((run.setup.motion.start.rotation - spindle_pose()).amax() < 1e-9);
    assert_eq!(run.setup.spindle.payload, spindle().payload);
    assert_eq!((run.setup.variant, run.setup.damping_scale), (Variant::Springs, 1.0));
    assert_eq!(run.cut.section.direction, MillingDirection::Climb);
    assert!((run.cut.spindle_speed - 18700.0 / 60.0 * TAU).abs() < 1e-9);
    assert_eq!((run.cut.slices, run.cut.steps_per_turn, run.gap), (32, 360, 0.5e-3));
    let pitches: Vec<f64> = run.cutter.teeth().iter().map(|tooth| tooth.pitch.to_degrees().round()).collect();
    assert_eq!(pitches, [170.0, 190.0]);
    assert_eq!(run.cutter.coefficients().tangential, 661.553e6);
    assert_eq!(run.inputs.len(), 2);

    let other = Overrides { variant: Some(Variant::Backlash), damping_scale: Some(10.0), spindle_speed: Some(300.0) };
    let steel = read_simulation(&root().join("configs/umons-steel.toml"), &other).unwrap();
    assert_eq!((steel.setup.variant, steel.setup.damping_scale), (Variant::Backlash, 10.0));
    assert_eq!(steel.cut.spindle_speed, 300.0);
    assert!((steel.cutter.teeth()[0].radius - 5.006929e-3).abs() < 1e-15);
    assert!((steel.setup.motion.ramp.feed - 0.28 / 60.0).abs() < 1e-15);
}

/// The spindle's frame in the base frame at the start.
fn spindle_pose() -> nalgebra::Matrix3<f64> {
    use stead_simulation::arm::{Arm, testing::tx200};
    let arm = Arm::six(&tx200(), &spindle(), Variant::Springs, &start()).unwrap();
    arm.chain.at(&start().into()).base_from_tip.rotation
}

#[test]
fn optional_tables_override_the_defaults() {
    let more = "[stability]\nway_mm = 20\nlobes_rpm = [1000, 20000]\n\
                lobes_points = 10\nmax_depth_mm = 5\nfrequencies_hz = [0, 100]\n";
    let text = format!("{}{more}", shipped("umons-aluminium.toml"))
        .replace("variant = \"springs\"", "damping_scale = 2")
        .replace("# slices = 32", "slices = 8")
        .replace("# steps_per_turn = 360", "steps_per_turn = 90\nwall_height_mm = 1.2\ncutoff_mm = 0.8");
    let run = read(&text).unwrap();
    assert_eq!((run.cut.slices, run.cut.steps_per_turn, run.setup.damping_scale), (8, 90, 2.0));
    assert_eq!(
        (run.evaluation.height, run.evaluation.cutoff, run.evaluation.window),
        (1.2e-3, 0.8e-3, Some([0.4, 1.4]))
    );
    // The figures of the variant that is run, which is the first where none is named.
    let published = run.published.unwrap().figures;
    assert_eq!(published.forces.unwrap()[1].min, -111.39);
    assert_eq!(published.roughness.unwrap().total, 13.5e-6);
    assert_eq!((run.analysis.distance, run.analysis.points, run.analysis.max_depth), (0.02, 10, 0.005));
    assert_eq!(run.analysis.frequencies, [0.0, 100.0]);
    assert!((run.analysis.speeds[1] - 20000.0 / 60.0 * TAU).abs() < 1e-9);
}

/// Also with runout, which makes the mean radius another than half the diameter.
#[test]
fn a_cut_of_the_whole_diameter_is_a_slot() {
    let text = shipped("umons-aluminium.toml").replace("radial_depth_mm = 4.0", "radial_depth_mm = 10.0");
    for runout in ["[0, 0]", "[6.929, 0.0]", "[-6.929, 0.0]"] {
        let run = read(&text.replace("teeth = 2", &format!("teeth = 2\nrunout_um = {runout}"))).unwrap();
        assert!(run.cut.section.is_slot(&run.cutter), "{runout}");
    }
    let run =
        read(&text.replace("= 10.0\naxial", "= 9.9\naxial").replace("teeth = 2", "teeth = 2\nrunout_um = [7, 0]"))
            .unwrap();
    assert!(!run.cut.section.is_slot(&run.cutter) && run.cut.section.radial_depth == 9.9e-3);
}

/// A stability analysis makes no steps, so that a slow pass and a slow spindle are none of its business.
#[test]
fn a_stability_analysis_does_not_ask_for_steps() {
    let text = shipped("umons-aluminium.toml").replace("window_s", "# window_s");
    for (from, to) in [("= 3700.0 ", "= 0.1 "), ("spindle_rpm = 18700.0", "spindle_rpm = 50.0")] {
        let text = text.replacen(from, to, 1);
        assert!(read(&text).is_err());
        assert!(read_by(read_stability, &text).is_ok());
    }
}

#[test]
fn each_broken_rule_names_line_field_value_and_what_is_allowed() {
    let text = shipped("umons-aluminium.toml");
    for (from, to, parts) in [
        ("\"springs\"", "\"soft\"", [": variant: ", "found \"soft\"", "\"backlash\""]),
        ("staubli-tx200", "kuka-kr270-2", ["kuka-kr270-2.toml:", "joints[1].mass_kg: is missing", "damping_nms"]),
        ("# damping_scale = 1.0", "damping_scale = -1", [": damping_scale: ", "found -1", "from 0"]),
        ("mass_kg = 44.4", "mass_kg = 0", [": spindle.mass_kg: ", "found 0", "above 0"]),
        ("mass_kg = 44.4", "# none", [": spindle.mass_kg: ", "missing", "above 0"]),
        (
            MASSES,
            "",
            [": spindle.mass_kg: ", "is missing: how the arm moves", "mass_kg, centre_of_mass_mm and inertia_kg"],
        ),
        ("= 3700.0 ", "= 0.1 ", [": pass.feed_mm_per_min: ", "steps", "found 0.1"]),
        ("yy = 0.106", "yy = 0.4", [": spindle.inertia_kg_m2: ", "triangle", "found { xx"]),
        ("-11.71", "nan", [": pass.start_joints_deg[1]: ", "found nan", "six finite numbers"]),
        ("-11.71", "400", [": pass.start_joints_deg: ", "joint 1 would stand at 400", "posture of its start"]),
        ("[1.0, 0.0, 0.0]", "[0, 0, 0]", [": pass.feed_direction: ", "no direction", "found [0, 0, 0]"]),
        ("[1.0, 0.0, 0.0]", "[1, 0, 0.1]", [": pass.feed_direction: ", "5.7", "found [1, 0, 0.1]"]),
        ("length_mm = 107.9167", "length_mm = 3000", [": pass.length_mm: ", "joint 3 would stand", "found 3000"]),
        ("ramp_s = 0.2", "ramp_s = -0.2", [": pass.ramp_s: ", "found -0.2", "from 0 to 10"]),
        ("3700.0", "0", [": pass.feed_mm_per_min: ", "found 0", "above 0"]),
        ("gap_mm = 0.5", "gap_mm = -0.5", [": work.gap_mm: ", "found -0.5", "not below 0"]),
        ("[170.0, 190.0]", "[170.0, 180.0]", [": tool.pitch_deg: ", "found [170.0, 180.0]", "350"]),
        ("[170.0, 190.0]", "[120, 120, 120]", [": tool.pitch_deg: ", "3 numbers for 2 teeth", "one for each"]),
        ("radial_depth_mm = 4.0", "radial_depth_mm = 10.5", [": cut.radial_depth_mm: ", "wider", "= 10"]),
        ("axial_depth_mm = 1.6", "axial_depth_mm = 23", [": cut.axial_depth_mm: ", "flutes", "= 22"]),
        ("kt_mpa = 661.553", "kt_mpa = -1", [": tool.kt_mpa: ", "found -1", "above 0"]),
        ("\"climb\"", "\"down\"", [": cut.milling: ", "found \"down\"", "\"climb\""]),
        ("spindle_rpm = 18700.0", "spindle_rpm = 0", [": cut.spindle_rpm: ", "found 0", "above 0"]),
        ("helix_deg = 30.0", "helix = 30.0", [": tool.helix: ", "nearest known one: helix_deg", "30.0"]),
        ("# steps_per_turn = 360", "steps_per_turn = 4", [": tool.pitch_deg: ", "4 steps", "at least"]),
        ("# [stability]", "[stability]\nway_mm = 200", [": stability.way_mm: ", "found 200", "107.9"]),
        ("# [stability]", "[stability]\nlobes_rpm = [9, 9]", [": stability.lobes_rpm: ", "no width", "below the"]),
        ("# [stability]", "[stability]\nmax_depth_mm = 30", [": stability.max_depth_mm: ", "found 30", "= 22"]),
    ] {
        assert!(text.contains(from), "{from}");
        let message = read(&text.replacen(from, to, 1)).unwrap_err().to_string();
        for part in parts.iter().chain(&[".toml:", "; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}
