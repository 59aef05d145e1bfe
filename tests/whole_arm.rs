//! An arm of which everything yields, from outside: `place` scores it, `compensate` finds the same deflection in its
//! exact equilibrium and corrects it, however the arm is mounted, moved and turned.

use crate::common::{Bench, Ended};
use nalgebra::Vector3;
use serde_json::Value;

const RUN: &str = "configs/whole.toml";
const FULL: &str = "configs/robots/kuka-kr210-2-full.toml";
const COMPENSATE: &str = "configs/compensate-whole.toml";

const MASS: &str = "mass_kg = 61.0\ncentre_of_mass_mm = [0.0, 0.0, 250.0]\n";
/// Mount and tip of the spindle.
const MATRICES: &str = "\
mount_matrix = [[0.03, 0, 0, 0, 0.05, 0], [0, 0.03, 0, -0.05, 0, 0], [0, 0, 0.01, 0, 0, 0], \
[0, -0.05, 0, 0.4, 0, 0], [0.05, 0, 0, 0, 0.4, 0], [0, 0, 0, 0, 0, 0.2]]
tip_um_per_n = [[0.1, 0, 0], [0, 0.12, 0], [0, 0, 0.02]]
";
const BASE: &str = "
[base_compliance]
point_mm = [0, 0, 0]
matrix = [[0.02, 0, 0, 0, 0.01, 0], [0, 0.02, 0, -0.01, 0, 0], [0, 0, 0.01, 0, 0, 0], \
[0, -0.01, 0, 0.06, 0, 0], [0.01, 0, 0, 0, 0.06, 0], [0, 0, 0, 0, 0, 0.05]]

[part_compliance]
um_per_n = [[0.5, 0.1, 0], [0.1, 0.25, 0], [0, 0, 0.4]]
";

/// A bench with the run of the guide's page on the whole arm, everything of it yielding, and a small search.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.copy("configs/whole-arm.toml", RUN);
    bench.copy_all(&[FULL]);
    bench.replace(RUN, "population = 120\ngenerations = 51", "population = 24\ngenerations = 4\nbasins = 1");
    bench.replace(RUN, "beta_step_deg = 3.0", "beta_step_deg = 6.0");
    // Room for the corrections, which the limits of the joints would not leave.
    bench.replace(RUN, "[constraints]", "[constraints]\njoint_margin_deg = 1.0");
    bench.replace(RUN, "\n[cell]", &format!("{MASS}{MATRICES}{BASE}\n[cell]"));
    bench.write(COMPENSATE, "run = \"whole.toml\"\nplan = \"../placed/best.csv\"\n");
    bench
}

fn number(document: &Value, pointer: &str) -> f64 {
    document.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} in {document}"))
}

/// The deflections before a correction. mm
fn before(bench: &Bench, name: &str) -> Vec<Vector3<f64>> {
    let text = bench.read(name);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|column| column == name).unwrap();
    let columns = ["before_x_mm", "before_y_mm", "before_z_mm"].map(column);
    let row = |row: csv::StringRecord| Vector3::from(columns.map(|column| row[column].parse().unwrap()));
    reader.records().map(|found| row(found.unwrap())).collect()
}

fn done(ended: Ended) -> Value {
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.json()
}

/// Places, and corrects the best plan without and with the weight.
fn placed_and_corrected(bench: &Bench) {
    let placed = done(bench.stead(&["place", RUN, "--no-worst", "--out", "placed", "--json"]));
    let best = &placed["cases"][0];
    let parts = ["axes_mm", "normal_mm", "base_mm", "mount_mm", "tip_mm", "part_mm"];
    assert!(parts.iter().all(|part| number(best, &format!("/by_origin_mm/{part}")).abs() > 1e-5), "{best}");
    let corrected = done(bench.stead(&["compensate", COMPENSATE, "--out", "light", "--json"]));
    let [scored, found] = [number(best, "/deflection_mm/total/mean"), number(&corrected, "/before/mean_mm")];
    assert!((found / scored - 1.0).abs() < 0.005 && scored > 0.1, "{found} {scored}");
    assert!(number(&corrected, "/after/max_mm") <= 1.0001e-6 && corrected["gravity"].is_null());
    let note = "the weight of the 61.0 kg on the flange is not corrected";
    assert!(corrected["notes"].to_string().contains(note), "{}", corrected["notes"]);

    bench.write(COMPENSATE, &format!("{}[compensation]\ngravity = true\n", bench.read(COMPENSATE)));
    let heavy = done(bench.stead(&["compensate", COMPENSATE, "--out", "heavy", "--json"]));
    assert!(number(&heavy, "/after/max_mm") <= 1.0001e-6 && heavy["gravity"] == true);
    assert!(heavy["notes"].to_string().contains("do not touch the program up at the machine as well"));
    let sag: Vec<Vector3<f64>> = before(bench, "heavy/corrected-path.csv")
        .iter()
        .zip(before(bench, "light/corrected-path.csv"))
        .map(|(heavy, light)| heavy - light)
        .collect();
    let sizes = || sag.iter().map(|sag| sag.norm());
    let spread = sag.iter().flat_map(|a| sag.iter().map(move |b| (a - b).norm())).fold(0.0, f64::max);
    for (key, found) in [
        ("least_mm", sizes().fold(f64::INFINITY, f64::min)),
        ("largest_mm", sizes().fold(0.0, f64::max)),
        ("spread_mm", spread),
    ] {
        let stated = number(best, &format!("/sag_mm/{key}"));
        assert!((found / stated - 1.0).abs() < 0.02 && stated > 0.02, "{key} {found} {stated}");
    }
    assert_eq!(best["sag_mm"]["segments"].as_array().unwrap().len(), 5);
}

#[test]
fn everything_that_yields_is_placed_and_corrected() {
    let bench = bench();
    placed_and_corrected(&bench);
    let score = done(bench.stead(&["score", RUN, "--placement-of", "placed", "--case", "1", "--json"]));
    assert!(number(&score, "/best/sag_mm/spread_mm") > 0.02 && number(&score, "/worst/sag_mm/spread_mm") > 0.02);
    // On the arm about its axes, and back: what a plan of another set leaves is told.
    let text = bench.read(FULL).replace("stiffness_model = \"full\"", "stiffness_model = \"axes\"");
    let axes: Vec<&str> =
        text.lines().filter(|line| !line.starts_with("orthogonal") && !line.starts_with("bearing")).collect();
    bench.write("axes.toml", &axes.join("\n"));
    let other = bench.stead(&["compensate", COMPENSATE, "--reality", "axes.toml", "--out", "other", "--json"]);
    other.assert_says(&["stands on the base of the run ([base_compliance])"]);
    assert!(number(&done(other), "/after/mean_mm") > 0.05);
}

#[test]
fn a_whole_arm_on_a_rail_is_placed_and_corrected() {
    let bench = bench();
    let rail = "[[external_axis]]\nname = \"rail\"\nkind = \"rail\"\ncarries = \"robot\"\ndirection = [1.0, 0.0, 0.0]\n\
                range_mm = [-300.0, 300.0]\nspeed_mm_per_s = 500.0\nuse = \"fixed\"\n";
    bench.replace(RUN, "\n[constraints]", &format!("\n{rail}\n[constraints]"));
    placed_and_corrected(&bench);
}

#[test]
fn a_whole_arm_under_the_ceiling_with_tilted_tools_is_placed_and_corrected() {
    let bench = bench();
    let mount = "[mount]\nxyz_mm = [0.0, 0.0, 2600.0]\nabc_deg = [0.0, 0.0, 180.0]\n";
    bench.replace(RUN, "\n[cell]", &format!("\n{mount}\n[cell]"));
    // Six degrees about x.
    let task = bench.read("tasks/five-segments.csv").replace(",0,0,1,", ",0,-0.10452846,0.99452190,");
    bench.write("tasks/five-segments.csv", &task);
    placed_and_corrected(&bench);
}

#[test]
fn a_weight_that_is_not_known_is_not_corrected() {
    let bench = Bench::new();
    bench.copy("results/caro-2013/best.csv", "plan/best.csv");
    bench
        .write("configs/c.toml", "run = \"run.toml\"\nplan = \"../plan/best.csv\"\n\n[compensation]\ngravity = true\n");
    let ended = bench.stead(&["compensate", "configs/c.toml"]);
    assert_eq!(ended.code, Some(2));
    ended.assert_says(&[
        "configs/c.toml:5: compensation.gravity: asks for the weight, but the run does not state what the flange carries",
        ", found true; allowed: mass_kg and centre_of_mass_mm in [spindle] of the run file, or false",
    ]);
    // A mass without its centre is none, and motion needs the inertia too.
    bench.replace("configs/run.toml", "[spindle]", "[spindle]\nmass_kg = 61.0");
    let ended = bench.stead(&["check", "configs/run.toml"]);
    assert_eq!(ended.code, Some(2));
    ended.assert_says(&["spindle.centre_of_mass_mm: "]);
}
