//! Bad input from outside: exit code 2, a message that says what and where, nothing on standard output, and every file
//! of the user as it was.

use crate::common::{Bench, Ended, RUN};

const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";
const TASK: &str = "tasks/five-segments.csv";
const PLACE: [&str; 6] = ["--x-mm", "2.2", "--y-mm", "-1643.5", "--z-mm", "-556.4"];

/// A bench with results of an earlier run in the folder `out`.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write_result("place", "out/best.csv", "an earlier result\n");
    bench.write("out/own.txt", "the user's own\n");
    bench
}

/// Runs the command, which must end with exit code 2, the parts in its message, and every file as it was.
#[track_caller]
fn refused(bench: &Bench, arguments: &[&str], parts: &[&str]) -> Ended {
    let before = bench.tree("");
    let ended = bench.stead(arguments);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{arguments:?}: {}", ended.stderr);
    assert!(ended.stderr.starts_with("error: "), "{}", ended.stderr);
    assert!(!ended.stderr.contains("panicked"), "{}", ended.stderr);
    ended.assert_says(parts);
    assert_eq!(bench.tree(""), before);
    ended
}

/// Asserts that all three commands refuse the bench with the same message: one line that begins with a place, has some
/// parts, and says what is allowed and only once what was found.
#[track_caller]
fn refused_by_all(bench: &Bench, place: &str, parts: &[&str]) {
    let placed = refused(bench, &["place", RUN, "--out", "out", "--json"], parts);
    assert!(placed.stderr.starts_with(&format!("error: {place}")), "{place} at the start of {}", placed.stderr);
    assert_eq!(placed.stderr.lines().count(), 1, "{}", placed.stderr);
    assert!(placed.stderr.contains("; allowed: "), "{}", placed.stderr);
    assert!(placed.stderr.matches(", found ").count() <= 1, "{}", placed.stderr);
    let here = [&[RUN][..], &PLACE, &["--q4", "0.9258"]].concat();
    let scored = refused(bench, &[&["score"], &here[..]].concat(), parts);
    let explained = refused(bench, &[&["explain"], &here[..], &["--point", "0", "--beta-deg", "0"]].concat(), parts);
    assert_eq!((&placed.stderr, &placed.stderr), (&scored.stderr, &explained.stderr));
}

/// Asserts that a file with one text replaced is refused at the line of that text, counted here, plus `lines`.
#[track_caller]
fn refused_after(file: &str, from: &str, to: &str, lines: usize, parts: &[&str]) {
    let bench = bench();
    let line = bench.replace(file, from, to) + lines;
    refused_by_all(&bench, &format!("{file}:{line}: "), parts);
}

#[test]
fn files_that_are_not_there_are_named_with_the_file_that_names_them() {
    let bench = bench();
    let parts = ["error: configs/ran.toml: cannot be read", "; allowed: the name of a readable TOML file"];
    refused(&bench, &["place", "configs/ran.toml"], &parts);
    refused(&bench, &["place", "configs"], &["error: configs: cannot be read", "; allowed: "]);
    refused_after(
        RUN,
        "robots/kuka",
        "robots/kuku",
        0,
        &["robot: ", "robots/kuku-kr270-2.toml: ", "found \"robots/kuku"],
    );
    refused_after(RUN, "tasks/five", "tasks/six", 0, &["task: ", "six-segments.csv: ", "found \"../tasks/six"]);
}

#[test]
fn a_run_file_that_breaks_a_rule_is_refused_at_its_line() {
    for (from, to, lines, parts) in [
        ("seed = 1", "seed 1", 0, ["is not readable as TOML", "found 'seed 1 ", "allowed: a TOML file"]),
        (
            "y_mm = [-2240.0, -1640.0]",
            "y_mm = [-2240.0, -1640.0",
            1,
            ["not readable as TOML", "comma", "'z_mm = [-602"],
        ),
        ("five-segments.csv\"", "five-segments.csv", 0, ["not readable as TOML", "string", "found 'task = \"../"]),
        (
            "population = 16",
            "popultion = 16",
            0,
            ["search.popultion: unknown key", "nearest known one: population", "16"],
        ),
        (
            "[search]",
            "[serch]",
            0,
            ["serch: unknown key", "nearest known one: search", "allowed: robot, task, spindle"],
        ),
        ("population = 16", "population = \"many\"", 0, ["search.population: ", "found \"many\"", "from 4 to 100000"]),
        ("population = 16", "population = 16.5", 0, ["is not a whole number", "found 16.5", "from 4 to 100000"]),
        ("population = 16", "population = 3", 0, ["search.population: ", "found 3;", "from 4 to 100000"]),
        ("seed = 1", "seed = -1", 0, ["search.seed: ", "found -1;", "from 0 to 9223372036854775807"]),
        ("\"exact\"", "\"all\"", 0, ["search.postures: ", "found \"all\"", "\"exact\" or \"genetic\""]),
        ("[-300.0, 300.0]", "[300.0, -300.0]", 0, ["cell.x_mm: ", "found [300.0, -300.0]", "min not above max"]),
        ("[-300.0, 300.0]", "[nan, 300.0]", 0, ["cell.x_mm[1]: ", "found nan;", "finite"]),
        ("[-1.0, 1.0]", "[-1.0, 1.5]", 0, ["cell.q4[2]: ", "found 1.5;", "from -1 to 1"]),
        ("beta_step_deg = 7.2", "beta_step_deg = 0", 0, ["redundancy.beta_step_deg: ", "found 0;", "above 0"]),
        ("condition = 0.2", "condition = 1.0", 0, ["min_inverse_condition: ", "found 1.0;", "from 0 to below 1"]),
        // The matrix begins in the line before its second row.
        (
            "    [1.0, 0.0, 0.0],",
            "    [1.0, 0.0, 0.1],",
            0,
            ["spindle.rotation: is no rotation", "third column", "right"],
        ),
        ("    [1.0, 0.0, 0.0],", "    [-1.0, 0.0, 0.0],", 0, ["spindle.rotation: ", "reflection", "right-handed"]),
    ] {
        if from.starts_with("    ") {
            let bench = bench();
            let line = bench.replace(RUN, from, to) - 2;
            refused_by_all(&bench, &format!("{RUN}:{line}: "), &parts);
        } else {
            refused_after(RUN, from, to, lines, &parts);
        }
    }
    let bench = bench();
    let line = bench.replace(RUN, "characteristic_length_mm = 682.0", "") - 2;
    let parts = ["constraints.characteristic_length_mm: is missing", "above 0"];
    refused_by_all(&bench, &format!("{RUN}:{line}: "), &parts);
    let bench = self::bench();
    let line = bench.replace(RUN, "max_beta_rate_deg_per_mm = 0.9", "") - 3;
    let parts = ["redundancy: sets no limit", "at least one of max_beta_rate_deg_per_mm, max_spindle_turn_deg_per_mm"];
    refused_by_all(&bench, &format!("{RUN}:{line}: "), &parts);
}

#[test]
fn a_subset_of_the_path_that_cannot_be_and_a_memory_that_does_not_suffice_are_refused() {
    let cases: [(&str, &[&str]); 6] = [
        (
            "path_points = 106",
            &["search.path_points: ", "the path has 105 points in 5 segments", "found 106;", "from 5 to 105"],
        ),
        (
            "path_points = 4",
            &["search.path_points: ", "the path has 105 points in 5 segments", "found 4;", "from 5 to 105"],
        ),
        ("path_points = 0", &["search.path_points: ", "found 0;", "from 1 to 1000000000"]),
        ("path_points = 20.5", &["search.path_points: ", "is not a whole number", "found 20.5"]),
        (
            "memory_gb = 0.001",
            &["search.memory_gb: ", "planning the 105 points of the path takes", "found 0.001;", "at least 0.00127"],
        ),
        ("memory_gb = 0", &["search.memory_gb: ", "found 0;", "from 0.001"]),
    ];
    for (line, parts) in cases {
        refused_after(RUN, "seed = 1", &format!("seed = 1\n{line}"), 1, parts);
    }
}

#[test]
fn a_robot_file_that_breaks_a_rule_is_refused_at_its_line() {
    let third = "stiffness_mnm_per_rad = 2.79";
    for (from, to, parts) in [
        (third, "stiffness_mnm_per_rad = 0.0", ["joints[3].stiffness_mnm_per_rad: ", "found 0.0;", "above 0"]),
        (third, "stiffness_mnm_per_rad = -2.79", ["joints[3].stiffness_mnm_per_rad: ", "found -2.79;", "above 0"]),
        (third, "stiffness_mnm_per_rad = inf", ["joints[3].stiffness_mnm_per_rad: ", "found inf;", "finite"]),
        (
            third,
            "stifness_mnm_per_rad = 2.79",
            ["joints[3].stifness", "nearest known one: stiffness_mnm", "found 2.79;"],
        ),
        ("min_deg = -245.0", "min_deg = 29.5", ["joints[3].min_deg: ", "below max_deg = 29.0", "found 29.5;"]),
    ] {
        refused_after(ROBOT, from, to, 0, &parts);
    }
    // The line of d_mm is the second after that of alpha_deg; joint 5 is the second with 90 deg.
    let bench = bench();
    bench.replace(ROBOT, "alpha_deg = 90.0\na_mm = 350.0", "alpha_deg = +90.0\na_mm = 350.0");
    let to = "alpha_deg = 90.0\na_mm = 0.0\nd_mm = 12.5";
    let line = bench.replace(ROBOT, "alpha_deg = 90.0\na_mm = 0.0\nd_mm = 0.0", to) + 2;
    let parts = ["joints[5].d_mm: the wrist is not spherical: axes 4, 5 and 6 must meet", "found 12.5;", "one point"];
    refused_by_all(&bench, &format!("{ROBOT}:{line}: "), &parts);
}

/// The published task with one line (from 1) put through a function.
fn with_line(line: usize, change: impl Fn(&str) -> String) -> String {
    let text = Bench::new().read(TASK);
    text.lines().zip(1..).map(|(row, n)| if n == line { change(row) } else { row.to_owned() } + "\n").collect()
}

/// A row with one value (from 0) put in the place of another.
fn with_value(row: &str, column: usize, value: &str) -> String {
    let mut values: Vec<&str> = row.split(',').collect();
    values[column] = value;
    values.join(",")
}

#[test]
fn a_task_that_breaks_a_rule_is_refused_at_its_line() {
    let value = |line, column, value: &str| with_line(line, |row| with_value(row, column, value));
    for (text, line, parts) in [
        (value(5, 10, "NaN"), 5, ["force_x_n: not a finite number", "found 'NaN'", "allowed: a finite decimal number"]),
        (value(106, 1, "inf"), 106, ["x_mm: not a finite number", "found 'inf'", "allowed: a finite"]),
        (value(90, 2, "12,5"), 90, ["this row does not fit its header", "found 14 values", "allowed: 13 values"]),
        (value(7, 3, ""), 7, ["z_mm: not a finite number", "found ''", "allowed: a finite"]),
        (value(30, 0, "4"), 30, ["segment: point 28: segment 4 after segment 2", "found 4;", "allowed: 2 or 3"]),
        (value(30, 0, "1"), 30, ["segment: point 28: segment 1 after segment 2", "found 1;", "allowed: 2 or 3"]),
        (value(2, 0, "0"), 2, ["segment: point 0: ", "found 0;", "allowed: 1 at the start"]),
        (value(30, 0, "2.0"), 30, ["segment: not a segment number", "found '2.0'", "whole numbers from 1"]),
        (value(3, 5, "-0.9"), 3, ["feed: point 1: ", "found length 0.9", "length 1 within"]),
        (
            with_line(4, |row| format!("{row}\n{row}")),
            5,
            ["x_mm,y_mm,z_mm: point 3 repeats", "the point before it", "new"],
        ),
        (value(1, 4, "feed_xx"), 1, ["feed_xx: unknown column", "nearest known one: feed_x", "allowed: segment,x_mm"]),
        (value(1, 5, "feed_x"), 1, ["feed_x: this column is there twice", "allowed: segment,x_mm", "feed_y"]),
        (Bench::new().read(TASK).replace(',', ";"), 1, ["not separated by commas", "found ';'", "allowed: columns"]),
    ] {
        let bench = bench();
        bench.write(TASK, &text);
        // The same lines with the ends that Windows gives them.
        for text in [text.clone(), text.replace('\n', "\r\n")] {
            bench.write(TASK, &text);
            refused_by_all(&bench, &format!("configs/../{TASK}:{line}: "), &parts);
        }
    }
}

#[test]
fn a_task_without_rows_or_columns_is_refused() {
    let bench = bench();
    let whole = bench.read(TASK);
    let without = |column: usize| -> String {
        let row = |row: &str| {
            let values = row.split(',').enumerate().filter(|(c, _)| *c != column);
            values.map(|(_, value)| value).collect::<Vec<_>>().join(",") + "\n"
        };
        whole.lines().map(row).collect()
    };
    let header = whole.lines().next().unwrap();
    for (text, parts) in [
        (without(4), [":1: feed_x: missing column", "; allowed: segment,x_mm,y_mm,z_mm,feed_x"]),
        (without(11), [":1: force_y_n: missing column", "go together; allowed: "]),
        (header.to_owned(), ["the task has no points", "allowed: at least one row under the header"]),
        (String::new(), [":1: segment: missing column", "; allowed: segment,x_mm"]),
    ] {
        bench.write(TASK, &text);
        refused_by_all(&bench, &format!("configs/../{TASK}:"), &parts);
    }
    let path: String = whole.lines().map(|row| row.split(',').take(10).collect::<Vec<_>>().join(",") + "\n").collect();
    bench.write(TASK, &path);
    refused_by_all(
        &bench,
        &format!("{RUN}:8: task: "),
        &["has no force columns", "[tool] and [cut]", "found \"../tasks/five"],
    );
}

#[test]
fn a_folder_that_cannot_be_written_is_refused_before_the_search() {
    let bench = bench();
    bench.write("file", "not a folder\n");
    let allowed = "; allowed: a folder that can be made or written to";
    let parts = ["file: results cannot be written here: a file of that name is there", allowed];
    refused(&bench, &["place", RUN, "--out", "file"], &parts);
    refused(&bench, &["place", RUN, "--out", "file/below/it"], &["it: results cannot be written here: ", allowed]);
    refused(&bench, &["place", RUN, "--out", ""], &["--out <DIR>"]);
    // This folder is there, but not even root writes to it.
    if cfg!(target_os = "linux") {
        refused(&bench, &["place", RUN, "--out", "/proc"], &["/proc: results cannot be written here: ", allowed]);
    }
}

#[test]
fn arguments_out_of_range_are_refused_with_what_is_allowed() {
    let bench = bench();
    let threads = "allowed: a whole number from 1 to 1024";
    let seed = "allowed: a whole number from 0 to 9223372036854775807";
    for (option, value, allowed) in [
        ("--threads", "0", threads),
        ("--threads", "-1", threads),
        ("--threads", "1025", threads),
        ("--threads", "two", threads),
        ("--seed", "-1", seed),
        ("--seed", "1.5", seed),
        ("--seed", "9223372036854775808", seed),
    ] {
        let parts = [&*format!("invalid value '{value}' for '{option}"), allowed];
        refused(&bench, &["place", RUN, "--out", "out", option, value], &parts);
    }
    let finite = "allowed: a finite decimal number";
    let unit = "allowed: a number from -1 to 1";
    let [y, z, q4] = [["--y-mm", "-1643.5"], ["--z-mm", "-556.4"], ["--q4", "0.9258"]];
    for (option, value, allowed, others) in [
        ("--x-mm", "nan", finite, [y, z, q4]),
        ("--x-mm", "-inf", finite, [y, z, q4]),
        ("--x-mm", "2,2", finite, [y, z, q4]),
        ("--q4", "1.5", unit, [["--x-mm", "2.2"], y, z]),
        ("--q4", "nan", unit, [["--x-mm", "2.2"], y, z]),
        ("--yaw-deg", "north", finite, [["--x-mm", "2.2"], y, z]),
    ] {
        let parts = [&*format!("invalid value '{value}' for '{option}"), allowed];
        let here = [&[RUN, option, value][..], &others.concat()].concat();
        refused(&bench, &[&["score"], &here[..]].concat(), &parts);
        refused(&bench, &[&["explain"], &here[..], &["--point", "0", "--beta-deg", "0"]].concat(), &parts);
    }
    let here = [&["explain", RUN][..], &PLACE, &["--q4", "0.9258"]].concat();
    let explain = |more: &[&str], parts: &[&str]| refused(&bench, &[&here[..], more].concat(), parts);
    explain(&["--point", "105", "--beta-deg", "0"], &["--point: ", "found 105;", "allowed: 0 to 104"]);
    explain(
        &["--point", "-1", "--beta-deg", "0"],
        &["invalid value '-1' for '--point", "allowed: a whole number from 0"],
    );
    explain(&["--point", "0", "--beta-deg", "nan"], &["invalid value 'nan' for '--beta-deg", finite]);
}

#[test]
fn a_placement_has_one_yaw_and_all_three_coordinates() {
    let bench = bench();
    let score = [&["score", RUN][..], &PLACE].concat();
    refused(&bench, &score, &["not provided", "--q4 <Q>|--yaw-deg <A>"]);
    let both = [&score[..], &["--q4", "0.5", "--yaw-deg", "60"]].concat();
    refused(&bench, &both, &["'--q4 <Q>' cannot be used with '--yaw-deg <A>'"]);
    refused(&bench, &["score", RUN, "--q4", "0.5", "--x-mm", "0"], &["not provided", "--y-mm <Y>", "--z-mm <Z>"]);
    refused(&bench, &["place"], &["not provided", "<CONFIG>"]);
    refused(&bench, &["plaice", RUN], &["unrecognized subcommand 'plaice'", "place"]);
}

/// Right input, but a job that cannot be done: exit code 1.
#[test]
fn a_cell_out_of_reach_is_told_with_the_reason_and_the_points() {
    let bench = bench();
    bench.replace(RUN, "y_mm = [-2240.0, -1640.0]", "y_mm = [-9240.0, -8640.0]");
    let before = bench.tree("");
    for json in [true, false] {
        let arguments = ["place", RUN, "--out", "out", "--json"];
        let ended = bench.stead(&arguments[..arguments.len() - usize::from(!json)]);
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        ended.assert_says(&[
            "error: no feasible placement was found; the nearest is x = ",
            "segment 1, points 0 to 20: ",
        ]);
        ended.assert_says(&["segment 5, points 84 to 104: ", " mm beyond the stretched arm"]);
        if json {
            let document = ended.json();
            assert_eq!(document["feasible"], false);
            assert_eq!(document["findings"].as_array().unwrap().len(), 5);
        } else {
            assert_eq!(ended.stdout, "");
        }
        assert_eq!(bench.tree(""), before);
    }
}

#[test]
fn the_wrong_kind_of_file_names_the_right_command() {
    let bench = Bench::new();
    let write = |name: &str, text: &str| bench.write(&format!("configs/{name}"), text);
    write("arm.urdf", "<?xml version='1.0'?>\n<robot name='arm'></robot>\n");
    write("arm.xacro", "<robot name='arm' xmlns:xacro='http://ros.org/wiki/xacro'></robot>\n");
    write("part.cls", "TOOL PATH/POCKET,TOOL,MILL\nGOTO/1.,2.,3.\n");
    write("part.nc", "%\nN10 G90 G54\nN20 G0 X0. Y0.\n");
    write("part.step", "ISO-10303-21;\nHEADER;\n");
    write("long.csv", &format!("{}\n1\n", "x".repeat(300)));
    let good = bench.read(RUN);
    let shape = "[[shape]]\nname = 'part'\nattached = 'workpiece'\nmesh = 'part.step'\n";
    for (from, to, parts) in [
        ("robots/kuka-kr270-2.toml", "arm.urdf", ["is a URDF", "stead import robot"]),
        ("robots/kuka-kr270-2.toml", "arm.xacro", ["is a xacro file", "pip install xacro"]),
        ("robots/kuka-kr270-2.toml", "kuka-kr270-2", ["configs/run.toml:", "allowed: \"name:kuka-kr270-2\""]),
        ("robots/kuka-kr270-2.toml", "robots\\kuka.toml", ["configs/run.toml:", "allowed: forward slashes"]),
        ("robots/kuka-kr270-2.toml", "robots\\table.toml", ["configs/run.toml:", "allowed: forward slashes"]),
        ("../tasks/five-segments.csv", "part.cls", ["is CLDATA", "stead import path"]),
        ("../tasks/five-segments.csv", "part.nc", ["is G-code", "stead import path"]),
        ("../tasks/five-segments.csv", "long.csv", ["unknown column", "xxxxx..."]),
        ("beta_step_deg = 7.2", "beta_step_deg = 7,2", ["configs/run.toml:", "allowed: a decimal point"]),
        ("[reference]", &format!("{shape}[reference]"), ["part.step: is a STEP file", "saved as STL or OBJ"]),
    ] {
        bench.write(RUN, &good);
        bench.replace(RUN, from, to);
        let refused = bench.stead(&["check", RUN]);
        assert_eq!((refused.code, refused.stdout.as_str()), (Some(2), ""), "{to}: {}", refused.stderr);
        refused.assert_says(&parts);
        assert!(refused.stderr.lines().all(|line| line.len() < 600), "{}", refused.stderr);
    }
    let task = bench.read("tasks/five-segments.csv");
    bench.write("tasks/five-segments.csv", &task.replacen(",0,", &format!(",{},", "x".repeat(300)), 1));
    bench.write(RUN, &good);
    let long = bench.stead(&["check", RUN]);
    assert_eq!(long.code, Some(2));
    assert!(long.stderr.contains("xxx...'") && long.stderr.len() < 400, "{}", long.stderr);
    for command in [&["check", "kuka-kr500"][..], &["pose", "kuka-kr500", "--joints-deg=0,0,0,0,0,0"]] {
        let bare = bench.stead(command);
        assert_eq!(bare.code, Some(2));
        bare.assert_says(&["kuka-kr500: cannot be read", "allowed: name:kuka-kr500 for the shipped arm of this name"]);
    }
    let init = |robot: &str, task: &str| {
        bench.stead(&["init", "place", "--robot", robot, "--task", task, "--out", "configs/new.toml"])
    };
    init("configs/arm.urdf", "tasks/five-segments.csv").assert_says(&["arm.urdf: is a URDF", "stead import robot"]);
    init("name:kuka-kr500", "configs/part.cls").assert_says(&["part.cls: is CLDATA", "stead import path"]);
    let robot = bench.stead(&["place", "configs/robots/kuka-kr270-2.toml"]);
    assert_eq!(robot.code, Some(2));
    robot.assert_says(&["kuka-kr270-2.toml: is a robot file", "stead init place --robot"]);
}

/// `notes.txt` is a name that people use, and so are others: what no manifest lists is theirs.
#[test]
fn files_of_the_user_are_not_replaced_by_those_of_a_result() {
    for own in ["notes.txt", "setup.svg", "cell.glb"] {
        let bench = Bench::new();
        bench.write(&format!("out/{own}"), "the user's own\n");
        let score = [&["score", RUN, "--out", "out"][..], &PLACE, &["--q4", "0.9258"]].concat();
        for arguments in [&["place", RUN, "--out", "out"][..], &score] {
            let ended = bench.stead(arguments);
            assert_eq!(ended.code, Some(2), "{}", ended.stderr);
            ended.assert_says(&[
                &format!("out/{own}: is none of stead and is left as it is"),
                "; allowed: another folder",
            ]);
        }
        assert_eq!(bench.names("out"), [own]);
        assert_eq!(bench.read(&format!("out/{own}")), "the user's own\n");
    }
}

/// Editors of Windows end lines otherwise, put a mark before the text, or save it as UTF-16.
#[test]
fn files_of_other_editors_are_read_or_refused_in_one_line() {
    let bench = Bench::new();
    assert_eq!(bench.stead(&["place", RUN, "--out", "out"]).code, Some(0));
    let files = [RUN, "configs/robots/kuka-kr270-2.toml", "tasks/five-segments.csv"];
    let texts = files.map(|file| bench.read(file));
    for (file, text) in files.iter().zip(&texts) {
        bench.write(file, &format!("\u{feff}{}", text.replace('\n', "\r\n")));
    }
    assert_eq!(bench.stead(&["place", RUN, "--out", "marked"]).code, Some(0));
    assert_eq!(bench.read("out/best.csv"), bench.read("marked/best.csv"));
    for (file, text) in files.iter().zip(&texts) {
        let wide: Vec<u8> = "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        let before = std::fs::read(bench.path(file)).unwrap();
        std::fs::write(bench.path(file), wide).unwrap();
        let ended = bench.stead(&["place", RUN]);
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(2), 1), "{}", ended.stderr);
        ended.assert_says(&["it is text in UTF-16, which some editors call Unicode: save it as UTF-8"]);
        std::fs::write(bench.path(file), before).unwrap();
    }
}

/// A report of a fault states all of this.
#[test]
fn the_environment_is_stated() {
    let bench = Bench::new();
    let ended = bench.stead(&["check", "--environment"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for part in
        ["(commit ", "program ", "none beside the program", std::env::consts::OS, "can be written to, locks work"]
    {
        assert!(ended.stdout.contains(part), "{part} is not in {}", ended.stdout);
    }
    assert_eq!(bench.names(""), Bench::new().names(""));
    let [mistaken, alone] =
        [&["check", RUN, "--environment"][..], &["check"]].map(|arguments| bench.stead(arguments).code);
    assert_eq!((mistaken, alone), (Some(2), Some(2)));
}

/// Where there is no such file, that beside the program is taken, and that is said.
#[test]
fn files_that_came_with_the_program_are_found_from_any_folder() {
    let [bench, elsewhere] = [Bench::new(), Bench::new()];
    bench.copy("configs/caro-2013.toml", "configs/shipped.toml");
    let run = |arguments: &[&str]| {
        let mut command = elsewhere.command(arguments);
        Ended::from(command.env("STEAD_SHIPPED", bench.path("")).output().unwrap())
    };
    let ended = run(&["check", "configs/shipped.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["note: there is no such file here: ", "shipped.toml came with the program"]);
    assert!(!run(&["check", RUN]).stderr.contains("came with the program"));
    assert_eq!(run(&["check", "configs/other.toml"]).code, Some(2));
}
