//! Long tool paths to try the placement job on: a five-axis freeform patch, a raster and a wall trim, each with a run
//! file.
//!
//! `cargo run --release -p stead-experiments --bin long-paths -- DIR ROBOTS` writes `freeform-3000`, `raster-2000`,
//! `trim-1132`, `freeform-50000` and `raster-50000` (`.csv` and `.toml`) into the folder DIR; ROBOTS is the folder with
//! the robot files as DIR sees it, by default `../configs/robots`. Then `stead place DIR/freeform-3000.toml`.
//!
//! The freeform patch of 0.6 m tilts the tool by 0 to 30 deg; the raster is upright; the trim follows an opening with
//! round corners in an upright panel, in one segment, with a horizontal tool. All forces turn with the feed and vary by
//! a factor of 2.

#![allow(clippy::print_stdout, reason = "an experiment prints")]

use nalgebra::Vector3;
use std::env;
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// A point: its segment, position (mm), feed and tool axis.
type Point = (usize, Vector3<f64>, Vector3<f64>, Vector3<f64>);

/// Height of the patch. mm
const HEIGHT: f64 = 110.0;
/// Half its width. mm
const HALF: f64 = 300.0;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let folder = arguments.first().ok_or("usage: long-paths DIR [ROBOTS]")?;
    let robots = arguments.get(1).map_or("../configs/robots", String::as_str);
    fs::create_dir_all(folder)?;
    let cell = "x_mm = [900.0, 1900.0]\ny_mm = [-800.0, 800.0]\nz_mm = [-400.0, 400.0]\nq4 = [-1.0, 1.0]";
    for (name, robot, points) in [
        ("freeform-3000", "kuka-kr270-r2700", freeform(3000, 30)),
        ("raster-2000", "kuka-kr360-l240", raster(2000, 20)),
        ("trim-1132", "kuka-kr500", trim(1132)),
        ("freeform-50000", "kuka-kr270-r2700", freeform(50_000, 100)),
        ("raster-50000", "kuka-kr360-l240", raster(50_000, 100)),
    ] {
        let folder = Path::new(folder);
        fs::write(folder.join(format!("{name}.csv")), task(&points))?;
        let run = format!(
            "robot = \"{robots}/{robot}.toml\"\ntask = \"{name}.csv\"\n\n[spindle]\nxyz_mm = [0.0, -250.0, 150.0]\n\
             rotation = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]\n\n[cell]\n{cell}\n\n[constraints]\n\
             min_inverse_condition = 0.15\ncharacteristic_length_mm = 700.0\n\n[redundancy]\nbeta_step_deg = 5.0\n\
             feed_mm_per_s = 50.0\nmax_beta_rate_deg_per_mm = 1.0\n"
        );
        fs::write(folder.join(format!("{name}.toml")), run)?;
        println!("{name}: {} points", points.len());
    }
    Ok(())
}

/// Lines to and fro over a double-curved patch, the tool along its normal.
fn freeform(count: usize, lines: usize) -> Vec<Point> {
    let k = PI / (2.0 * HALF) * 1.0;
    let point = |line: usize, x: f64, y: f64, sign: f64| {
        let (sx, cx) = libm::sincos(k * x);
        let (sy, cy) = libm::sincos(k * y);
        let position = Vector3::new(x, y, HEIGHT * cx * cy);
        let along_x = Vector3::new(1.0, 0.0, -HEIGHT * k * sx * cy);
        let along_y = Vector3::new(0.0, 1.0, -HEIGHT * k * cx * sy);
        (line, position, (along_x * sign).normalize(), along_x.cross(&along_y).normalize())
    };
    to_and_fro(count, lines, point)
}

/// Lines to and fro over a level square, with an upright tool.
fn raster(count: usize, lines: usize) -> Vec<Point> {
    let point = |line, x, y, sign: f64| (line, Vector3::new(x, y, 0.0), Vector3::x() * sign, Vector3::z());
    to_and_fro(count, lines, point)
}

fn to_and_fro(count: usize, lines: usize, point: impl Fn(usize, f64, f64, f64) -> Point) -> Vec<Point> {
    let per_line = count / lines;
    (0..lines * per_line)
        .map(|i| {
            let (line, place) = (i / per_line, i % per_line);
            let sign = if line % 2 == 0 { 1.0 } else { -1.0 };
            let share = |k: usize, of: usize| 2.0 * HALF * (k as f64 / (of - 1) as f64 - 0.5);
            point(line + 1, sign * share(place, per_line), share(line, lines), sign)
        })
        .collect()
}

/// Round an opening of 600 x 400 mm with corners of 80 mm in a panel in the x-z plane; the spindle stands on the
/// panel's -y side.
fn trim(count: usize) -> Vec<Point> {
    let (width, height, radius) = (600.0, 400.0, 80.0);
    let (a, b) = (width - 2.0 * radius, height - 2.0 * radius);
    let arc = FRAC_PI_2 * radius;
    let whole = 2.0 * (a + b) + 4.0 * arc;
    let axis = -Vector3::y();
    (0..count)
        .map(|i| {
            let mut s = whole * i as f64 / count as f64;
            // Four sides, each with the corner after it; the corner of the opening's first side is at its lower right.
            let (mut corner, mut heading) = (Vector3::new(-a / 2.0, 0.0, -height / 2.0), 0.0_f64);
            for side in 0..4 {
                let length = if side % 2 == 0 { a } else { b };
                let forward = Vector3::new(libm::cos(heading), 0.0, libm::sin(heading));
                let left = Vector3::new(-libm::sin(heading), 0.0, libm::cos(heading));
                if s <= length {
                    return (1, corner + forward * s, forward, axis);
                }
                s -= length;
                corner += forward * length;
                if s <= arc {
                    let turn = s / radius;
                    let feed = forward * libm::cos(turn) + left * libm::sin(turn);
                    let position =
                        corner + forward * (radius * libm::sin(turn)) + left * (radius * (1.0 - libm::cos(turn)));
                    return (1, position, feed, axis);
                }
                s -= arc;
                corner += forward * radius + left * radius;
                heading += FRAC_PI_2;
            }
            (1, corner, Vector3::x(), axis)
        })
        .collect()
}

/// The task file: a force of 100 to 200 N against the feed and from the left, with some along the axis.
fn task(points: &[Point]) -> String {
    let mut text = String::from(
        "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,force_x_n,force_y_n,force_z_n\n",
    );
    let mut length = 0.0;
    for (i, (segment, position, feed, axis)) in points.iter().enumerate() {
        if let Some((_, before, ..)) = i.checked_sub(1).map(|before| &points[before]) {
            length += (position - before).norm();
        }
        let size = 150.0 + 50.0 * libm::sin(TAU * length / 900.0);
        let force = (-feed * 0.4 + axis.cross(feed) * 0.85 + axis * 0.34) * size;
        let _ = write!(text, "{segment}");
        for (digits, vector) in [(6, position), (12, feed), (12, axis), (6, &force)] {
            for k in 0..3 {
                let _ = write!(text, ",{:.*}", digits, vector[k]);
            }
        }
        text.push('\n');
    }
    text
}
