//! `stead import path` from outside: what it writes, says and refuses, and that what it writes can be placed.

use crate::common::Bench;

/// A plunge, a cut, a turn of the tool in place, a cut at another feed, a retract; then a second cut.
const PROGRAM: &str = "\
TOOL PATH/SLOT,TOOL,MILL_16
UNITS/MM
SPINDL/RPM,9000,CLW
RAPID
GOTO/0.,0.,60.,0.,0.,1.
RAPID
GOTO/0.,0.,12.
FEDRAT/MMPM,300.
GOTO/0.,0.,0.
FEDRAT/MMPM,1800.
GOTO/60.,0.,0.
GOTO/60.,0.,0.,0.,.1736482,.9848078
FEDRAT/MMPM,1200.
GOTO/60.,40.,0.
GOTO/60.,42.083778,11.817694
RAPID
GOTO/0.,0.,60.,0.,0.,1.
RAPID
GOTO/0.,40.,0.
GOTO/60.,40.,0.
COOLNT/OFF
END-OF-PATH
FINI
";

const IMPORT: [&str; 7] = ["import", "path", "slot.cls", "--out", "new/task.csv", "--step-mm", "20"];

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("slot.cls", PROGRAM);
    bench
}

#[test]
fn writes_a_task_and_says_what_was_changed() {
    let bench = bench();
    let ended = bench.stead(&[&IMPORT[..], &["--report"]].concat());
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
    for part in [
        "format    nx\nread      6 cutting and 3 rapid moves",
        "segments  2",
        "points    14, of which 10 are scored",
        "tilt      0.000 to 10.000 deg",
        "feed      5.000 to 30.000 mm/s",
        "- 2 points of plunges",
        "- 2 points of turns of the tool in place",
        "- words passed over: COOLNT (line 21)",
        "written: new/task.csv, new/task-tool.toml: 2 segments, 14 points, 10 of them scored",
    ] {
        assert!(ended.stdout.contains(part), "{part} in {}", ended.stdout);
    }
    let task = bench.read("new/task.csv");
    assert_eq!(task.lines().next().unwrap().split(',').skip(10).collect::<Vec<_>>(), ["feed_mm_per_s", "scored"]);
    assert_eq!(task.lines().count(), 15);
    let again = bench.stead(&IMPORT);
    assert_eq!((again.code, again.stdout.as_str()), (Some(2), ""));
    again.assert_says(&["error: new/task.csv: is there already", "; allowed: "]);
    assert_eq!(bench.read("new/task.csv"), task);
}

#[test]
fn nothing_is_written_on_an_error() {
    let bench = bench();
    bench.replace("slot.cls", "GOTO/60.,40.,0.", "GOTO/60.,40.,nan");
    let before = bench.tree("");
    let ended = bench.stead(&IMPORT);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""));
    ended.assert_says(&["error: slot.cls:14: GOTO: ", "found '60.,40.,nan'", "; allowed: 3 or 6 finite numbers"]);
    for (option, value) in [("--step-mm", "0"), ("--chord-mm", "nan"), ("--machine", "table-ab"), ("--pivot-mm", "1,2")]
    {
        let ended = bench.stead(&["import", "path", "slot.cls", "--out", "new/task.csv", option, value]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{option}");
        ended.assert_says(&[option, value]);
    }
    let missing = bench.stead(&["import", "path", "none.cls", "--out", "new/task.csv"]);
    assert_eq!(missing.code, Some(2));
    missing.assert_says(&["none.cls: cannot be read"]);
    assert_eq!(bench.tree(""), before);
}

/// Bad programs, each with where it is refused, the word, what was found, and what is allowed.
#[test]
fn each_bad_program_is_refused_in_one_line_and_nothing_is_written() {
    const CUT: &str = "UNITS/MM\nFEDRAT/MMPM,600\nGOTO/0,0,0,0,0,1\n";
    const CODES: &str = "G21 G90\nG0 X0 Y0 Z0\nG1 X1 F600\n";
    for (start, text, said) in [
        (CUT, "GOTO/1,nan,3", [":4: GOTO: ", "found '1,nan,3'", "3 or 6 finite numbers"]),
        (CUT, "GOTO/1,2,3,0,1", [":4: GOTO: ", "found '1,2,3,0,1'", "3 or 6 finite numbers"]),
        (CUT, "CIRCLE/5,0,0,0,0,1\nGOTO/5,6,0", [":5: GOTO: the arc misses its end", "found '5,6,0'", "0.05 mm"]),
        (CUT, "CIRCLE/5,0,0,0,0,0\nGOTO/5,5,0", [":5: GOTO: the axis of the arc", "found '5,5,0'", "a direction"]),
        (CUT, "GOTO/1,2,3,0,0,0", [":4: GOTO: the tool axis has no length", "found '1,2,3,0,0,0'", "a direction"]),
        (CUT, "GODLTA/0,0,5", [":4: GODLTA: is not read: a move that counts", "found '0,0,5'", "GOTO, RAPID, arcs"]),
        (CUT, "UNITS/INCHES", [":4: UNITS: is not what the file before says", "found 'INCHES'", "one unit"]),
        (CUT, "MSYS/0,0,0,1,0,0,1,0,0", [":4: MSYS: ", "found '0,0,0,1,0,0,1,0,0'", "right angles"]),
        (
            "",
            "GOTO/0,0,0\nGOTO/9,0,0",
            [": --units: does not state its unit", "UNITS/MM", "--units mm or --units inch"],
        ),
        (CODES, "G0 G1 X11", [":4: G: two ways to move", "found 'G1'", "one of G0, G1, G2, G3"]),
        (CODES, "G20 X2", [":4: G: contradicts the unit", "found 'G20'", "one unit of length"]),
        (CODES, "G2 X11 I5 R5", [":4: R: a radius and a centre", "found 'R5'", "R, or I, J and K"]),
        (CODES, "G3 X11 I4", [":4: I: the arc misses its end", "found 'I4'", "the same radius"]),
        (CODES, "G1 X5 A3", [":4: A: a rotary axis of a machine", "found 'A3'", "--machine table-ac"]),
        ("", "0 BEGIN PGM PART MM", [":1: Heidenhain conversational is not read", "'0 BEGIN PGM PART MM'", "CLDATA"]),
        (CODES, "#100 = 3", [":4: a macro program (variables) is not read", "found '#100 = 3'", "numbers alone"]),
    ] {
        let bench = Bench::new();
        let end = if start == CODES { "G1 X9" } else { "GOTO/9,9,0" };
        bench.write("bad", &format!("{start}{text}\n{end}\n"));
        let before = bench.tree("");
        let ended = bench.stead(&["import", "path", "bad", "--out", "new/task.csv", "--report"]);
        assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{text}");
        assert_eq!(ended.stderr.trim_end().lines().count(), 1, "{}", ended.stderr);
        let [place, found, allowed] = said;
        ended.assert_says(&[&format!("error: bad{place}"), found, "; allowed: ", allowed]);
        assert_eq!(bench.tree(""), before, "{text}");
    }
}

#[test]
fn an_imported_path_is_placed_with_stated_forces() {
    let bench = bench();
    assert_eq!(bench.stead(&["init", "place", "new"]).code, Some(0));
    std::fs::remove_file(bench.path("new/task.csv")).unwrap();
    assert_eq!(bench.stead(&IMPORT).code, Some(0));
    let refused = bench.stead(&["place", "new/run.toml"]);
    assert_eq!(refused.code, Some(2));
    refused.assert_says(&["task: has no force columns", "[tool] and [cut]", "[forces] with feed_n"]);
    let forces = "[forces]\nfeed_n = -90.0\nnormal_n = -25.0\naxis_n = 10.0\n";
    let run =
        bench.read("new/run.toml").replace("max_spindle_turn_deg_per_mm = 0.5", "max_spindle_turn_deg_per_mm = 9.0");
    let run =
        run.replace("population = 32\ngenerations = 8\nbasins = 2", "population = 12\ngenerations = 2\nbasins = 1");
    bench.write("new/run.toml", &format!("{run}\n{forces}"));
    let ended = bench.stead(&["place", "new/run.toml", "--out", "out", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let best = bench.read("out/best.csv");
    let header: Vec<&str> = best.lines().next().unwrap().split(',').collect();
    let column =
        |name: &str| header.iter().position(|own| *own == name).unwrap_or_else(|| panic!("{name} in {header:?}"));
    let score = column("score_mm");
    let scores: Vec<f64> =
        best.lines().skip(1).map(|row| row.split(',').nth(score).unwrap().parse().unwrap()).collect();
    assert_eq!((scores.len(), scores.iter().filter(|score| **score == 0.0).count()), (14, 4));
    let document = ended.json();
    let case = &document["cases"][0];
    let mean = case["mean_mm"].as_f64().unwrap();
    assert!((mean / (scores.iter().sum::<f64>() / 10.0) - 1.0).abs() < 1e-4, "{mean} {scores:?}");
}

#[test]
fn holes_are_drilled_or_left_out_and_tool_axes_from_below_are_noted() {
    let bench = bench();
    let drilled = PROGRAM.replace(
        "COOLNT/OFF\n",
        "CYCLE/DRILL,RAPTO,3.,FEDTO,-9.,MMPM,240.\nGOTO/10.,10.,0.\nGOTO/20.,10.,0.\nCYCLE/OFF\n",
    );
    bench.write("slot.cls", &drilled);
    let ended = bench.stead(&IMPORT);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["holes of drilling cycles taken as a plunge"]);
    assert!(ended.stdout.contains(": 4 segments, "), "{}", ended.stdout);
    std::fs::remove_dir_all(bench.path("new")).unwrap();
    let ended = bench.stead(&[&IMPORT[..], &["--skip-cycles"]].concat());
    ended.assert_says(&["2 holes left out (--skip-cycles): 10, 10, 0 mm (line 22); 20, 10, 0 mm (line 23)"]);
    assert!(ended.stdout.contains(": 2 segments, "), "{}", ended.stdout);
    std::fs::remove_dir_all(bench.path("new")).unwrap();

    bench.write("slot.cls", &PROGRAM.replace("0.,0.,1.", "0.,0.,-1."));
    let ended = bench.stead(&IMPORT);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["tool axes point downwards in the frame of the part", "is their sign right?"]);

    std::fs::remove_dir_all(bench.path("new")).unwrap();
    for (words, parts) in [
        ("MODE/INCR", ["slot.cls:21: MODE: positions that count from the last one", "from the origin"]),
        ("CALSUB/5", ["slot.cls:21: CALSUB: is not read: a program of its own", "straight moves"]),
        ("CYCLE/CSINK,5", ["slot.cls:21: CYCLE: a cycle whose moves are not known", "--skip-cycles"]),
    ] {
        bench.write("slot.cls", &PROGRAM.replace("COOLNT/OFF", words));
        let refused = bench.stead(&IMPORT);
        assert_eq!(refused.code, Some(2));
        refused.assert_says(&parts);
        assert!(!bench.path("new/task.csv").exists());
    }
}

/// From a CAM file and a URDF with a table in its cell to a plan: nothing is typed in between.
#[test]
fn what_is_imported_is_taken_into_the_run_and_placed() {
    let bench = Bench::new();
    let program = PROGRAM.replace("SPINDL/", "TLDATA/MILL,16.0000,2.0000,75.0000,0.0000,0.0000\nSPINDL/");
    bench.write("slot.cls", &program);
    bench.copy("crates/format/src/urdf/fixtures/kuka.urdf", "arm.urdf");
    let link = "<link name=\"link_2\">";
    let collision = "<collision><geometry><box size=\"0.3 0.3 1.0\"/></geometry></collision>";
    bench.replace("arm.urdf", link, &format!("{link}{collision}"));
    let run = |arguments: &[&str]| {
        let ended = bench.stead(arguments);
        assert_eq!(ended.code, Some(0), "{arguments:?}: {}", ended.stderr);
        ended
    };
    let robot =
        ["import", "robot", "arm.urdf", "--stiffness-like", "kuka-kr270-r2700", "--collision", "--out", "my/arm.toml"];
    run(&robot);
    let path = ["import", "path", "slot.cls", "--step-mm", "30", "--out", "my/part.csv"];
    let written = run(&path).stdout;
    assert!(written.starts_with("written: my/part.csv, my/part-tool.toml: 2 segments"), "{written}");
    let table =
        "\n[[shape]]\nname = \"table\"\nattached = \"base\"\nbox_mm = [1000, 2000, 100]\nxyz_mm = [1700, 0, 450]\n";
    let cell = bench.read("my/arm-cell.toml");
    assert!(!cell.contains("[collision]"));
    bench.write("my/arm-cell.toml", &(cell + table));
    let init = ["init", "place", "--robot", "my/arm.toml", "--task", "my/part.csv", "--out", "my/run.toml"];
    run(&init);
    let text = bench.read("my/run.toml");
    for part in [
        "surroundings = \"arm-cell.toml\"",
        "direction = \"total\"",
        "force_uncertainty = 0.1",
        "max_spindle_turn_deg_per_mm = 0.5",
        "# kind = \"rail\"",
        "# kind = \"turntable\"",
        "\nguesses = [\"spindle\", \"cell\", \"stock.depth_mm\", \"tool.teeth\", ",
        "z_mm = [500.0, ",
        "on \"table\" of the surroundings, 500 mm",
        "\ncutter_diameter_mm = 16.0 ",
        "\ncorner_radius_mm = 2.0 ",
        "\nspindle_rpm = 9000.0 ",
        "feed_mm_per_s = 30.0 ",
        "whose own feeds count: 5.0 to 30.0 mm/s",
        "\n[stock] ",
        "\ndepth_mm = ",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert!(!text.contains("max_beta_rate"), "{text}");
    let small = ["--set", "search.population=12", "--set", "search.generations=1", "--set", "search.basins=1"];
    let place = [&["place", "my/run.toml", "--out", "out"][..], &small].concat();
    let placed = bench.stead_in_short(&place);
    assert_eq!(placed.code, Some(0), "{}", placed.stderr);
    assert!(bench.path("out/best.csv").is_file());
    // The result is read in a few lines, in the order in which they count.
    let lines: Vec<&str> = placed.stdout.lines().chain(placed.stderr.lines()).collect();
    let words: usize = lines.iter().map(|line| line.split_whitespace().count()).sum();
    assert!(
        lines.len() <= 12 && words <= 120,
        "{} lines, {words} words: {}{}",
        lines.len(),
        placed.stdout,
        placed.stderr
    );
    let abouts = ["best ", "  ", "worst ", "held by ", "cut ", "RESTS ON ", "NOT CHECKED "];
    assert!(lines.iter().zip(abouts).all(|(line, about)| line.starts_with(about)), "{}", placed.stdout);
    assert!(lines[5].contains("stiffness of KUKA KR 270 R2700"), "{}", lines[5]);
    assert!(lines[5].contains("guesses: spindle, cell, stock.depth_mm, tool ("), "{}", lines[5]);
    let next = "stead export my/run.toml out/best.csv --format csv --out prog/PART";
    assert!(lines.last().is_some_and(|last| last.starts_with("next ") && last.ends_with(next)), "{}", placed.stdout);
    let summary: serde_json::Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    let said: Vec<&str> =
        summary["summary"].as_array().unwrap().iter().map(|line| line["text"].as_str().unwrap()).collect();
    assert!(said.iter().zip(&lines).all(|(said, line)| line.ends_with(said)), "{said:?}");
    let notes = bench.read("out/notes.txt");
    for part in [
        "RESTS ON ",
        "\nWhat the result rests on\n- guesses: spindle, cell, stock.depth_mm",
        "\nWhat was not checked\n",
    ] {
        assert!(notes.contains(part), "{part} in {notes}");
    }
    let long = run(&place);
    assert!(long.stdout.contains("placements and") && long.stderr.contains("note: guesses: "), "{}", long.stderr);
    // Nothing is written over without --force.
    let kept = bench.tree("my");
    for command in [&robot[..], &path, &init] {
        let ended = bench.stead(command);
        assert_eq!(ended.code, Some(2), "{command:?}");
        ended.assert_says(&["is there already, and is left as it is", "--force replaces it"]);
        assert_eq!(bench.tree("my"), kept);
    }
    bench.write("slot.cls", &program.replace("MILL,16.", "MILL,12."));
    run(&[&path[..], &["--force"]].concat());
    run(&[&init[..], &["--force"]].concat());
    assert!(bench.read("my/run.toml").contains("\ncutter_diameter_mm = 12.0 "));
    run(&[&robot[..], &["--force"]].concat());
    assert!(!bench.read("my/arm-cell.toml").contains("name = \"table\""));
    // Another cutter has other forces, and other points where they are not straight between two.
    run(&place);
    let export =
        ["export", "my/run.toml", "out/best.csv", "--format", "csv", "--approach-mm", "0", "--out", "my/PROGRAM"];
    run(&export);
    let again = bench.stead(&export);
    assert_eq!(again.code, Some(2));
    again.assert_says(&["PROGRAM.csv: is there already", "--force replaces it"]);
    bench.write("my/PROGRAM.csv", "mine");
    let foreign = bench.stead(&[&export[..], &["--force"]].concat());
    assert_eq!((foreign.code, bench.read("my/PROGRAM.csv").as_str()), (Some(2), "mine"));
    foreign.assert_says(&["PROGRAM.csv: was not written by this command, and is not replaced"]);
    bench.write("my/PROGRAM.csv", "");
    run(&[&export[..], &["--force"]].concat());
    assert!(bench.read("my/PROGRAM.csv").lines().count() > 10);
}

#[test]
fn init_allows_the_spindle_what_the_tool_axis_itself_turns() {
    let bench = bench();
    // 0.78 deg/mm about the feed.
    let rows = (0..12).map(|k| {
        let (sine, cosine) = libm::sincos((0.78 * 10.0 * f64::from(k)).to_radians());
        format!("1,{},0,0,1,0,0,0,{sine},{cosine}\n", 10 * k)
    });
    let head = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z\n";
    bench.write("turning.csv", &(head.to_owned() + &rows.collect::<String>()));
    let init = ["init", "place", "--robot", "name:kuka-kr270-r2700", "--task", "turning.csv", "--out", "run.toml"];
    assert_eq!(bench.stead(&init).code, Some(0));
    let text = bench.read("run.toml");
    for part in
        ["max_spindle_turn_deg_per_mm = 1.0 ", "in space: the tool axis alone turns by up to 0.78 along the path"]
    {
        assert!(text.contains(part), "{part} in {text}");
    }
    let checked = bench.stead(&["check", "run.toml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
}
