//! The import against what programs say, fixture by fixture, and against programs that are broken.

use super::*;
use crate::task::{Imported, parse_csv};

mod cldata_words;
mod dialects;
mod gcode_words;

const FINE: Resampling = Resampling { chord: 1e-5, step: 1e-2 };

fn settings() -> ReadSettings {
    ReadSettings { units: None, resampling: FINE, ..ReadSettings::default() }
}

/// The moves of a program.
fn program(text: &str, settings: &ReadSettings) -> Result<Program, InputError> {
    match format_of(text) {
        Some(CamFormat::Gcode) => gcode::read(Path::new("f"), text, settings),
        _ => cldata::read(Path::new("f"), text, settings),
    }
}

/// The task of a program, as it is read back, with what is said of it.
fn task(text: &str, settings: &ReadSettings) -> (Imported, ImportedPath) {
    let path = import_bytes(Path::new("f"), text.as_bytes(), settings).unwrap_or_else(|e| panic!("{e}"));
    let csv = path.csv(Path::new("out.csv")).unwrap();
    (parse_csv(Path::new("out.csv"), csv.as_bytes()).unwrap(), path)
}

/// Asserts that a program is refused at a line and word, with all these parts in the message.
#[track_caller]
fn refused(text: &str, settings: &ReadSettings, place: &str, parts: &[&str]) {
    let message = import_bytes(Path::new("f"), text.as_bytes(), settings).map(drop).unwrap_err().to_string();
    assert!(message.starts_with(&format!("f{place}: ")), "{place} at the start of {message}");
    for part in parts.iter().chain(&["; allowed: "]) {
        assert!(message.contains(part), "{part} in {message}");
    }
}

const POCKET: &str = include_str!("fixtures/pocket.cls");

#[test]
fn a_pocket_becomes_a_segment_with_its_plunge_and_its_retract_unscored() {
    let (read, path) = task(POCKET, &settings());
    let points = read.path.points();
    assert_eq!(read.path.segments().len(), 1);
    // The plunge starts 8 mm above: its start and the end of the retract are not scored, its end is.
    assert!(!read.path.is_scored(0) && read.path.is_scored(1) && !read.path.is_scored(points.len() - 1));
    assert_eq!(path.point_counts(), [points.len(), points.len() - 2]);
    assert_eq!(points[1].feed, Vector3::x());
    assert_eq!([0, 1, 2].map(|k| (read.path.feed(k).unwrap() * 1e6).round()), [5e3, 5e3, 2e4]);
    // The corner stays, and on the arc points are as near as the chord error asks for.
    assert!(points.iter().any(|point| (point.position - Vector3::new(0.035, 0.0, -0.005)).norm() < 1e-12));
    let centre = Vector3::new(0.03, 0.02, -0.005);
    let on_arc = points.iter().filter(|p| p.position.x > 0.03 && p.position.y > 0.02);
    assert!(on_arc.clone().count() > 5 && on_arc.clone().all(|p| ((p.position - centre).norm() - 0.005).abs() < 1e-8));
    let steps = points.windows(2).map(|pair| (pair[1].position - pair[0].position).norm());
    assert!(steps.fold(0.0, f64::max) <= 0.01 + 1e-12);
    let said = format!("{path}");
    for part in ["1 moves end where they start", "2 points of plunges", "PAINT (line 24)", "5.000 to 20.000 mm/s"] {
        assert!(said.contains(part), "{part} in {said}");
    }
}

#[test]
fn turns_in_place_are_followed_and_not_scored() {
    let text = "UNITS/MM\nFEDRAT/600\nGOTO/0,0,0,0,0,1\nGOTO/20,0,0\nGOTO/20,0,0,0,0.5,0.8660254\nGOTO/20,20,0\nFINI\n";
    let (read, path) = task(text, &settings());
    let turned: Vec<usize> = (1..read.path.points().len()).filter(|point| read.path.turns_in_place(*point)).collect();
    assert_eq!(turned.len(), 6, "30 deg in steps of 5");
    assert!(turned.iter().all(|point| !read.path.is_scored(*point)));
    assert!(read.path.is_scored(turned[0] - 1) && read.path.is_scored(turned[5] + 1));
    assert!(read.path.step_time(turned[0], 1.0).is_infinite());
    assert!(path.notes.iter().any(|note| note.starts_with("6 points of turns of the tool in place")), "{path}");
}

#[test]
fn dense_points_are_thinned_within_the_chord_error() {
    let mut text = "UNITS/MM\nFEDRAT/MMPM,600\nRAPID\nGOTO/0,0,0\n".to_owned();
    let wave = |x: f64| 3.0 * libm::sin(x / 15.0);
    (1..=4000).for_each(|k| text += &format!("GOTO/{:.5},{:.5},0\n", 0.025 * f64::from(k), wave(0.025 * f64::from(k))));
    let (read, path) = task(&(text + "FINI\n"), &settings());
    let points = read.path.points();
    assert!((15..300).contains(&points.len()), "{}", points.len());
    for pair in points.windows(2) {
        let [a, b] = [pair[0].position * 1e3, pair[1].position * 1e3];
        for k in 0..20 {
            let share = f64::from(k) / 20.0;
            let x = a.x + (b.x - a.x) * share;
            assert!((a.y + (b.y - a.y) * share - wave(x)).abs() < 0.0105 * 1.1, "at {x}");
        }
    }
    assert!(path.notes[0].ends_with("stand within the chord error"), "{path}");
}

#[test]
fn a_program_without_a_wall_a_format_or_a_whole_set_of_feeds_is_refused() {
    refused("UNITS/MM\nFEDRAT/1\nGOTO/0,0,0\nGOTO/0,0,-5\nFINI\n", &settings(), "", &["1 cutting moves, none"]);
    refused("hello world\n", &settings(), ": --format", &["neither CLDATA nor G-code", "--format cldata"]);
    refused("", &settings(), ": --format", &["neither"]);
    refused(
        "UNITS/MM\nGOTO/0,0,0\nGOTO/5,0,0\nFEDRAT/9\nGOTO/9,0,0\nFINI\n",
        &settings(),
        ":3",
        &["before the first feed"],
    );
    let (read, path) = task("UNITS/MM\nGOTO/0,0,0\nGOTO/5,0,0\nFINI\n", &settings());
    assert_eq!(read.path.feed(1), None);
    assert!(path.to_string().contains("no feed in the program"));
}

#[test]
fn more_points_than_memory_holds_are_refused() {
    let fine = ReadSettings { resampling: Resampling { chord: 1e-5, step: 1e-6 }, ..settings() };
    refused("UNITS/MM\nGOTO/0,0,0\nGOTO/90000,0,0\nFINI\n", &fine, "", &["90000001 points", "a larger --step-mm"]);
}

#[test]
fn feeds_that_no_machine_has_are_refused() {
    let program = |feed: &str| format!("UNITS/MM\nGOTO/0,0,0\nFEDRAT/{feed}\nGOTO/9,0,0\nFINI\n");
    refused(&program("1e-9"), &settings(), ":4", &["no usual feed", "e-11 mm/s", "0.0001 to 100000 mm/s"]);
    refused(&program("1e300"), &settings(), ":3: FEDRAT", &["usual size"]);
    refused(&program("-5"), &settings(), ":3: FEDRAT", &["not a feed", "above 0"]);
}

/// The tables of a run file for the cutter of a program.
fn cutter(text: &str) -> Option<String> {
    let path = import_bytes(Path::new("part.nc"), text.as_bytes(), &settings()).unwrap_or_else(|e| panic!("{e}"));
    let files = path.files(Path::new("my/part.csv")).unwrap();
    assert!(files.iter().skip(1).all(|(file, _)| file == Path::new("my/part-tool.toml")));
    files.get(1).map(|(_, text)| text.clone())
}

#[test]
fn the_cutter_of_a_program_is_written_with_its_speed_and_feed() {
    let cut = "UNITS/MM\nFEDRAT/MMPM,600\nGOTO/0,0,0\nGOTO/20,0,0\nFEDRAT/MMPM,1200\nGOTO/90,0,0\nFINI\n";
    let tools = [
        ("TLDATA/MILL,12.0000,1.5000,75.0000,0.0000,0.0000\nSPINDL/RPM,6000,CLW\n", "12.0", Some("1.5"), "6000.0"),
        ("SPINDL/6000,RPM,CCLW\nCUTTER/ 12., 1.5, 4.5, 1.5, 0., 0., 75.\n", "12.0", Some("1.5"), "6000.0"),
        ("CUTTER/8\nLOADTL/1\nSPINDL/ON\nSPINDL/RPM,6000.0,CLW\n", "8.0", None, "6000.0"),
    ];
    for (tool, diameter, corner, speed) in tools {
        let text = cutter(&format!("{tool}{cut}")).unwrap();
        let has = |part: &str| assert!(text.contains(part), "{part} in {text}");
        has(&format!("\ncutter_diameter_mm = {diameter} "));
        has(&format!("\n[cut]\nspindle_rpm = {speed} "));
        // The feed of the longest way: 1200 mm/min at 6000 rpm.
        has("\n# feed_per_tooth_mm = 0.1 ");
        assert_eq!(text.contains("corner_radius_mm"), corner.is_some());
        assert!(corner.is_none_or(|corner| text.contains(&format!("\ncorner_radius_mm = {corner} "))), "{text}");
        assert_eq!(text.contains("\nrotation = \"counterclockwise\""), tool.contains("CCLW"), "{text}");
    }
    // A cutter that is not described has no file; a speed alone is kept in comments.
    assert_eq!(cutter(cut), None);
    assert!(cutter(&format!("SPINDL/RPM,6000,CLW\n{cut}")).unwrap().contains("\n# [tool]"));
}

#[test]
fn the_tool_with_the_longest_way_is_taken_and_the_others_are_named() {
    let text = "\
(T1 D=20. CR=0. - FLAT END MILL)
(T2 D=6. CR=3. - BALL END MILL)
G21 G90
T1 M6
S3000 M3
G0 X0 Y0 Z5
G1 Z0 F300
G1 X10 F600
T2 M6
S12000 M3
G0 X0 Y0 Z5
G1 Z0 F300
G1 X200 F2400
M30
";
    let path = import_bytes(Path::new("part.nc"), text.as_bytes(), &settings()).unwrap();
    let note = path.notes.iter().find(|note| note.starts_with("2 tools cut")).unwrap();
    assert!(note.contains("D 6 mm, corner radius 3 mm, 12000 rpm") && note.contains("D 20 mm"), "{note}");
    let written = cutter(text).unwrap();
    for part in
        ["\ncutter_diameter_mm = 6.0 ", "\nspindle_rpm = 12000.0", "= 0.1 ", "Another tool", "D 20 mm, 3000 rpm"]
    {
        assert!(written.contains(part), "{part} in {written}");
    }
    // In inches, and turning left.
    let inches = "G20 G90 (MILL DIA .5)\nS1000 M4\nG0 X0 Y0 Z1\nG1 X4 F10\nM30\n";
    let written = cutter(inches).unwrap();
    assert!(
        written.contains("\ncutter_diameter_mm = 12.7 ") && written.contains("\nrotation = \"counter"),
        "{written}"
    );
}

#[test]
fn lines_hardly_longer_than_the_step_are_not_divided() {
    let points = |length: &str| {
        let text = format!("UNITS/MM\nFEDRAT/MMPM,600\nGOTO/0,0,0\nGOTO/{length},0,0\nFINI\n");
        task(&text, &settings()).0.path.points().len()
    };
    assert_eq!(["10", "10.05", "10.1", "10.2", "20.1", "20.3"].map(points), [2, 2, 2, 3, 3, 4]);
}

#[test]
fn moves_in_the_air_are_kept_between_the_segments_that_they_join() {
    let text = "G21 G90\nG0 X0 Y0 Z9\nZ5\nG1 Z0 F600\nX20\nG0 Z5\nX40 Y7\nZ1\nG1 X60\nG0 Z9\nX0\nM30\n";
    let path = import_bytes(Path::new("part.nc"), text.as_bytes(), &settings()).unwrap();
    let mm = |places: &Vec<Move>| -> Vec<[f64; 3]> {
        places.iter().map(|place| (place.position * 1e3).map(f64::round).into()).collect()
    };
    let air: Vec<_> = path.rapids().iter().map(mm).collect();
    // The ends of the segments themselves are left out.
    let expected =
        [vec![[0.0, 0.0, 9.0]], vec![[20.0, 0.0, 5.0], [40.0, 7.0, 5.0]], vec![[60.0, 7.0, 9.0], [0.0, 7.0, 9.0]]];
    assert_eq!(air, expected);
}
