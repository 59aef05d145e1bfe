//! The robot file of an imported arm.

use super::read::Urdf;
use super::rows::written;
use super::stiffness::Borrowed;
use super::xml::{one_line, quoted};
use super::{ImportedRobot, POSTURES};
use nalgebra::{Matrix3, Vector3};
use std::fmt::Write;
use stead_model::robot::{ControllerKind, Inertial, Pose};
use toml::Value;

/// Lines of a text; writing to it cannot fail.
struct Lines(String);

impl Lines {
    fn line(&mut self, line: impl std::fmt::Display) {
        let _ = writeln!(self.0, "{line}");
    }
}

/// The text of the robot file; `digest` is the SHA-256 digest of the URDF.
pub(super) fn text(robot: &ImportedRobot, urdf: &Urdf, digest: &str, borrowed: Option<&Borrowed>) -> String {
    let mut lines = Lines(String::new());
    let file = urdf.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    head(&mut lines, robot, &quoted(&file), digest);
    about_stiffness(&mut lines, borrowed);
    lines.line("");
    lines.line(format_args!("name = {}", Value::from(robot.name.clone())));
    lines.line(format_args!("source = {}", Value::from(source(&file, borrowed))));
    if let Some(borrowed) = borrowed {
        lines.line(format_args!("stiffness_like = {}", Value::from(one_line(&borrowed.arm))));
        if let Some(model) = borrowed.model {
            lines.line(format_args!("stiffness_model = {}", Value::from(model.word())));
        }
    }
    for k in 0..6 {
        joint(&mut lines, robot, k, borrowed);
    }
    linkage(&mut lines, robot);
    controller(&mut lines, robot);
    lines.0
}

/// Where the numbers come from, on one line.
fn source(file: &str, borrowed: Option<&Borrowed>) -> String {
    let mut source = format!("geometry, limits, speeds: URDF {file}");
    if let Some(borrowed) = borrowed {
        let _ = write!(source, "; stiffness: that of another arm, {} ({})", borrowed.arm, borrowed.source);
    }
    one_line(&source)
}

fn head(lines: &mut Lines, robot: &ImportedRobot, file: &str, digest: &str) {
    let (base, tip) = (quoted(&robot.base_link), quoted(&robot.tip_link));
    lines.line(format_args!("# Imported by `stead import robot` from {file}, SHA-256"));
    lines.line(format_args!("# {digest}. Six rows, base first."));
    lines.line("#");
    lines.line(format_args!(
        "# Geometry: modified Denavit-Hartenberg rows derived from the joints between link {base} and link {tip}."
    ));
    lines.line(format_args!(
        "# Over {POSTURES} random postures within the limits they give the pose of that link as the URDF does, to"
    ));
    let deviation = robot.deviation;
    lines.line(format_args!(
        "# {:.1e} mm and {:.1e} deg. Angles of the rows by those of the URDF:",
        deviation.position_mm, deviation.angle_deg
    ));
    for k in 0..6 {
        lines.line(format_args!("#   {}", robot.angle(k)));
    }
    lines.line(format_args!(
        "# The base frame of the rows in link {base}, mm: {}",
        millimetres(&robot.link_from_base.translation)
    ));
    let placed = &robot.flange_from_tip;
    lines.line(format_args!(
        "# Link {tip} in the frame of the last row (the flange frame of stead), mm: {}",
        millimetres(&placed.translation)
    ));
    if (placed.rotation - Matrix3::identity()).norm() > 1e-9 {
        let row = |k: usize| numbers(&[0, 1, 2].map(|column| placed.rotation[(k, column)]), 1e12);
        lines.line(format_args!("# turned by [{}, {}, {}]", row(0), row(1), row(2)));
    }
    lines.line("# Limits and speeds: those of the URDF. Accelerations and jerks are not in a URDF (max_acceleration_deg_per_s2,");
    lines.line("# max_jerk_deg_per_s3); the rated load (payload_kg) is on the data sheet.");
    if robot.bodies.is_some() {
        lines.line("# Masses, centres and inertias: those of the URDF in the frames of the rows; the last has all that is fixed to it. A URDF");
        lines.line(
            "# has no damping of the drives: put it in and take the # away for `stead simulate` and `stead stability`.",
        );
    }
}

fn about_stiffness(lines: &mut Lines, borrowed: Option<&Borrowed>) {
    lines.line("#");
    match borrowed {
        Some(borrowed) => {
            lines.line(format_args!("# Stiffness: NOT of this arm, but of {}.", one_line(&borrowed.arm)));
            lines.line(format_args!("# Its source: {}", one_line(&borrowed.source)));
            lines.line("# Such values rank placements of arms of that class; they do not predict millimetres. Measure the arm to do that:");
            lines.line("# `stead identify plan` says what to measure.");
        }
        None => {
            lines.line("# Stiffness: not in a URDF, and not published by robot makers. Until the six lines are filled in, commands that need it");
            lines.line("# refuse this file. Measure it (`stead identify plan` starts from values of about the right size), or import again with");
            lines.line("# --stiffness-like and a shipped arm of the class, whose values rank placements and do not predict millimetres.");
        }
    }
}

fn joint(lines: &mut Lines, robot: &ImportedRobot, k: usize, borrowed: Option<&Borrowed>) {
    let (row, [min, max]) = (&robot.rows[k], robot.limits_deg[k]);
    lines.line(format_args!("\n[[joints]]                             # {}", one_line(&robot.joints[k])));
    lines.line(format_args!("alpha_deg = {:?}", row.alpha_deg));
    lines.line(format_args!("a_mm = {:?}", row.a_mm));
    lines.line(format_args!("d_mm = {:?}", row.d_mm));
    lines.line(format_args!("min_deg = {min:?}"));
    lines.line(format_args!("max_deg = {max:?}"));
    if let Some(speed) = robot.max_speed_deg_per_s[k] {
        lines.line(format_args!("max_speed_deg_per_s = {speed:?}"));
    }
    match borrowed {
        Some(borrowed) => lines.line(&borrowed.lines[k]),
        None => lines.line("# stiffness_mnm_per_rad = ?"),
    }
    if let Some(bodies) = &robot.bodies {
        body(lines, &bodies[k]);
    }
}

fn body(lines: &mut Lines, body: &Inertial) {
    let inertia = body.inertia();
    let entry = |row: usize, column: usize| rounded(inertia[(row, column)], 1e9);
    lines.line(format_args!("# mass_kg = {:?}", rounded(body.mass(), 1e9)));
    lines.line(format_args!("# centre_of_mass_mm = {}", numbers((body.centre() * 1e3).as_ref(), 1e6)));
    let [xx, yy, zz] = [0, 1, 2].map(|k| entry(k, k));
    let [xy, xz, yz] = [entry(0, 1), entry(0, 2), entry(1, 2)];
    lines.line(format_args!(
        "# inertia_kg_m2 = {{ xx = {xx:?}, yy = {yy:?}, zz = {zz:?}, xy = {xy:?}, xz = {xz:?}, yz = {yz:?} }}"
    ));
    lines.line("# damping_nms_per_rad = ?");
}

fn linkage(lines: &mut Lines, robot: &ImportedRobot) {
    let Some([min, max]) = robot.linkage_sums_deg else { return };
    lines.line("\n# A parallelogram drives axis 3: passive joints of the URDF follow joint 3. How far theta_2 + theta_3 goes is not in a");
    lines.line("# URDF: these are what the ranges of joints 2 and 3 allow. The data sheet says more: the range of axis 3 there is one of");
    lines.line("# the sum where the controller counts axis 3 against the horizontal.");
    lines.line("[axes_2_3]");
    lines.line("linkage = true");
    lines.line(format_args!("sum_min_deg = {min:?}"));
    lines.line(format_args!("sum_max_deg = {max:?}"));
}

fn controller(lines: &mut Lines, robot: &ImportedRobot) {
    let kind = robot.controller.map_or(ControllerKind::Kuka, |controller| controller.kind);
    let shown = robot.controller.unwrap_or_else(|| robot.controller_of_urdf(kind));
    lines.line(
        "\n# How the controller counts its angles, theta_i = sign_i A_i + offset_i, and where its robot root is.",
    );
    let key = match robot.controller {
        Some(_) => {
            lines.line("# They agree with the pose of --home-deg, which was read at the controller.");
            ""
        }
        None => {
            lines.line("# The numbers are right if the zero of the URDF is that of the controller and its root is the base link, which a URDF");
            lines.line("# does not say: give a pose read at the teach pendant (--home-deg), or compare one (stead pose) before use.");
            "# "
        }
    };
    let kinds =
        if robot.controller.is_some() { "" } else { "                        # or \"abb\", \"fanuc\", \"staubli\"" };
    lines.line(format_args!("{key}[controller]"));
    lines.line(format_args!("{key}kind = \"{}\"{kinds}", kind.word()));
    lines.line(format_args!("{key}sign = [{}]", shown.sign.map(|sign| format!("{sign}")).join(", ")));
    let offset = shown.offset.map(|offset| format!("{:?}", rounded(offset.to_degrees(), 1e9)));
    lines.line(format_args!("{key}offset_deg = [{}]", offset.join(", ")));
    if robot.controller.is_some()
        && (shown.is_level() || kind == ControllerKind::Fanuc || robot.linkage_sums_deg.is_some())
    {
        lines.line(format_args!("{key}is_j3_level = {}", shown.is_level()));
    } else if robot.linkage_sums_deg.is_some() {
        lines.line(format_args!(
            "{key}is_j3_level = true                 # or false: whether A3 is counted against the horizontal"
        ));
    }
    let root = shown.root_from_base.unwrap_or_else(Pose::identity).translation;
    lines.line(format_args!("{key}[root]"));
    lines.line(format_args!("{key}xyz_mm = {}", millimetres(&root)));
    lines.line(format_args!("{key}abc_deg = [0.0, 0.0, 0.0]"));
}

fn millimetres(point: &Vector3<f64>) -> String {
    let [x, y, z] = [point.x, point.y, point.z].map(|value| written(value * 1e3));
    format!("[{x:?}, {y:?}, {z:?}]")
}

fn numbers(values: &[f64; 3], scale: f64) -> String {
    let [x, y, z] = values.map(|value| rounded(value, scale));
    format!("[{x:?}, {y:?}, {z:?}]")
}

fn rounded(value: f64, scale: f64) -> f64 {
    (value * scale).round() / scale + 0.0
}
