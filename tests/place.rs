//! `stead place` from outside, on the published case with a small search.

use crate::common::{Bench, Ended, RUN};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// What a placement leaves.
pub const FILES: [&str; 21] = [
    "best-worst-plan.csv",
    "best.csv",
    "cell.glb",
    "cell.svg",
    "convergence.csv",
    "convergence.svg",
    "deflection-map-best.csv",
    "deflection-map-best.svg",
    "deflection-map-worst.csv",
    "deflection-map-worst.svg",
    "manifest.json",
    "notes.txt",
    "page-data.json",
    "placements.csv",
    "refinements.csv",
    "report.html",
    "setup.svg",
    "summary.json",
    "transfers.csv",
    "worst-worst-plan.csv",
    "worst.csv",
];
/// The plans of cases 1 to 4.
const PLANS: [&str; 4] = ["best.csv", "best-worst-plan.csv", "worst.csv", "worst-worst-plan.csv"];
const ROBOT: &str = "configs/robots/kuka-kr270-2.toml";
const TASK: &str = "tasks/five-segments.csv";

/// The run that most tests look at: two threads, JSON, into `out`.
fn placed() -> &'static (Bench, Ended) {
    static PLACED: OnceLock<(Bench, Ended)> = OnceLock::new();
    PLACED.get_or_init(|| {
        let bench = Bench::new();
        let ended = bench.stead(&["place", RUN, "--out", "out", "--threads", "2", "--json"]);
        (bench, ended)
    })
}

/// A CSV file: its rows by column.
pub struct Rows(Vec<BTreeMap<String, String>>);

impl Rows {
    pub fn of(text: &str) -> Self {
        Self(csv::Reader::from_reader(text.as_bytes()).deserialize().map(Result::unwrap).collect())
    }

    pub fn column(&self, name: &str) -> Vec<f64> {
        self.0.iter().map(|row| number(row, name)).collect()
    }
}

fn number(row: &BTreeMap<String, String>, name: &str) -> f64 {
    row[name].parse().unwrap_or_else(|e| panic!("{name}: {e} in {}", row[name]))
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} and not {expected}");
}

#[test]
fn all_files_are_there_and_nothing_else() {
    let (bench, ended) = placed();
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    // In particular no temporary file.
    assert_eq!(bench.names("out"), FILES);
    let mut all: Vec<String> = FILES.map(|file| format!("out/{file}")).to_vec();
    all.extend(["out", "configs", RUN, "configs/robots", ROBOT, "tasks", TASK].map(str::to_owned));
    all.sort();
    assert_eq!(bench.names(""), all);
    for file in FILES {
        assert!(std::fs::metadata(bench.path(&format!("out/{file}"))).unwrap().len() > 100, "{file}");
    }
}

/// The worst placement is neither searched nor planned nor written, and the results say so; the best is the same.
#[test]
fn the_worst_placement_can_be_left_out() {
    let (with_both, _) = placed();
    let bench = Bench::new();
    // Files of an earlier run that had both are removed.
    assert_eq!(bench.stead(&["place", RUN, "--out", "out"]).code, Some(0));
    assert_eq!(bench.names("out"), FILES);
    let certified = ["--set", "certificate.gap_percent=90", "--set", "certificate.time_limit_s=0.5"];
    let ended = bench.stead(&[&["place", RUN, "--no-worst", "--out", "out"], &certified[..]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    ended.assert_says(&["note: the worst placement was not looked for"]);
    assert!(!ended.stdout.contains("worst placement is held by"), "{}", ended.stdout);
    assert!(ended.stdout.contains("No certificate for the worst placement: it was not looked for."));
    let of_worst = ["deflection-map-worst.csv", "deflection-map-worst.svg", "worst-worst-plan.csv", "worst.csv"];
    let mut left: Vec<&str> = FILES.into_iter().filter(|file| !of_worst.contains(file)).collect();
    left.extend(["certificate.json", "open-region.csv", "open-region.svg"]);
    left.sort_unstable();
    assert_eq!(bench.names("out"), left);
    for same in ["best.csv", "best-worst-plan.csv", "deflection-map-best.csv"] {
        assert_eq!(bench.read(&format!("out/{same}")), with_both.read(&format!("out/{same}")), "{same}");
    }
    let rows = |bench: &Bench| Rows::of(&bench.read("out/placements.csv")).0;
    let (alone, both) = (rows(&bench), rows(with_both));
    assert_eq!(alone[..], both[..2]);
    let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    assert_eq!(summary["cases"].as_array().unwrap().len(), 2);
    assert_eq!(summary["search"]["worst"], false);
    let warnings = bench.read("out/certificate.json");
    assert!(!warnings.contains("no-bound") && warnings.contains("\"worst_reason\": \"it was not looked for\""));
    assert!(bench.read("out/report.html").contains("the worst was not looked for"));
    // The page is made again from these files, and its placement can be scored.
    let page = bench.read("out/report.html");
    assert_eq!(bench.stead(&["page", "out"]).code, Some(0));
    assert_eq!(bench.read("out/report.html"), page);
    let third = bench.stead(&["score", RUN, "--placement-of", "out", "--case", "3"]);
    assert_eq!(third.code, Some(2));
    third.assert_says(&["out/summary.json: cases: there is no case 3"]);
    // The key of the run file does the same.
    bench.replace(RUN, "[search]", "[search]\nworst = false");
    let json = bench.stead(&["place", RUN, "--out", "key", "--json"]).json();
    assert_eq!(json["cases"].as_array().unwrap().len(), 2);
    assert_eq!(bench.read("key/best.csv"), bench.read("out/best.csv"));
}

#[test]
fn json_is_one_document_with_four_cases() {
    let (bench, ended) = placed();
    let document = ended.json();
    for key in ["evaluations", "states_per_second", "wall_s"] {
        assert!(document[key].as_f64().unwrap() > 0.0, "{key}");
    }
    assert_eq!((&document["threads"], &document["interrupted"]), (&2.into(), &false.into()));
    let cases = document["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 4);
    let table = Rows::of(&bench.read("out/placements.csv"));
    for (index, case) in cases.iter().enumerate() {
        let row = &table.0[index];
        assert_eq!(
            (case["case"].as_u64(), row["case"].as_str()),
            (Some(index as u64 + 1), ["1", "2", "3", "4"][index])
        );
        for key in ["mean_mm", "max_mm"] {
            assert_eq!(case[key].as_f64(), Some(number(row, key)), "{key}");
        }
        assert_eq!(case["placement"].as_object().unwrap().len(), 5);
        for key in ["x_mm", "y_mm", "z_mm", "q4", "yaw_deg"] {
            assert_eq!(case["placement"][key].as_f64(), Some(number(row, key)), "{key}");
        }
        let plan = case["plan"].as_array().unwrap();
        let rows = Rows::of(&bench.read(&format!("out/{}", PLANS[index])));
        assert_eq!((plan.len(), rows.0.len()), (105, 105));
        for (point, row) in plan.iter().zip(&rows.0) {
            for key in ["point", "segment", "beta_deg", "posture", "inverse_condition", "normal_mm", "score_mm"] {
                assert_eq!(point[key].as_f64(), Some(number(row, key)), "{key}");
            }
            for (joint, angle) in (1..).zip(point["joints_deg"].as_array().unwrap()) {
                assert_eq!(angle.as_f64(), Some(number(row, &format!("theta{joint}_deg"))));
            }
        }
        let mut postures: Vec<Value> = Vec::new();
        for segment in plan.chunk_by(|a, b| a["segment"] == b["segment"]) {
            postures.push(segment[0]["posture"].clone());
        }
        assert_eq!(case["postures"], Value::Array(postures));
    }
}

#[test]
fn summary_says_what_it_comes_from_and_nothing_of_time() {
    let (bench, ended) = placed();
    let text = bench.read("out/summary.json");
    let summary: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!((&summary["seed"], &summary["interrupted"]), (&1.into(), &false.into()));
    let inputs = summary["inputs"].as_array().unwrap();
    assert_eq!(inputs.len(), 3);
    for (input, (role, file)) in inputs.iter().zip([("config", RUN), ("robot", ROBOT), ("task", TASK)]) {
        assert_eq!(input["role"], role);
        assert!(file.ends_with(input["name"].as_str().unwrap().trim_start_matches("../")), "{input}");
        let digest: String = Sha256::digest(bench.read(file)).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(input["sha256"], digest.as_str());
    }
    // The wall of the deflection is that of the part.
    let timeless = text.replace("\"wall\":", "").replace("\"wall\",", "");
    for key in ["wall", "per_second", "threads", "date", "host"] {
        assert!(!timeless.contains(&format!("{key}_")) && !timeless.contains(&format!("\"{key}")), "{key}");
    }
    let mut cases = ended.json()["cases"].clone();
    for case in cases.as_array_mut().unwrap() {
        case.as_object_mut().unwrap().remove("plan");
    }
    assert_eq!(summary["cases"], cases);
    assert_eq!(summary["evaluations"], ended.json()["evaluations"]);
    let table = &summary["table"];
    assert_eq!((&table["used"], &summary["search"]["tables"]), (&true.into(), &"auto".into()));
    assert!(table["rms_error"].as_f64().unwrap() < 1e-3 && table["bytes"].as_u64().unwrap() > 100_000, "{table}");
}

#[test]
fn a_task_that_no_table_holds_is_placed_without_one_and_says_why() {
    let bench = Bench::new();
    let task = bench.read(TASK);
    // The tool leans at one point, along the feed's wall.
    let mut lines = task.lines().map(str::to_owned).collect::<Vec<_>>();
    lines[5] = lines[5].replace(",0,0,1,", ",0.01,0,1,");
    bench.write(TASK, &(lines.join("\n") + "\n"));
    let ended = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    assert!(
        ended.stdout.contains("none of them from a lookup table: the tool is not upright: its axis is 0.573 deg"),
        "{}",
        ended.stdout
    );
    let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    assert_eq!(summary["table"]["used"], false);
    let line = bench.replace(RUN, "seed = 1", "tables = \"always\"\nseed = 1");
    let refused = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    refused.assert_says(&[&format!("run.toml:{line}: search.tables: "), "point 4", "allowed: \"auto\" or \"never\""]);
}

#[test]
fn a_task_with_moments_that_differ_at_every_point_is_placed_by_a_table() {
    let bench = Bench::new();
    let task = bench.read(TASK);
    let moment = |k: usize| format!("{},{},{}", k % 7, k % 5, k % 3);
    let mut lines: Vec<_> = task.lines().enumerate().map(|(k, line)| format!("{line},{}", moment(k))).collect();
    lines[0] = format!("{},moment_x_nm,moment_y_nm,moment_z_nm", task.lines().next().unwrap());
    bench.write(TASK, &(lines.join("\n") + "\n"));
    let ended = bench.stead(&["place", RUN, "--out", "out"]);
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    assert_eq!(summary["table"]["used"], true);
    assert!(summary["table"]["rms_error"].as_f64().unwrap() < 1e-3, "{}", summary["table"]);
}

#[test]
fn worse_is_never_better() {
    let (bench, _) = placed();
    let mean = Rows::of(&bench.read("out/placements.csv")).column("mean_mm");
    assert!(mean[0] <= mean[1] && mean[2] <= mean[3] && mean[0] <= mean[2], "{mean:?}");
    assert!(mean[0] > 0.0);
}

#[test]
fn mean_and_maximum_are_those_of_the_plans() {
    let (bench, _) = placed();
    let table = Rows::of(&bench.read("out/placements.csv"));
    for (row, plan) in table.0.iter().zip(PLANS) {
        let score = Rows::of(&bench.read(&format!("out/{plan}"))).column("score_mm");
        // Seven decimals: half a digit from the rows, half a digit from the mean.
        assert_near(score.iter().sum::<f64>() / score.len() as f64, number(row, "mean_mm"), 1.0001e-7);
        assert_eq!(score.iter().copied().fold(0.0, f64::max), number(row, "max_mm"));
    }
}

/// Every row of every plan against the constraints, from the files alone.
#[test]
fn plans_keep_every_constraint() {
    let (bench, _) = placed();
    let robot: toml::Table = toml::from_str(&bench.read(ROBOT)).unwrap();
    let limit = |joint: usize, key: &str| robot["joints"][joint][key].as_float().unwrap();
    let task = Rows::of(&bench.read(TASK));
    for plan in PLANS {
        let rows = Rows::of(&bench.read(&format!("out/{plan}"))).0;
        assert_eq!(rows.len(), task.0.len());
        for (index, row) in rows.iter().enumerate() {
            assert_eq!((number(row, "point"), &row["segment"]), (index as f64, &task.0[index]["segment"]));
            assert!(number(row, "inverse_condition") >= 0.2, "{plan} {row:?}");
            for joint in 0..6 {
                let angle = number(row, &format!("theta{}_deg", joint + 1));
                let (min, max) = (limit(joint, "min_deg"), limit(joint, "max_deg"));
                assert!((min - 1e-4..=max + 1e-4).contains(&angle), "{plan} {row:?}");
            }
            assert_near(number(row, "normal_mm").abs(), number(row, "score_mm"), 1e-12);
        }
        for pair in rows.windows(2).filter(|pair| pair[0]["segment"] == pair[1]["segment"]) {
            assert_eq!(pair[0]["posture"], pair[1]["posture"]);
            let step = |name: &str| number(&pair[1], name) - number(&pair[0], name);
            let distance = ["x_mm", "y_mm", "z_mm"].map(|axis| step(axis) * step(axis)).iter().sum::<f64>().sqrt();
            let beta = step("beta_deg").rem_euclid(360.0);
            let beta = beta.min(360.0 - beta);
            assert!(beta <= 0.9 * distance + 1e-3, "{plan}: beta by {beta} deg over {distance} mm at {:?}", pair[1]);
            for joint in 0..6 {
                let turn = step(&format!("theta{}_deg", joint + 1)).abs();
                // No faster than the joint can while the tool goes on at the feed.
                let most = limit(joint, "max_speed_deg_per_s") * distance / 66.667;
                assert!(turn <= most + 1e-3, "{plan}: joint {} by {turn} of {most} deg at {:?}", joint + 1, pair[1]);
            }
        }
    }
}

/// Tool centre points are those of the task, turned by the yaw and moved to the placement.
#[test]
fn plans_are_at_the_placement() {
    let (bench, _) = placed();
    let task = Rows::of(&bench.read(TASK)).0;
    let table = Rows::of(&bench.read("out/placements.csv")).0;
    for (place, plan) in table.iter().zip(PLANS) {
        let (sine, cosine) = libm::sincos(number(place, "yaw_deg").to_radians());
        assert_near(libm::sin(number(place, "yaw_deg").to_radians() / 2.0), number(place, "q4"), 2e-6);
        for (row, point) in Rows::of(&bench.read(&format!("out/{plan}"))).0.iter().zip(&task) {
            let [x, y, z] = ["x_mm", "y_mm", "z_mm"].map(|axis| number(point, axis));
            let expected = [
                number(place, "x_mm") + cosine * x - sine * y,
                number(place, "y_mm") + sine * x + cosine * y,
                number(place, "z_mm") + z,
            ];
            for (axis, expected) in ["x_mm", "y_mm", "z_mm"].iter().zip(expected) {
                assert_near(number(row, axis), expected, 1e-3);
            }
        }
    }
}

/// Where `place` and `score` plan alike they agree. The best plan is refined together with the placement, so that on
/// this coarse grid of beta it may be somewhat better than one for the given placement, and no worse.
#[test]
fn score_agrees_with_the_cases() {
    let (bench, ended) = placed();
    for (index, plan) in ["best", "worst", "best", "worst"].iter().enumerate() {
        let case = &ended.json()["cases"][index];
        let [x, y, z, q4] = ["x_mm", "y_mm", "z_mm", "q4"].map(|key| case["placement"][key].to_string());
        let scored = bench.stead(&["score", RUN, "--x-mm", &x, "--y-mm", &y, "--z-mm", &z, "--q4", &q4, "--json"]);
        let (found, mean) = (scored.json()[plan]["mean_mm"].as_f64().unwrap(), case["mean_mm"].as_f64().unwrap());
        let more = if index == 0 { 0.01 } else { 0.001 };
        assert!((0.999 * mean..=(1.0 + more) * mean).contains(&found), "case {}: {found} and {mean}", index + 1);
    }
}

/// The same seed gives the same bytes on any number of threads, over whatever was there; other files stay.
#[test]
fn threads_do_not_change_the_result() {
    let (bench, _) = placed();
    let expected = bench.tree("out");
    let other = Bench::new();
    let text = ["place", RUN, "--out", "a/b/five", "--threads", "5", "--seed", "1"];
    other.write("a/b/five/own.txt", "the user's own\n");
    other.write_result("place", "a/b/five/best.csv", "an earlier result\n");
    let five = other.stead(&text);
    assert_eq!((five.code, five.said().as_str()), (Some(0), ""));
    let mut found = other.tree("a/b/five");
    assert_eq!(found.remove("own.txt"), Some(Some(b"the user's own\n".to_vec())));
    assert_same(&found, &expected);
    for part in ["KUKA KR270-2: 105 points in 5 segments", "on 5 threads; results in a/b/five\n"] {
        assert!(five.stdout.contains(part), "{part} is not in {}", five.stdout);
    }

    let one = other.stead(&["place", RUN, "--threads", "1", "--json"]);
    assert_eq!((one.code, one.json()["threads"].as_u64()), (Some(0), Some(1)));
    // Without --out the folder is named after the run file.
    assert_same(&other.tree("results/run"), &expected);
}

#[track_caller]
fn assert_same(found: &BTreeMap<String, Option<Vec<u8>>>, expected: &BTreeMap<String, Option<Vec<u8>>>) {
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (name, bytes) in found {
        assert!(bytes == &expected[name], "{name} differs");
    }
}

#[test]
fn a_file_that_cannot_be_written_does_not_lose_the_result() {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("out/best.csv")).unwrap();
    let ended = bench.stead(&["place", RUN, "--out", "out", "--json"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    ended.assert_says(&["best.csv"]);
    assert_eq!(ended.json()["cases"].as_array().unwrap().len(), 4);
}

#[test]
fn another_seed_is_another_search() {
    let (bench, _) = placed();
    let other = Bench::new();
    other.replace(RUN, "generations = 3", "generations = 0");
    other.replace(RUN, "basins = 2", "basins = 1");
    let ended = other.stead(&["place", RUN, "--out", "two", "--seed", "2", "--json"]);
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    let first = |text: String| text.lines().nth(1).unwrap().to_owned();
    assert_ne!(first(other.read("two/convergence.csv")), first(bench.read("out/convergence.csv")));
    let summary: Value = serde_json::from_str(&other.read("two/summary.json")).unwrap();
    assert_eq!(summary["seed"], 2);
    // The start of the search does not depend on how long it goes on.
    other.stead(&["place", RUN, "--out", "one", "--seed", "1"]);
    assert_eq!(first(other.read("one/convergence.csv")), first(bench.read("out/convergence.csv")));
}

#[test]
fn postures_may_be_part_of_the_genome() {
    let bench = Bench::new();
    bench.replace(RUN, "postures = \"exact\"", "postures = \"genetic\"");
    bench.replace(RUN, "population = 16", "population = 60");
    bench.replace(RUN, "basins = 2", "basins = 1");
    let ended = bench.stead(&["place", RUN, "--out", "out", "--json"]);
    assert_eq!((ended.code, ended.said().as_str()), (Some(0), ""));
    assert_eq!(bench.names("out"), FILES);
    let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    assert_eq!(summary["search"]["postures"], "genetic");
    let mean = Rows::of(&bench.read("out/placements.csv")).column("mean_mm");
    assert!(mean[0] <= mean[1] && mean[2] <= mean[3] && mean[0] <= mean[2], "{mean:?}");
    // The scheme is held: the best and the worst plan of a placement have the same postures.
    let cases = ended.json()["cases"].clone();
    assert_eq!((&cases[0]["postures"], &cases[2]["postures"]), (&cases[1]["postures"], &cases[3]["postures"]));
}
