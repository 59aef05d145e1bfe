//! Shipped results as they are, and with mistakes planted in results or in what they are held against: the judge has to
//! find each.

#![allow(clippy::unwrap_used, reason = "a test may panic, in its helpers too")]

use std::path::{Path, PathBuf};
use stead_judge::{Verdict, judge};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A folder with a shipped run, its robot, its task and its results.
struct Case {
    folder: tempfile::TempDir,
}

impl Case {
    fn new() -> Self {
        let case = Self { folder: tempfile::tempdir().unwrap() };
        for (from, to) in [
            ("configs/caro-2013.toml", "configs/run.toml"),
            ("configs/robots/kuka-kr270-2.toml", "configs/robots/kuka-kr270-2.toml"),
            ("tasks/five-segments.csv", "tasks/five-segments.csv"),
        ] {
            case.copy(from, to);
        }
        for name in ["summary.json", "best.csv", "best-worst-plan.csv", "worst.csv", "worst-worst-plan.csv"] {
            case.copy(&format!("results/caro-2013/{name}"), &format!("results/{name}"));
        }
        case
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn copy(&self, from: &str, to: &str) {
        let to = self.path(to);
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(root().join(from), to).unwrap();
    }

    fn change(&self, name: &str, change: impl Fn(&str) -> String) {
        let text = std::fs::read_to_string(self.path(name)).unwrap();
        let changed = change(&text);
        assert_ne!(text, changed, "{name} is as it was");
        std::fs::write(self.path(name), changed).unwrap();
    }

    fn verdict(&self) -> Verdict {
        judge(&self.path("configs/run.toml"), &self.path("results")).unwrap()
    }

    /// The kinds of disagreement.
    fn kinds(&self) -> Vec<String> {
        let mut kinds: Vec<String> =
            self.verdict().disagreements.iter().map(|line| line.split(": ").next().unwrap().to_owned()).collect();
        kinds.dedup();
        kinds
    }

    fn finds(&self, kind: &str) {
        let kinds = self.kinds();
        assert!(kinds.iter().any(|known| known == kind), "{kind} is not among {kinds:?}");
    }
}

/// A column of the row of a path point as another number.
fn altered(text: &str, row: usize, column: &str, by: f64) -> String {
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let at = names.iter().position(|name| *name == column).unwrap();
    let line = |(k, line): (usize, &str)| {
        if k != row + 1 {
            return line.to_owned();
        }
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        cells[at] = format!("{}", cells[at].parse::<f64>().unwrap() + by);
        cells.join(",")
    };
    text.lines().enumerate().map(line).collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn shipped_results_are_right_and_much_is_looked_at() {
    for (name, run) in [("caro-2013", "caro-2013"), ("caro-2013-k1-0.8", "caro-2013-k1-0.8")] {
        let verdict =
            judge(&root().join(format!("configs/{run}.toml")), &root().join(format!("results/{name}"))).unwrap();
        assert!(verdict.disagreements.is_empty(), "{verdict}");
        assert!(
            verdict.checks["position of the tool (m)"] == 420 && verdict.checks["joint limit (rad)"] == 2520,
            "{verdict}"
        );
    }
}

#[test]
fn figures_that_are_wrong_are_found() {
    for (column, by, kind) in [
        ("theta2_deg", 0.002, "position of the tool (m)"),
        ("theta6_deg", 0.002, "orientation of the tool (rad)"),
        ("x_mm", 0.1, "stated position (m)"),
        ("beta_deg", 0.01, "orientation of the tool (rad)"),
        ("posture", 1.0, "posture"),
        ("turn_6", 1.0, "turns"),
        ("inverse_condition", 1e-4, "inverse condition"),
        ("force_y_n", 0.01, "force (N)"),
        ("deflection_z_mm", 1e-4, "deflection (m)"),
        ("normal_mm", 1e-4, "part of the deflection (m)"),
        ("score_mm", 1e-4, "score (m)"),
        ("total_mm", 1e-4, "total deflection (m)"),
    ] {
        let case = Case::new();
        case.change("results/best.csv", |text| altered(text, 40, column, by));
        case.finds(kind);
    }
    for (key, kind) in [
        ("\"objective_mm\": 0.1", "objective (m)"),
        ("\"max_mm\": ", "largest score (m)"),
        ("\"travel_deg\": ", "travel of a move (deg)"),
        ("\"duration_s\": ", "duration of a move (s)"),
    ] {
        let case = Case::new();
        case.change("results/summary.json", |text| {
            let at = text.find(key).unwrap() + key.len();
            format!("{}9{}", &text[..at], &text[at..])
        });
        case.finds(kind);
    }
}

#[test]
fn results_of_another_cell_are_found() {
    for (from, to, kind) in [
        ("[spindle]", "[mount]\nxyz_mm = [0.0, 0.0, 1.0]\n\n[spindle]", "position of the tool (m)"),
        ("xyz_mm = [0.0, 0.0, 684.0]", "xyz_mm = [0.0, 0.0, 684.1]", "position of the tool (m)"),
        ("x_mm = [-300.0, 300.0]", "x_mm = [100.0, 300.0]", "bounds of the cell (m)"),
        ("q4 = [-1.0, 1.0]", "q4 = [-1.0, 0.5]", "bounds of the cell (q4)"),
        ("min_inverse_condition = 0.2", "min_inverse_condition = 0.3", "least inverse condition"),
        ("min_inverse_condition = 0.2", "min_inverse_condition = 0.2\njoint_margin_deg = 20.0", "joint limit (rad)"),
        (
            "min_inverse_condition = 0.2",
            "min_inverse_condition = 0.2\nmin_base_distance_mm = 1700.0",
            "distance from axis 1 (m)",
        ),
        ("min_inverse_condition = 0.2", "min_inverse_condition = 0.2\nmax_deflection_mm = 0.2", "largest score (m)"),
        ("feed_mm_per_s = 66.667", "feed_mm_per_s = 200.0", "joint step (rad)"),
        ("max_beta_rate_deg_per_mm = 0.9", "max_beta_rate_deg_per_mm = 0.7", "rate of beta (rad)"),
        ("max_beta_rate_deg_per_mm = 0.9", "max_spindle_turn_deg_per_mm = 0.7", "turn of the spindle (rad)"),
        ("max_beta_rate_deg_per_mm = 0.9", "max_spindle_turn_deg_per_s = 40.0", "turn of the spindle (rad)"),
        ("tie_percent = 0.0", "tie_percent = 0.0\nallowed = [1, 2]", "allowed posture"),
        ("tie_percent = 0.0", "tie_percent = 0.0\nchanges = \"never\"", "one posture"),
        ("force_uncertainty = 0.0", "force_uncertainty = 0.001", "score (m)"),
        ("beta_step_deg = 3.0", "beta_step_deg = 3.0\nbeta = \"constant_per_segment\"", "beta that stays (rad)"),
        ("force_uncertainty = 0.0", "joint_travel_weight_mm_per_rad = 0.5", "objective (m)"),
        ("force_uncertainty = 0.0", "direction = \"total\"", "score (m)"),
        ("force_uncertainty = 0.0", "aggregate = \"rms\"", "objective (m)"),
    ] {
        let case = Case::new();
        case.change("configs/run.toml", |text| text.replacen(from, to, 1));
        case.finds(kind);
    }
    let case = Case::new();
    case.change("configs/robots/kuka-kr270-2.toml", |text| text.replacen("3.32", "3.33", 1));
    case.finds("deflection (m)");
}

#[test]
fn what_yields_and_was_not_counted_is_found() {
    let small = "[[0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.01]]";
    let six = "[[0.01, 0, 0, 0, 0, 0], [0, 0.01, 0, 0, 0, 0], [0, 0, 0.01, 0, 0, 0], [0, 0, 0, 0.01, 0, 0], \
               [0, 0, 0, 0, 0.01, 0], [0, 0, 0, 0, 0, 0.01]]";
    for (from, to) in [
        ("[cell]", format!("[base_compliance]\nmatrix = {six}\n\n[cell]")),
        ("[cell]", format!("[part_compliance]\num_per_n = {small}\n\n[cell]")),
        ("[spindle]", format!("[spindle]\nmount_matrix = {six}")),
        ("[spindle]", format!("[spindle]\ntip_um_per_n = {small}")),
    ] {
        let case = Case::new();
        case.change("configs/run.toml", |text| text.replacen(from, &to, 1));
        case.finds("deflection (m)");
        case.finds("columns by what yields");
    }
    let robot = "configs/robots/kuka-kr270-2.toml";
    let springs = "[[joints]]\northogonal_compliance_urad_per_nm = 0.1\n";
    let case = Case::new();
    case.change(robot, |text| text.replace("[[joints]]\n", springs));
    assert!(case.verdict().disagreements.is_empty(), "springs of no full set count");
    case.change(robot, |text| text.replacen("\"axes\"", "\"full\"", 1));
    case.finds("deflection (m)");
    case.finds("columns by what yields");
}

#[test]
fn shapes_that_were_not_kept_apart_are_found() {
    let shape = |attached: &str, place: &str| {
        format!(
            "\n[[shape]]\nname = \"post\"\nattached = \"{attached}\"\nbox_mm = [60.0, 60.0, 60.0]\nxyz_mm = {place}\n"
        )
    };
    let case = Case::new();
    // A block on the flange, and one beside the path that it meets.
    case.change("configs/run.toml", |text| {
        format!(
            "{text}{}{}",
            shape("workpiece", "[-150.0, 330.0, 30.0]"),
            shape("flange", "[0.0, 0.0, 640.0]").replace("post", "block")
        )
    });
    let kinds = case.kinds();
    for kind in [
        "clearance at a point (m)",
        "clearance between points (m)",
        "a line out of the cut, or why not",
        "clearance of a joint move (m)",
    ] {
        assert!(kinds.iter().any(|known| known == kind), "{kind} is not among {kinds:?}");
    }
    let case = Case::new();
    let zone = "\n[[keep_out]]\nname = \"door\"\npoints = [\"wrist\"]\nhalf_space = { xyz_mm = [0.0, -1000.0, 0.0], normal = [0.0, -1.0, 0.0] }\n";
    case.change("configs/run.toml", |text| format!("{text}{zone}"));
    case.finds("zone kept out of (m)");
}
