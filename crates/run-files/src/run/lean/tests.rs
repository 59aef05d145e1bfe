//! Tests of the table.

use crate::testing::{RUN, folder};
use stead_disk::input::InputError;
use stead_model::task::lean::{ContactRule, LeanForce};
use stead_runs::Run;
use tempfile::TempDir;

const BALL: &str = "[tool]\ncutter_diameter_mm = 16\ncorner_radius_mm = 8\n";
const BULL: &str = "[tool]\ncutter_diameter_mm = 25\ncorner_radius_mm = 5\n";
const FLAT: &str = "[tool]\ncutter_diameter_mm = 20\n";
const LEAN: &str = "[lean]\nlead_deg = [-5, 20]\ntilt_deg = [-15, 15]\n";

/// A run with tables added, and with columns of a normal where one is given.
fn read(tables: &str, normal: Option<[f64; 3]>) -> Result<Run, InputError> {
    if let Some([x, y, z]) = normal {
        return with_columns(tables, "normal_x,normal_y,normal_z", |_| format!("{x},{y},{z}"));
    }
    run_in(&folder(), tables)
}

/// The run of a folder with tables added.
fn run_in(folder: &TempDir, tables: &str) -> Result<Run, InputError> {
    let file = folder.path().join("run.toml");
    std::fs::write(&file, format!("{RUN}{tables}")).unwrap();
    crate::read_run(&file)
}

fn refused(tables: &str, normal: Option<[f64; 3]>, parts: &[&str]) {
    let message = read(tables, normal).unwrap_err().to_string();
    for part in parts.iter().chain(&["; allowed: "]) {
        assert!(message.contains(part), "{part} in {message}");
    }
}

#[test]
fn a_tool_leans_as_its_end_allows() {
    let run = read(&format!("{BALL}{LEAN}[[lean.segment]]\nnumber = 1\ntilt_deg = [0, 5]\n"), None).unwrap();
    let space = run.problem.lean.as_deref().unwrap();
    assert_eq!((space.rule.contact, space.rule.force), (ContactRule::Centre, LeanForce::Feed));
    assert!((space.ranges[0].lead.max - 20_f64.to_radians()).abs() < 1e-12);
    assert!((space.ranges[1].tilt.max - 5_f64.to_radians()).abs() < 1e-12 && space.ranges[1].tilt.min == 0.0);
    let closed = read(&format!("{BALL}[lean]\nmax_lean_deg = 10\n"), None).unwrap();
    assert!(closed.problem.lean.is_none());
    assert!(closed.notes.iter().any(|note| note.contains("neither lead nor tilt")), "{:?}", closed.notes);
    let plane = read(&format!("{BULL}{LEAN}"), None).unwrap();
    assert_eq!(plane.problem.lean.as_deref().unwrap().rule.contact, ContactRule::Plane);
    assert!(plane.notes.iter().any(|note| note.contains("lean.step_over_mm bounds that")), "{:?}", plane.notes);
}

/// Columns of the task are forces on the part; what is stated in the frame of the tool turns with it.
#[test]
fn forces_turn_with_the_tool_where_they_are_stated_for_it() {
    let force = |from: &str, tables: &str| {
        let folder = folder();
        let file = folder.path().join("run.toml");
        std::fs::write(&file, format!("{}{tables}{LEAN}", RUN.replace("task.csv", from))).unwrap();
        crate::read_run(&file).unwrap().problem.lean.as_deref().unwrap().rule.force
    };
    let stated = format!("{BALL}[forces]\nfeed_n = 10\nnormal_n = 20\naxis_n = 5\n");
    assert_eq!(force("path.csv", &stated), LeanForce::Tool);
    assert_eq!(force("task.csv", BALL), LeanForce::Feed);
}

#[test]
fn what_no_tool_can_do_is_refused() {
    refused(LEAN, None, &["lean: is there without the cutter", "a table [tool]"]);
    refused(&format!("{FLAT}{LEAN}"), None, &["lean: cannot be: point 1", "a flat end mill leans in lead only"]);
    let contact = format!("{BULL}{LEAN}rule = 'contact'\n");
    refused(&contact, None, &["needs normal_x to normal_z or rule = \"plane\""]);
    refused(&contact, Some([0.0, 0.0, 1.0]), &["the contact jumps by up to 15 mm"]);
    refused(&format!("{BULL}{LEAN}"), Some([0.0, 1.0, 0.0]), &["the contact is on the flank"]);
    refused(&format!("{BULL}{LEAN}"), Some([0.6, 0.0, -0.8]), &["points away from the tool"]);
    refused(&format!("{BULL}{LEAN}rule = 'centre'\n"), None, &["the centre stays for a ball alone"]);
    let tapered = BALL.replace("corner", "taper_deg = 3\ncorner");
    refused(&format!("{tapered}{LEAN}"), None, &["leans a tapered cutter"]);
    let wide = BALL.replace("16", "12");
    refused(&format!("{wide}{LEAN}"), None, &["corner is larger than its radius", "at most 6"]);
    refused(&format!("{BALL}[lean]\nlead_deg = [20, -5]\n"), None, &["lead_deg"]);
    refused(&format!("{BALL}[lean]\nlead_deg = [0, 80]\n"), None, &["lead_deg", "60"]);
    refused(&format!("{BALL}[lean]\nlead_deg = [nan, 5]\n"), None, &["lead_deg"]);
    refused(
        &format!("{BALL}[lean]\nlead_deg = [10, 20]\nmax_lean_deg = 5\n"),
        None,
        &["lean.max_lean_deg: is below the least lean of point 1, 10 deg", "found 5; allowed: at least 10, or ranges"],
    );
    refused(
        &format!("{BALL}{LEAN}lead_step_deg = 0.2\ntilt_step_deg = 0.2\n"),
        None,
        &["lean.lead_step_deg: makes", "a wider step"],
    );
    refused(&format!("{BALL}{LEAN}[[lean.segment]]\nnumber = 2\n"), None, &["is no segment of the task", "1 to 1"]);
    refused(&format!("{FLAT}[lean]\nlead_deg = [1, 5]\nscallop_mm = 0.01\n"), None, &["scallop_mm", "whole range"]);
}

#[test]
fn a_flat_end_does_not_tilt_within_a_largest_angle() {
    let tilts = format!("{FLAT}[lean]\nlead_deg = [1, 5]\ntilt_deg = [-4, 20]\nmax_lean_deg = 10\n");
    refused(
        &tilts,
        None,
        &["lean: cannot be: point 1, lead 0.000 deg, tilt 20.000 deg: a flat end mill leans in lead"],
    );
    let segment = "[[lean.segment]]\nnumber = 1\ntilt_deg = [-4, 0]\n";
    let tilts = format!("{FLAT}[lean]\nlead_deg = [1, 5]\nmax_lean_deg = 3\n{segment}");
    refused(&tilts, None, &["tilt -4.000 deg: a flat end mill leans in lead only"]);
}

#[test]
fn a_lead_says_by_how_much_it_hollows_the_floor() {
    let note = |tables: &str| {
        let run = read(tables, None).unwrap();
        run.notes.into_iter().find(|note| note.contains("hollows")).map(String::from).unwrap_or_default()
    };
    // A flat cutter of 16 mm, leaning by 10 deg: 8 mm sin 10 deg.
    let flat = "[tool]\ncutter_diameter_mm = 16\n[lean]\nlead_deg = [0, 10]\n";
    let start = "leaning by up to 10.0 deg, the cutter hollows the floor of a slot by up to 1.39 mm; what it leaves";
    assert!(note(flat).starts_with(start), "{}", note(flat));
    // A bull: 7.5 mm sin 20 deg + 5 mm (1 - cos 20 deg), and s^2 / (8 R') for 4 mm.
    let bull = format!("{BULL}[lean]\nlead_deg = [0, 20]\nstep_over_mm = 4\n");
    let said = note(&bull);
    assert!(
        said.contains("by up to 2.87 mm, and leaves ridges of up to 0.0743 mm between passes 4.00 mm apart"),
        "{said}"
    );
    assert!(said.ends_with("lean.scallop_mm bounds that"), "{said}");
    assert!(note(&format!("{bull}max_lean_deg = 10\n")).starts_with("leaning by up to 10.0 deg"));
    assert_eq!(note(&format!("{BALL}{LEAN}")), "");
}

#[test]
fn a_ball_leans_about_its_centre_and_segments_stand_once() {
    for rule in ["contact", "plane"] {
        let parts = ["lean.rule: is ", "for a ball, which leans about its centre; allowed: \"centre\", or no rule"];
        refused(&format!("{BALL}{LEAN}rule = '{rule}'\n"), None, &parts);
    }
    assert!(read(&format!("{BALL}{LEAN}rule = 'centre'\n"), None).is_ok());
    let segment = "[[lean.segment]]\nnumber = 1\ntilt_deg = [0, 5]\n";
    refused(&format!("{BALL}{LEAN}{segment}{segment}"), None, &["lean.segment[2].number: is there twice"]);
}

/// A run whose task has more columns: their names, and what a row of the task has in them.
fn with_columns(tables: &str, columns: &str, row: impl Fn(usize) -> String) -> Result<Run, InputError> {
    let folder = folder();
    let file = folder.path().join("task.csv");
    let text = std::fs::read_to_string(&file).unwrap();
    let rows = text.lines().enumerate().map(|(k, line)| match k {
        0 => format!("{line},{columns}\n"),
        _ => format!("{line},{}\n", row(k)),
    });
    std::fs::write(&file, rows.collect::<String>()).unwrap();
    run_in(&folder, tables)
}

#[test]
fn points_narrow_the_ranges() {
    let all = format!("{BALL}{LEAN}");
    let tilt = |k: usize| if k == 2 { "-3,0".to_owned() } else { "-15,15".to_owned() };
    let run = with_columns(&all, "tilt_min_deg,tilt_max_deg", tilt).unwrap();
    let ranges = &run.problem.lean.as_deref().unwrap().ranges;
    assert!((ranges[0].tilt.max - 15_f64.to_radians()).abs() < 1e-12);
    assert!((ranges[1].tilt.min + 3_f64.to_radians()).abs() < 1e-12 && ranges[1].tilt.max == 0.0);
    assert_eq!(ranges[0].lead, ranges[1].lead);
    let unused = with_columns("", "tilt_min_deg,tilt_max_deg", tilt).unwrap();
    assert!(unused.notes.iter().any(|note| note.contains("count for nothing")), "{:?}", unused.notes);
}

#[test]
fn points_that_ask_for_more_are_refused_at_their_line() {
    let all = format!("{BALL}{LEAN}");
    let lead = |value: &'static str| move |k: usize| if k == 2 { value.to_owned() } else { "0,5".to_owned() };
    for (value, parts) in [
        ("-6,5", [":3:", "lead_min_deg", "-6", "-5 to 20"]),
        ("0,21", [":3:", "lead_max_deg", "21", "-5 to 20"]),
        ("4,3", [":3:", "lead_min_deg", "above the end", "at most"]),
    ] {
        let message = with_columns(&all, "lead_min_deg,lead_max_deg", lead(value)).unwrap_err().to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "{part} in {message}"));
    }
    let unscored = |k: usize| if k == 1 { "0,2,5".to_owned() } else { "1,2,5".to_owned() };
    let message = with_columns(&all, "scored,lead_min_deg,lead_max_deg", unscored).unwrap_err().to_string();
    for part in [":2:", "lead_min_deg", "is not scored", "at most 0"] {
        assert!(message.contains(part), "{part} in {message}");
    }
}
