//! Runs with a table `[stock]`: forces of what their path removes.

use crate::common::{Bench, RUN};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};
use stead::monitor::Stop;
use stead::{Error, Monitor, Progress};
use stead_model::testing::some;

/// A run of the published path, whose forces are those of what is cut of a slab, 5 mm of it above the path.
fn run_with_stock() -> Bench {
    let bench = Bench::new();
    bench.copy("tasks/five-segments-path.csv", "tasks/five-segments.csv");
    let text = bench.read(RUN);
    bench.write(
        RUN,
        &format!(
            "{text}\n[stock]\nbox_mm = [400, 440, 10]\nxyz_mm = [0, 200, 0]\n[tool]\ncutter_diameter_mm = 16\n\
             teeth = 4\nflute_length_mm = 4\nkt_mpa = 800\nkr = 0.4\nka_mpa = 100\nkte_n_per_mm = 20\n\
             kre_n_per_mm = 20\n[cut]\nspindle_rpm = 20000\n"
        ),
    );
    bench
}

#[test]
fn warnings_of_forces_inside_a_run_are_those_of_the_run() {
    let bench = run_with_stock();
    // Once, before the search.
    let ended = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let of_path = ["warning: the cutter stands in the stock where a segment begins", "warning: material is cut above"];
    for warning in of_path {
        assert_eq!(ended.stderr.matches(warning).count(), 1, "{}", ended.stderr);
    }
    let found = |document: &Value, warning: &str| {
        let all = document["warnings"].as_array().unwrap();
        let text = all.iter().filter_map(Value::as_str).find(|text| text.contains("above the flutes (4 mm)"));
        let text = text.unwrap_or_else(|| panic!("{warning}: {all:?}"));
        // How many, and where the first is.
        assert!(text.contains(" points, first at point 1, (-192, 390.4, 0) mm: "), "{text}");
    };
    found(&serde_json::from_str(&bench.read("out/summary.json")).unwrap(), "place");
    assert!(bench.read("out/report.html").contains("material is cut above the flutes (4 mm)"));
    for command in [
        &["check", RUN, "--json"][..],
        &["score", RUN, "--placement-of", "out", "--json"],
        &["explain", RUN, "--placement-of", "out", "--point", "3", "--beta-deg", "0", "--json"],
    ] {
        let ended = bench.stead(command);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_eq!(ended.stderr.matches(of_path[1]).count(), 1, "{}", ended.stderr);
        found(&ended.json(), command[0]);
    }
}

/// With `keep` the cut is read and gives the same bytes; another cut is computed anew, which is said, and no other file
/// is ever replaced.
#[test]
fn forces_that_are_kept_are_read_to_the_last_bit_and_nothing_else_is_replaced() {
    let bench = run_with_stock();
    let text = bench.read(RUN);
    let with_keep = |text: &str, name: &str| text.replace("[stock]\n", &format!("[stock]\nkeep = '{name}'\n"));
    let lean = "[lean]\nlead_deg = [0, 5]\n";
    let score = |out: &str| {
        let place = ["--x-mm=0", "--y-mm=-1940", "--z-mm=-400", "--yaw-deg=0"];
        let ended = bench.stead(&[&["score", RUN, "--out", out][..], &place].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        ended.stderr
    };
    for (number, text) in some(2, [text.clone(), format!("{text}{lean}")].into_iter().enumerate()) {
        let name = format!("kept/{number}.csv");
        bench.write(RUN, &with_keep(&text, &name));
        let outs = ["made", "read"].map(|word| format!("out-{word}-{number}"));
        let notes = [score(&outs[0]), score(&outs[1])];
        assert_eq!(notes[0].replace(&outs[0], ""), notes[1].replace(&outs[1], ""));
        assert!(!notes[1].contains("computed anew"), "{}", notes[1]);
        let kept = bench.read(&format!("configs/{name}"));
        assert!(kept.starts_with("stead kept forces,1,"), "{}", &kept[..100]);
        assert_eq!(kept.contains("\nlean,"), number == 1);
        for file in ["best-plan.csv", "report.html"] {
            assert_eq!(
                bench.read(&format!("{}/{file}", outs[0])),
                bench.read(&format!("{}/{file}", outs[1])),
                "{file}"
            );
        }
        // Without it there is the same plan.
        bench.write(RUN, &text);
        score(&format!("out-without-{number}"));
        let plan = |out: &str| bench.read(&format!("{out}/best-plan.csv"));
        assert_eq!(plan(&outs[0]), plan(&format!("out-without-{number}")));
        // A number that is not that of the file's own digest is not taken.
        bench.write(&format!("configs/{name}"), &kept.replacen("\nload,", "\nload,1", 1));
        bench.write(RUN, &with_keep(&text, &name));
        let torn = score(&format!("out-torn-{number}"));
        assert!(torn.contains("the forces are computed anew and kept: those in "), "{torn}");
        // A result does not say what was kept before it.
        let page = |out: &str| bench.read(&format!("{out}/report.html"));
        assert_eq!(page(&outs[0]), page(&format!("out-torn-{number}")));
        assert_eq!(
            (plan(&outs[0]), kept),
            (plan(&format!("out-torn-{number}")), bench.read(&format!("configs/{name}")))
        );
    }
    // Of another cut.
    bench.write(RUN, &with_keep(&text, "kept/0.csv").replace("kt_mpa = 800", "kt_mpa = 900"));
    let other = bench.stead(&["check", RUN]);
    assert!(
        other.code == Some(0) && other.stderr.contains("of another stock, path, cutter or program"),
        "{}",
        other.stderr
    );
    // Files of others.
    for (name, allowed) in [("mine.csv", "has no kept forces, and is left as it is"), ("folder", "cannot be read")] {
        bench.write("configs/mine.csv", "x,y\n1,2\n");
        bench.write("configs/folder/in.csv", "");
        bench.write(RUN, &with_keep(&text, name));
        let refused = bench.stead(&["check", RUN]);
        let line = refused.stderr.lines().last().unwrap_or_default();
        assert!(refused.code == Some(2) && line.contains("stock.keep: names a file that"), "{}", refused.stderr);
        assert!(
            line.contains(allowed) && line.contains("; allowed: the name of a file that is not there yet"),
            "{line}"
        );
        assert_eq!(bench.read("configs/mine.csv"), "x,y\n1,2\n");
    }
}

#[test]
fn forces_inside_a_run_say_how_far_they_are_and_stop() {
    let bench = run_with_stock();
    let axis = "[[axis]]\nname = 'depth'\nfield = 'stock.box_mm'\nvalues = [[400, 440, 8], [400, 440, 10]]\n";
    bench.write("study.toml", &format!("base = '{RUN}'\n{axis}"));
    let stages = Arc::new(Mutex::new(BTreeSet::new()));
    let seen = Arc::clone(&stages);
    let monitor = Monitor::new(move |progress| {
        if let Progress::Steps { stage, done, total } = *progress {
            assert!(done <= total);
            seen.lock().unwrap().insert(stage);
        }
    });
    let run = stead::Run::read_with(bench.path(RUN), Vec::new(), &monitor).unwrap();
    assert!(run.warnings().iter().any(|warning| warning.kind == "above-flutes"));
    let known = stages.lock().unwrap().clone();
    assert!(known.contains("cutting") && known.contains("cutting with cells twice as large"), "{known:?}");
    stead::Study::read_with(bench.path("study.toml"), &monitor).unwrap();
    assert!(stages.lock().unwrap().contains("reading cases"));
    // Stopped, there is no run, and that is no fault of the file.
    monitor.stop_handle().stop();
    let stopped = [
        stead::Run::read_with(bench.path(RUN), Vec::new(), &monitor).map(drop),
        stead::Study::read_with(bench.path("study.toml"), &monitor).map(drop),
        stead::Checked::read_with(bench.path(RUN), &monitor).map(drop),
    ];
    for result in stopped {
        let error = result.unwrap_err();
        assert!(matches!(error, Error::Stopped(Stop::Asked)) && error.is_interrupted(), "{error}");
    }
}

/// A ball that may lean in one way alone has, with its forces computed for it, those of a task whose file has tip and
/// axis so; with its forces carried it has others, which a note says.
#[test]
fn a_leaning_ball_has_the_forces_of_a_task_that_leans() {
    let bench = Bench::new();
    let (lead, tilt) = (15.0_f64.to_radians(), (-10.0_f64).to_radians());
    // A = cos T (cos L a + sin L f) + sin T b along x, and the centre of the ball stays.
    let (along, aside, up) = (libm::cos(tilt) * libm::sin(lead), libm::sin(tilt), libm::cos(tilt) * libm::cos(lead));
    let head = "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z\n";
    let row = |x: f64, tip: [f64; 3], axis: [f64; 3]| {
        let [a, b, c] = axis;
        format!("1,{:.6},{:.6},{:.6},1,0,0,{a:.12},{b:.12},{c:.12}\n", x + tip[0], tip[1], tip[2])
    };
    let task = |tip: [f64; 3], axis: [f64; 3]| -> String {
        head.to_owned() + &(0..17).map(|k| row(f64::from(k) * 5.0, tip, axis)).collect::<String>()
    };
    bench.write("tasks/upright.csv", &task([0.0; 3], [0.0, 0.0, 1.0]));
    bench.write("tasks/leaning.csv", &task([-8.0 * along, -8.0 * aside, 8.0 - 8.0 * up], [along, aside, up]));
    let text = bench.read(RUN).replace("[criterion]", "[criterion]\ndirection = 'total'");
    let run = |task: &str, lean: &str| {
        let text = text.replace("../tasks/five-segments.csv", &format!("../tasks/{task}.csv"));
        let tables = "\n[stock]\nbox_mm = [200, 80, 20]\nxyz_mm = [0, 0, -8.5]\n[tool]\ncutter_diameter_mm = 16\ncorner_radius_mm = 8\n\
                      teeth = 4\nflute_length_mm = 40\nkt_mpa = 800\nkr = 0.4\nka_mpa = 100\nkte_n_per_mm = 20\nkre_n_per_mm = 20\n\
                      centre_cutting = true\n[cut]\nspindle_rpm = 20000\n";
        bench.write(RUN, &format!("{text}{tables}{lean}"));
        let place = ["--x-mm=0", "--y-mm=-1940", "--z-mm=-400", "--yaw-deg=0"];
        let ended = bench.stead(&[&["score", RUN, "--out", "out", "--json"][..], &place].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let forces = bench.read("out/best-plan.csv");
        let names: Vec<&str> = forces.lines().next().unwrap().split(',').collect();
        let column = names.iter().position(|name| *name == "force_x_n").unwrap();
        let force = |line: &str| -> [f64; 3] {
            let cells: Vec<f64> = line.split(',').skip(column).take(3).map(|cell| cell.parse().unwrap()).collect();
            [cells[0], cells[1], cells[2]]
        };
        let middle = forces.lines().nth(9).map(force).unwrap();
        (middle, ended.json()["best"]["objective_mm"].as_f64().unwrap(), ended.stderr)
    };
    let lean = "[lean]\nlead_deg = [15, 15]\ntilt_deg = [-10, -10]\n";
    let (of_task, stated, _) = run("leaning", "");
    let (of_lean, found, _) = run("upright", lean);
    let (carried, other, notes) = run("upright", &format!("{lean}force = 'feed'\n"));
    let norm = |force: [f64; 3]| force.iter().map(|part| part * part).sum::<f64>().sqrt();
    let off = |a: [f64; 3], b: [f64; 3]| norm([a[0] - b[0], a[1] - b[1], a[2] - b[2]]) / norm(b);
    assert!(off(of_lean, of_task) < 0.03, "{of_lean:?} {of_task:?}");
    assert!((found / stated - 1.0).abs() < 0.03, "{found} {stated}");
    assert!(off(carried, of_task) > 0.1 && (other / stated - 1.0).abs() > 0.05, "{carried:?} {of_task:?} {other}");
    assert!(notes.contains("lean.force = \"feed\" carries them to the tool that leans"), "{notes}");
}
