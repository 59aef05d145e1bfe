//! What looks like a wrong unit or sign is noted and never refused; what no machine has is refused.

use crate::common::{Bench, RUN};

const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";
const TASK: &str = "tasks/five-segments.csv";
const TX200: &str = "configs/robots/staubli-tx200.toml";
const STEEL: &str = "configs/umons-steel.toml";
const PLACE: [&str; 8] = ["--x-mm", "2.2", "--y-mm", "-1643.5", "--z-mm", "-556.4", "--q4", "0.9258"];

/// The task with every place and force multiplied.
fn scale_task(bench: &Bench, places: f64, forces: f64) {
    let scaled = |(number, line): (usize, &str)| {
        let field = |(column, text): (usize, &str)| match (number, column) {
            (1.., 1..=3) => (text.parse::<f64>().unwrap() * places).to_string(),
            (1.., 10..) => (text.parse::<f64>().unwrap() * forces).to_string(),
            _ => text.to_owned(),
        };
        line.split(',').enumerate().map(field).collect::<Vec<_>>().join(",") + "\n"
    };
    bench.write(TASK, &bench.read(TASK).lines().enumerate().map(scaled).collect::<String>());
}

/// What makes an input look wrong.
type Change = fn(&Bench);

#[test]
fn inputs_that_look_wrong_are_noted_and_computed_all_the_same() {
    let cases: [(Change, &str); 19] = [
        (
            |bench| {
                bench.replace(ROBOT, "= 3.32", "= 332e3");
            },
            "joint 2 with 332000 MN m/rad is a hundred times stiffer",
        ),
        (
            |bench| {
                bench.replace(RUN, "684.0]", "0.684]");
            },
            "the tool centre point is 0.684 mm from the flange",
        ),
        (
            |bench| {
                bench.replace(RUN, "684.0]", "-684.0]");
            },
            "the tool points from its centre point back to the flange",
        ),
        (|bench| scale_task(bench, 1e-3, 1.0), "the tool path is no wider than "),
        (|bench| scale_task(bench, 1.0, 2e3), "forces go up to "),
        (|bench| scale_task(bench, 1.0, 1e-4), "forces go up to 0."),
        (|bench| scale_task(bench, 1.0, 0.0), "all forces are zero"),
        (
            |bench| {
                bench.replace(RUN, "feed_mm_per_s = ", "feed_mm_per_s = 1200.0 # ");
            },
            "feeds go up to 1200 mm/s: are they in mm/s, not mm/min?",
        ),
        (
            |bench| {
                bench.replace(RUN, "characteristic_length_mm = ", "characteristic_length_mm = 0.682 # ");
            },
            "constraints.characteristic_length_mm is 0.682: is it in mm?",
        ),
        (
            |bench| {
                let text = bench.read(TASK);
                let turned = text.lines().map(|line| {
                    let fields: Vec<&str> = line.split(',').collect();
                    let flipped = |(k, field): (usize, &&str)| match (k, field.parse::<f64>()) {
                        (7..=9, Ok(value)) => (-value).to_string(),
                        _ => (*field).to_owned(),
                    };
                    fields.iter().enumerate().map(flipped).collect::<Vec<_>>().join(",") + "\n"
                });
                bench.write(TASK, &turned.collect::<String>());
            },
            " tool axes point downwards in the cell, so that the spindle would be below the part",
        ),
        (
            |bench| {
                for (axis, ends) in [("x_mm", "[-0.3, 0.3]"), ("y_mm", "[-1.64, -1.0]"), ("z_mm", "[-0.5, -0.2]")] {
                    let text = bench.read(RUN);
                    let line = text.lines().find(|line| line.starts_with(&format!("{axis} = "))).unwrap();
                    bench.write(RUN, &text.replace(line, &format!("{axis} = {ends}")));
                }
            },
            "the cell is no wider than 0.640 mm in any direction",
        ),
        (
            |bench| {
                bench.replace(RUN, "q4 = [-1.0, 1.0]", "yaw_deg = [-3.1416, 3.1416]");
            },
            "cell.yaw_deg[1] is -3.1416, which is -pi: is it in degrees?",
        ),
        (
            |bench| {
                bench.replace(RUN, "[spindle]", "[spindle]\nmass_kg = 3000\ncentre_of_mass_mm = [0, 0, 200]");
            },
            "spindle.mass_kg is 3000 kg, where 0 to 2000 kg are usual: is it in kg?",
        ),
        (
            |bench| {
                bench.replace(RUN, "[spindle]", "[spindle]\nmass_kg = 30\ncentre_of_mass_mm = [0, 0, 0.2]");
            },
            "spindle.centre_of_mass_mm is 0.200 mm from the flange, where 5.00 to 5000 mm",
        ),
        (
            |bench| {
                let soft = "[spindle]\ntip_um_per_n = [[400, 0, 0], [0, 400, 0], [0, 0, 400]]";
                bench.replace(RUN, "[spindle]", soft);
            },
            "holder and tool yields by 400 um/N at the tool, more than ten times the ",
        ),
        (
            |bench| {
                bench.replace(RUN, "max_beta_rate_deg_per_mm = ", "max_beta_rate_deg_per_mm = 0.009 # ");
            },
            "redundancy.max_beta_rate_deg_per_mm is 0.00900 deg/mm, where at least 0.0100 deg/mm is usual",
        ),
        (
            |bench| {
                let text = bench.read(TASK);
                let tenth = |(number, line): (usize, &str)| match (number, line.rsplit_once(',')) {
                    (10, Some((before, _))) => format!("{before},99999\n"),
                    _ => format!("{line}\n"),
                };
                bench.write(TASK, &text.lines().enumerate().map(tenth).collect::<String>());
            },
            "the force at point 9 is ",
        ),
        (
            |bench| {
                bench.replace(RUN, "[cell]", "[tool]\ncutter_diameter_mm = 0.4\n[cell]");
            },
            "tool.cutter_diameter_mm is 0.400 mm, where 0.500 to 500 mm are usual: is it in mm?",
        ),
        (|_| (), ""),
    ];
    for (change, note) in cases {
        let bench = Bench::new();
        change(&bench);
        let ended =
            bench.stead(&[&["explain", RUN, "--json"][..], &PLACE, &["--point", "0", "--beta-deg", "0"]].concat());
        assert_eq!(ended.code, Some(0), "{note}: {}", ended.stderr);
        let document = ended.json();
        let notes: Vec<&str> =
            document["notes"].as_array().unwrap().iter().map(|note| note.as_str().unwrap()).collect();
        if note.is_empty() {
            assert!(notes.len() == 1 && notes[0].starts_with("collisions were not checked"), "{notes:?}");
        } else {
            assert!(notes.iter().any(|found| found.contains(note)), "{note} in {notes:?}");
            ended.assert_says(&["note: ", note]);
            let checked = bench.stead(&["check", RUN]);
            assert_eq!(checked.code, Some(0), "{note}: {}", checked.stderr);
            checked.assert_says(&["note: ", note]);
        }
    }
}

/// The job that finds a deflection notes that it is large.
#[test]
fn deflections_of_centimetres_are_noted() {
    let bench = Bench::new();
    let score = |bench: &Bench| bench.stead(&[&["score", RUN, "--json"][..], &PLACE].concat());
    assert!(!score(&bench).stderr.contains("deflects by up to"));
    scale_task(&bench, 1.0, 50.0);
    let ended = score(&bench);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["note: the tool deflects by up to ", " mm: are forces in N"]);
    let document = ended.json();
    assert!(
        document["notes"].as_array().unwrap().iter().any(|note| note.as_str().unwrap().contains("deflects by up to"))
    );
}

#[test]
fn simulation_and_stability_note_it_too() {
    let bench = Bench::new();
    bench.copy_all(&[STEEL, TX200]);
    bench.replace(STEEL, "# [stability] ", "[stability]\nlobes_points = 2\n# ");
    bench.replace(TX200, "stiffness_mnm_per_rad = 2.03", "stiffness_mnm_per_rad = 2.03e-6");
    bench.replace(STEEL, "kt_mpa = 3333.0", "kt_mpa = 33330.0");
    let ended = bench.stead(&["stability", STEEL, "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["note: tool.kt_mpa is 33330 MPa, where 0 to 10000 MPa are usual"]);
    ended.assert_says(&["note: Staubli TX200: joint 1 with 2.03e-6 MN m/rad is a hundred times stiffer or softer"]);
    assert!(ended.json()["notes"][0].as_str().unwrap().contains("joint 1"));
}

/// What no machine has: a stiffness and a damping with which the analysis of stability ran without end, and as much
/// elsewhere.
#[test]
fn what_no_machine_has_is_refused_at_its_line() {
    for (file, from, to, key) in [
        (TX200, "stiffness_mnm_per_rad = 2.03", "stiffness_mnm_per_rad = 2e9", "joints[1].stiffness_mnm_per_rad"),
        (TX200, "damping_nms_per_rad = 383.3", "damping_nms_per_rad = 1e308", "joints[1].damping_nms_per_rad"),
        (STEEL, "mass_kg = 44.4", "mass_kg = 1e300", "spindle.mass_kg"),
        (STEEL, "cutter_diameter_mm = 10.0", "cutter_diameter_mm = 1e7", "tool.cutter_diameter_mm"),
        (STEEL, "kt_mpa = 3333.0", "kt_mpa = 1e9", "tool.kt_mpa"),
    ] {
        let bench = Bench::new();
        bench.copy_all(&[STEEL, TX200]);
        let line = bench.replace(file, from, to);
        let ended = bench.stead(&["stability", STEEL]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{to}: {}", ended.stderr);
        let found = to.rsplit(' ').next().unwrap();
        ended.assert_says(&[&format!(":{line}: {key}: is out of range, found {found}; allowed: "), "not above "]);
        assert_eq!(ended.stderr.lines().count(), 1);
    }
}

/// Stiffness and damping that are within what is allowed, and beyond what an analysis can follow, end all the same.
#[test]
fn the_largest_numbers_that_are_allowed_end() {
    for (from, to) in [
        ("stiffness_mnm_per_rad = 2.03", "stiffness_mnm_per_rad = 1e6"),
        ("damping_nms_per_rad = 126.2", "damping_nms_per_rad = 1e9"),
    ] {
        let bench = Bench::new();
        bench.copy_all(&[STEEL, TX200]);
        bench.replace(STEEL, "# [stability] ", "[stability]\nlobes_points = 2\n# ");
        bench.replace(TX200, from, to);
        for scale in ["1", "10000"] {
            let ended = bench.stead(&["stability", STEEL, "--json", "--damping-scale", scale]);
            assert_eq!(ended.code, Some(0), "{to} {scale}: {}", ended.stderr);
        }
    }
}
