//! `stead forces`: a task with forces from a path, its stock and its cutter.

use crate::common::Bench;

/// A slot of 60 mm along x, 3 mm deep, between two moves in the air.
const NC: &str = "G21 G90\nS6000 M3\nG0 X-20 Y0 Z9\nZ-3\nG1 X60 F1200\nX80\nG0 Z9\nM30\n";
const FORCES: &str = "path = 'part.nc'\n[stock]\nbox_mm = [60, 40, 10]\nxyz_mm = [30, 0, -5]\n[tool]\ncutter_diameter_mm = 10\nteeth = 2\n\
                      flute_length_mm = 20\nkt_mpa = 800\nkr = 0.4\nka_mpa = 100\nkte_n_per_mm = 20\nkre_n_per_mm = 20\n";

fn bench(forces: &str, program: &str) -> Bench {
    let bench = Bench::new();
    bench.write("my/forces.toml", forces);
    bench.write("my/part.nc", program);
    bench
}

/// The command is refused with these parts in one line, and nothing is written.
#[track_caller]
fn refused(forces: &str, program: &str, parts: &[&str]) {
    let bench = bench(forces, program);
    let before = bench.tree("my");
    let ended = bench.stead(&["forces", "my/forces.toml", "--out", "my/out.csv"]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(2), ""), "{}", ended.stderr);
    ended.assert_says(parts);
    let line = ended.stderr.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
    assert!(line.contains("; allowed: "), "{}", ended.stderr);
    assert_eq!(bench.tree("my"), before);
}

#[test]
fn a_slot_has_its_force_in_a_task_that_other_commands_read() {
    let bench = bench(FORCES, NC);
    let ended = bench.stead(&["forces", "my/forces.toml", "--out", "my/out.csv", "--json"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let document = ended.json();
    // A slot of 60 mm, 10 mm wide and 3 mm deep; the ends of the cutter are round and out of it.
    let removed = document["removed_mm3"].as_f64().unwrap();
    assert!((removed / 1800.0 - 1.0).abs() < 0.01, "{removed}");
    let text = bench.read("my/out.csv");
    let task = stead_format::task::parse_csv("out.csv".as_ref(), text.as_bytes()).unwrap();
    assert_eq!(task.path.points().len(), document["points"].as_u64().unwrap() as usize);
    let wrenches = task.wrenches.unwrap();
    let middle = task.path.points().iter().position(|point| (point.position.x - 0.03).abs() < 5.1e-3).unwrap();
    // Fx of a slot: -N a_p (K_r f_z / 4 + K_te 2 / pi ..), the mean of the closed form; f_z = 0.1 mm.
    let [fz, ap, teeth, pi] = [0.1, 3.0, 2.0, std::f64::consts::PI];
    let expected = -teeth * ap * (320.0 * fz / 4.0 + 20.0 / pi);
    let x = wrenches[middle].force.x;
    assert!((x / expected - 1.0).abs() < 0.02, "{x} for {expected}");
    assert!(bench.read("my/out-engagement.csv").starts_with("point,segment,"));
    assert!(bench.read("my/out-forces.json").contains("\"cell_mm\""));
    // What is there is kept without --force, whichever of the files it is.
    let kept = bench.tree("my");
    std::fs::rename(bench.path("my/out.csv"), bench.path("my/away.csv")).unwrap();
    let ended = bench.stead(&["forces", "my/forces.toml", "--out", "my/out.csv"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    ended.assert_says(&["my/out-engagement.csv", "is there already"]);
    // It is told before the work begins.
    assert!(!ended.stderr.contains("note: forces are those of the programmed feed"), "{}", ended.stderr);
    std::fs::rename(bench.path("my/away.csv"), bench.path("my/out.csv")).unwrap();
    let ended = bench.stead(&["forces", "my/forces.toml", "--out", "my/out.csv"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    ended.assert_says(&["is there already", "--force replaces it"]);
    assert_eq!(bench.tree("my"), kept);
    assert_eq!(bench.stead(&["forces", "my/forces.toml", "--out", "my/out.csv", "--force"]).code, Some(0));
    assert_eq!(bench.tree("my"), kept);
    // What is read, and what somebody else has made, is not replaced.
    bench.write("my/own.csv", "mine");
    for (out, part) in [
        ("my/part.nc", "my/part.nc: is read by this command"),
        ("my/own.csv", "my/own.csv: was not written by this command"),
    ] {
        let ended = bench.stead(&["forces", "my/forces.toml", "--out", out, "--force"]);
        assert_eq!(ended.code, Some(2), "{}", ended.stderr);
        ended.assert_says(&[part, "; allowed: another name"]);
    }
    assert_eq!((bench.read("my/own.csv"), bench.read("my/part.nc")), ("mine".to_owned(), NC.to_owned()));
}

#[test]
fn what_is_wrong_is_refused_at_its_place() {
    let bench = bench(&FORCES.replace("box_mm = [60, 40, 10]", "mesh = 'open.obj'"), NC);
    bench.write("my/open.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
    let ended = bench.stead(&["forces", "my/forces.toml", "--out", "my/out.csv"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    ended.assert_says(&["my/forces.toml:3: stock.mesh: is not closed"]);
    let far = FORCES.replace("[30, 0, -5]", "[30, 500, -5]");
    refused(&far, NC, &["my/forces.toml:2: stock: the path never touches the stock"]);
    refused(&FORCES.replace("flute_length_mm = 20\n", ""), NC, &["tool.flute_length_mm: is missing"]);
    let fine = FORCES.replace("[30, 0, -5]", "[30, 0, -5]\ncell_mm = 0.002\nmemory_gb = 0.05");
    refused(&fine, NC, &["my/forces.toml:5: stock.cell_mm: cells of ", " mm fits"]);
    let itself = format!(
        "{FORCES}[[before]]\npath = 'part.nc'\ntool = {{ cutter_diameter_mm = 10, teeth = 2, flute_length_mm = 20 }}\n"
    );
    refused(&itself, NC, &["before[1].path: is the path of the operation itself"]);
    refused(&itself.replace("'part.nc'\ntool", "'../my/part.nc'\ntool"), NC, &["is the path of the operation itself"]);
    refused(FORCES, &NC.replace("F1200", "F0"), &["my/part.nc:5"]);
    refused(&FORCES.replace("path = 'part.nc'", "path = 'part.nc'\npaht = 1"), NC, &["paht", "unknown"]);
}

/// Corners of a cube of 20 mm from a place on, and its triangles, which face outwards, after so many other vertices.
fn cube(from: i32, vertices: i32) -> String {
    let mut text = String::new();
    for [x, y, z] in [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]] {
        text.push_str(&format!("v {} {} {}\n", from + 20 * x, from + 20 * y - 15, 20 * z - 19));
    }
    for triangle in [
        [1, 4, 3],
        [1, 3, 2],
        [1, 2, 6],
        [1, 6, 5],
        [2, 3, 7],
        [2, 7, 6],
        [3, 4, 8],
        [3, 8, 7],
        [4, 1, 5],
        [4, 5, 8],
        [5, 6, 7],
        [5, 7, 8],
    ] {
        let [a, b, c] = triangle.map(|vertex| vertex + vertices);
        text.push_str(&format!("f {a} {b} {c}\n"));
    }
    text
}

#[test]
fn a_mesh_that_crosses_itself_is_refused_and_a_whole_one_is_cut() {
    let of_mesh = FORCES.replace("box_mm = [60, 40, 10]\nxyz_mm = [30, 0, -5]", "mesh = 'stock.obj'");
    for (mesh, is_sound) in [(cube(0, 0), true), (cube(0, 0) + &cube(8, 8), false)] {
        let bench = bench(&of_mesh, NC);
        bench.write("my/stock.obj", &mesh);
        let before = bench.tree("my");
        let ended = bench.stead(&["forces", "my/forces.toml", "--out", "my/out.csv"]);
        if is_sound {
            assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        } else {
            assert_eq!(ended.code, Some(2), "{}", ended.stderr);
            ended.assert_says(&["my/forces.toml:2: stock: the surface of the stock is no closed one", "; allowed: "]);
            assert_eq!(bench.tree("my"), before);
        }
    }
}

/// A task file has no rapid moves: where it begins in the stock, or turns in place there, is told all the same.
#[test]
fn a_task_that_begins_and_turns_in_the_stock_is_warned_of() {
    let task = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,feed_mm_per_s,scored\n\
                1,10,0,-3,1,0,0,0,0,1,20,1\n1,50,0,-3,1,0,0,0,0,1,20,1\n1,50,0,-3,1,0,0,0,0.1961161,0.9805807,20,0\n";
    let of_task = FORCES.replace("part.nc", "part.csv") + "[cut]\nspindle_rpm = 6000\n";
    let run = |task: &str| {
        let bench = bench(&of_task, NC);
        bench.write("my/part.csv", task);
        bench.stead(&["forces", "my/forces.toml", "--out", "my/out.csv"])
    };
    let ended = run(task);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    // Points are counted as in the results, from 0, those that are added among them.
    let start = "warning: the cutter stands in the stock where a segment begins, which gives no force: at point 0, (10, 0, -3) mm";
    ended.assert_says(&[start, "warning: the tool turns in place in the stock, without a feed"]);
    let ended = run(&task.replace(",20,", ",0,"));
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    ended.assert_says(&["my/part.csv:2: feed_mm_per_s: ", "'0'", "; allowed: "]);
}

#[test]
fn files_of_other_commands_are_told_apart() {
    let bench = bench(FORCES, NC);
    let ended = bench.stead(&["place", "my/forces.toml"]);
    assert_eq!(ended.code, Some(2));
    ended.assert_says(&["is a forces file", "stead forces"]);
    let ended = bench.stead(&["forces", crate::common::RUN, "--out", "my/out.csv"]);
    assert_eq!(ended.code, Some(2));
    ended.assert_says(&["is a run file of `stead place`", "stead init forces"]);
}

#[test]
fn dangers_are_warned_of() {
    // Straight down at rapid into the middle of the stock.
    let bench = bench(FORCES, &NC.replace("G0 X-20 Y0 Z9", "G0 X20 Y0 Z9"));
    let ended = bench.stead(&["forces", "my/forces.toml", "--out", "my/out.csv"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["warning: rapid moves go through the stock"]);
}

#[test]
fn a_file_for_a_path_that_is_there_runs() {
    let bench = bench(FORCES, NC);
    let ended = bench.stead(&["init", "forces", "--path", "my/part.nc", "--out", "my/new.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let text = bench.read("my/new.toml");
    assert!(text.contains("path = \"part.nc\"") && text.contains("# spindle_rpm = 6000.0"), "{text}");
    let ended = bench.stead(&["forces", "my/new.toml", "--out", "my/out.csv"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let ended = bench.stead(&["init", "forces", "set"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(bench.path("set/forces.toml").is_file() && bench.path("set/part.nc").is_file());
}
