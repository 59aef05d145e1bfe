//! The files of a run for a choice of options.

mod cutter;
mod shapes;
mod task;
mod yielding;

use crate::cover::{Choice, Random, value_of};
use crate::values::{Answer, number, placed};
use cutter::STOCK;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// What was written.
pub struct Files {
    /// The run file.
    pub run: PathBuf,
    /// All TOML files, with what kind of file they are: `run`, `robot`, `surroundings`.
    pub toml: Vec<(&'static str, PathBuf)>,
    /// A file for `stead forces` with the stock of the run, where it has one, and the task that it is to write.
    pub forces: Option<[PathBuf; 2]>,
    /// The format of a program, where one is to be exported.
    pub program: Option<&'static str>,
    /// Whether an external axis carries the part, so that a program needs the name of its mechanism.
    pub part_moves: bool,
}

fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    let words: Vec<String> = numbers.into_iter().map(|number| format!("{number:?}")).collect();
    format!("[{}]", words.join(", "))
}

fn vector(v: &Vector3<f64>) -> String {
    list([v.x, v.y, v.z])
}

/// A rotation as a line of a table, in one of the ways in which files state it.
fn angles(key: &str, rotation: &Rotation3<f64>) -> String {
    let (x, y, z) = rotation.euler_angles();
    let [x, y, z] = [x, y, z].map(f64::to_degrees);
    match key {
        "abc_deg" => format!("abc_deg = {}", list([z, y, x])),
        "wpr_deg" | "rpy_deg" => format!("{key} = {}", list([x, y, z])),
        "quaternion_wxyz" => {
            let q = UnitQuaternion::from_rotation_matrix(rotation);
            format!("quaternion_wxyz = {}", list([q.w, q.i, q.j, q.k]))
        }
        _ => {
            let rows: Vec<String> = (0..3).map(|k| list(rotation.matrix().row(k).iter().copied())).collect();
            format!("rotation = [{}]", rows.join(", "))
        }
    }
}

fn about(axis: Vector3<f64>, deg: f64) -> Rotation3<f64> {
    Rotation3::new(axis * deg.to_radians())
}

struct Writer<'a> {
    choice: &'a Choice,
    random: Random,
    key: &'static str,
    run: String,
    /// Base of the rows in the cell.
    mount: Isometry3<f64>,
    /// The table `[mount]`, for the run or its surroundings.
    mount_table: String,
    /// Where the part may be: the middle of the cell. m
    part: Vector3<f64>,
    /// Height of axis 2, distance of axis 2 from axis 1, upper arm and forearm. m
    sizes: [f64; 4],
    tool: Isometry3<f64>,
}

/// Writes the files of a choice into a folder that is there. Robots are those of `robots`, a folder of robot files,
/// with a stiffness of the choice.
///
/// # Errors
/// A sentence where a file cannot be read or written.
pub fn write(choice: &Choice, seed: u64, robots: &Path, folder: &Path) -> Answer<Files> {
    let of = |name: &str| value_of(choice, name);
    let told = |error: std::io::Error| format!("{}: {error}", folder.display());
    let source = robots.join(format!("{}.toml", of("arm")));
    let content = std::fs::read_to_string(&source).map_err(|error| format!("{}: {error}", source.display()))?;
    let arm: Table = content.parse().map_err(|error: toml::de::Error| error.to_string())?;
    let mut writer = Writer {
        choice,
        random: Random::new(seed),
        key: of("angles"),
        run: "robot = \"robot.toml\"\ntask = \"task.csv\"\n".to_owned(),
        mount: Isometry3::identity(),
        mount_table: String::new(),
        part: Vector3::zeros(),
        sizes: sizes(&arm)?,
        tool: Isometry3::identity(),
    };
    let mut toml = Vec::new();
    let names: &[&str] = if of("sets") == "one" { &["robot.toml"] } else { &["robot.toml", "softer.toml"] };
    for (number, name) in names.iter().enumerate() {
        let text = writer.robot(&arm, number);
        std::fs::write(folder.join(name), text).map_err(told)?;
        toml.push(("robot", folder.join(name)));
    }
    writer.place();
    let (mut shapes, mesh) = writer.shapes();
    let mount = std::mem::take(&mut writer.mount_table);
    let is_beside = !shapes.is_empty() && seed % 2 == 1;
    if is_beside { &mut shapes } else { &mut writer.run }.push_str(&mount);
    if !shapes.is_empty() {
        writer.run.insert_str(0, "surroundings = \"cell.toml\"\n");
        std::fs::write(folder.join("cell.toml"), shapes).map_err(told)?;
        toml.push(("surroundings", folder.join("cell.toml")));
    }
    if let Some((name, bytes)) = mesh {
        std::fs::write(folder.join(name), bytes).map_err(told)?;
    }
    writer.settings();
    std::fs::write(folder.join("task.csv"), writer.task()).map_err(told)?;
    let run = folder.join("run.toml");
    std::fs::write(&run, &writer.run).map_err(told)?;
    toml.push(("run", run.clone()));
    let forces = if of("load") == "stock" {
        let [file, task] = ["forces.toml", crate::path::WITH_STOCK].map(|name| folder.join(name));
        // The feed of the run: 0.1 mm a tooth of three at 8000 1/min are 40 mm/s.
        let feed = if of("feeds") == "run" { "feed_per_tooth_mm = 0.1\n" } else { "" };
        let text = format!("path = \"task.csv\"\n{STOCK}{feed}{}", writer.tool());
        std::fs::write(&file, text).map_err(told)?;
        Some([file, task])
    } else {
        None
    };
    let axes = of("axes");
    let part_moves =
        ["table", "tilt", "part rail", "held"].iter().any(|word| axes.contains(word)) && !axes.starts_with("robot");
    let native = match of("arm") {
        arm if arm.starts_with("kuka") => "krl",
        arm if arm.starts_with("abb") => "rapid",
        // The part of a Fanuc cannot move in the cut.
        arm if arm.starts_with("fanuc") && !(part_moves && axes.ends_with("continuous")) => "fanuc",
        _ => "csv",
    };
    let program = match of("program") {
        "native" => Some(native),
        "csv" => Some("csv"),
        _ => None,
    };
    Ok(Files { run, toml, forces, program, part_moves })
}

fn sizes(arm: &Table) -> Answer<[f64; 4]> {
    let rows = arm.get("joints").and_then(Value::as_array).ok_or("no joints")?;
    let of = |row: usize, key: &str| {
        let value = rows.get(row).and_then(Value::as_table).and_then(|row| number(row, key));
        value.map(|mm| mm * 1e-3).ok_or_else(|| format!("no {key}"))
    };
    Ok([of(0, "d_mm")?, of(1, "a_mm")?, of(2, "a_mm")?, of(3, "d_mm")?])
}

impl Writer<'_> {
    fn of(&self, name: &str) -> &'static str {
        value_of(self.choice, name)
    }

    fn line(&mut self, text: impl std::fmt::Display) {
        let _ = writeln!(self.run, "{text}");
    }

    /// The geometry of a shipped arm with a stiffness of our own; set 1 is softer than set 0.
    fn robot(&mut self, arm: &Table, set: usize) -> String {
        let mut table = Table::new();
        for key in ["name", "source", "controller", "root", "payload_kg", "working_radius_mm"] {
            if let Some(value) = arm.get(key) {
                table.insert(key.to_owned(), value.clone());
            }
        }
        table.insert("stiffness_like".to_owned(), Value::from("made up"));
        if self.of("speeds") != "none" {
            table.insert("flange_mm".to_owned(), Value::from(137.0));
        }
        self.model(&mut table);
        if let Some(controller) = table.get_mut("controller").and_then(Value::as_table_mut) {
            let is_fanuc = controller.get("kind").and_then(Value::as_str) == Some("fanuc");
            let is_abb = controller.get("kind").and_then(Value::as_str) == Some("abb");
            // ABB counts axis 3 against the horizontal where a parallelogram drives it.
            let is_level = is_fanuc || (is_abb && self.of("axes 2 and 3") == "linkage");
            controller.insert("is_j3_level".to_owned(), Value::from(is_level));
        }
        if self.of("axes 2 and 3") != "apart" {
            table.insert("axes_2_3".to_owned(), Value::Table(self.joined(arm)));
        }
        let softer = if set == 0 { 1.0 } else { 1.7 };
        let rows = arm.get("joints").and_then(Value::as_array).cloned().unwrap_or_default();
        let mut joints = Vec::new();
        for (j, row) in rows.iter().filter_map(Value::as_table).enumerate() {
            let mut kept = Table::new();
            for key in ["alpha_deg", "a_mm", "d_mm", "min_deg", "max_deg"] {
                if let Some(value) = row.get(key) {
                    kept.insert(key.to_owned(), value.clone());
                }
            }
            let speed = number(row, "max_speed_deg_per_s").unwrap_or(100.0);
            if self.of("speeds") != "none" {
                kept.insert("max_speed_deg_per_s".to_owned(), Value::from(speed));
            }
            if self.of("speeds") == "accelerations" {
                kept.insert("max_acceleration_deg_per_s2".to_owned(), Value::from(speed * 3.0));
                kept.insert("max_jerk_deg_per_s3".to_owned(), Value::from(speed * 20.0));
            }
            let compliance = [0.45, 0.3, 0.36, 2.1, 1.9, 2.6][j.min(5)] * softer * self.random.between(0.7, 1.3);
            match self.of("compliance") {
                "stiffness" => {
                    kept.insert("stiffness_mnm_per_rad".to_owned(), Value::from(1.0 / compliance));
                }
                "range" if j == 1 => {
                    kept.insert("compliance_urad_per_nm".to_owned(), Value::from(vec![compliance, compliance * 1.6]));
                }
                _ => {
                    kept.insert("compliance_urad_per_nm".to_owned(), Value::from(compliance));
                }
            }
            if self.of("compliance") == "compensator" && j == 1 {
                let spring = [
                    ("spring_stiffness_n_per_mm", 140.0),
                    ("a_mm", 700.0),
                    ("l_mm", 180.0),
                    ("alpha_deg", 11.0),
                    ("free_length_mm", 460.0),
                ];
                let table: Table =
                    spring.into_iter().map(|(key, value)| (key.to_owned(), Value::from(value))).collect();
                kept.insert("compensator".to_owned(), Value::Table(table));
            }
            self.normal_springs(&mut kept, j, softer);
            joints.push(Value::Table(kept));
        }
        table.insert("joints".to_owned(), Value::Array(joints));
        if self.of("confidence") != "none" {
            let scale = 0.04;
            let mut covariance = Table::new();
            covariance.insert("parameters".to_owned(), Value::from(self.uncertain()));
            let square = scale * scale;
            let rows = vec![Value::from(vec![square, 0.3 * square]), Value::from(vec![0.3 * square, square])];
            covariance.insert("matrix".to_owned(), Value::Array(rows));
            table.insert("covariance".to_owned(), Value::Table(covariance));
        }
        toml::to_string(&table).unwrap_or_default()
    }

    /// What joins axes 2 and 3: a range of the sum somewhat narrower than those of the joints allow.
    fn joined(&self, arm: &Table) -> Table {
        let rows = arm.get("joints").and_then(Value::as_array).cloned().unwrap_or_default();
        let of = |row: usize, key: &str| {
            rows.get(row).and_then(Value::as_table).and_then(|row| number(row, key)).unwrap_or_default()
        };
        let [least, largest] = ["min_deg", "max_deg"].map(|key| of(1, key) + of(2, key));
        let mut table = Table::new();
        if self.of("axes 2 and 3") == "linkage" {
            table.insert("linkage".to_owned(), Value::from(true));
        }
        table.insert("sum_min_deg".to_owned(), Value::from(least + 0.15 * (largest - least)));
        table.insert("sum_max_deg".to_owned(), Value::from(largest - 0.1 * (largest - least)));
        table
    }

    /// Mount, spindle, external axes and the bounds of the cell.
    fn place(&mut self) {
        let [height, shoulder, upper, forearm] = self.sizes;
        let reach = upper + forearm;
        // Where the part is in the frame of the rows, in which direction the mount turns that.
        let (local, mount, turned) = match self.of("mount") {
            "ceiling" => (
                Vector3::new(shoulder + 0.6 * reach, 0.0, height + 0.5 * reach),
                1.3 + height + 0.5 * reach,
                about(Vector3::x(), 180.0),
            ),
            "wall" => (
                Vector3::new(shoulder + 0.5 * reach, 0.0, height + 0.3 * reach),
                1.2 + shoulder + 0.5 * reach,
                about(Vector3::y(), 90.0),
            ),
            "pedestal" => {
                (Vector3::new(shoulder + 0.6 * reach, 0.0, height - 0.25 * reach), 0.35, Rotation3::identity())
            }
            "tilted" => (
                Vector3::new(shoulder + 0.6 * reach, 0.0, height - 0.15 * reach),
                0.3,
                about(Vector3::y(), 12.0) * about(Vector3::z(), 20.0),
            ),
            _ => (Vector3::new(shoulder + 0.6 * reach, 0.0, height - 0.25 * reach), 0.0, Rotation3::identity()),
        };
        self.mount = placed(&turned, &Vector3::new(0.05 * f64::from(u8::from(mount != 0.0)), 0.0, mount));
        if self.of("mount") == "none" {
            self.mount = Isometry3::identity();
        }
        self.part = (self.mount * Point3::from(local)).coords;
        if self.of("mount") != "none" {
            let (xyz, turned) = (vector(&(self.mount.translation.vector * 1e3)), angles(self.key, &turned));
            self.mount_table = format!("\n[mount]\nxyz_mm = {xyz}\n{turned}\n");
        }
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let (tcp, matrix) = match self.of("spindle") {
            "45 deg" => (Vector3::new(0.0, 0.0, 0.4), Matrix3::new(0.0, -half, half, 1.0, 0.0, 0.0, 0.0, half, half)),
            "90 deg" => (Vector3::new(0.22, 0.0, 0.2), Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)),
            _ => (Vector3::new(0.01, -0.02, 0.3), Matrix3::identity()),
        };
        let spindle = Rotation3::from_matrix_unchecked(matrix);
        self.tool = placed(&spindle, &tcp);
        let (xyz, turned) = (vector(&(tcp * 1e3)), angles(self.key, &spindle));
        let [of_spindle, tables] = self.matrices();
        self.line(format_args!(
            "\n[spindle]\nxyz_mm = {xyz}\n{turned}\nmass_kg = 20.0\ncentre_of_mass_mm = [0.0, 0.0, 120.0]\n\
             inertia_kg_m2 = {{ xx = 0.4, yy = 0.4, zz = 0.1 }}{of_spindle}\n{tables}"
        ));
        let middle = self.part * 1e3;
        let wide = if self.of("cell") == "range" { 60.0 } else { 0.0 };
        let span = |at: f64, half: f64| list([(at - half).round(), (at + half).round()]);
        let aside = [0, 1, 2].map(|_| self.random.between(-50.0, 50.0));
        let (x, y, z) =
            (span(middle.x + aside[0], wide), span(middle.y + aside[1], wide), span(middle.z + aside[2], wide));
        let turn = self.random.between(-0.2, 0.1);
        let turns = [turn - wide / 200.0, turn + wide / 200.0];
        let (key, turns) = match self.of("cell") {
            "range" => ("yaw_deg", turns.map(|q4: f64| (2.0 * q4.asin()).to_degrees())),
            _ => ("q4", turns),
        };
        self.line(format_args!("\n[cell]\nx_mm = {x}\ny_mm = {y}\nz_mm = {z}\n{key} = {}", list(turns)));
        let side = angles(self.key, &about(Vector3::x(), 15.0));
        match self.of("orientations") {
            "one" => self.line(format_args!("orientations = [{{ name = \"tilted\", {side} }}]")),
            "named" => self.line(format_args!(
                "orientations = [{{ name = \"flat\" }}, {{ name = \"tilted\", {side} }}]\norientation = \"tilted\""
            )),
            "choice" => {
                self.line(format_args!("orientations = [{{ name = \"flat\" }}, {{ name = \"tilted\", {side} }}]"))
            }
            _ => {}
        }
        self.axes();
    }

    fn axes(&mut self) {
        let at = vector(&(self.part * 1e3).map(f64::round));
        let rail = |name: &str, carries: &str, mode: &str| {
            format!(
                "\n[[external_axis]]\nname = \"{name}\"\nkind = \"rail\"\ncarries = \"{carries}\"\n\
                 direction = [0.2, 1.0, 0.0]\nrange_mm = [-180.0, 150.0]\nspeed_mm_per_s = 400.0\nuse = \"{mode}\""
            )
        };
        let table = |name: &str, carries: &str, axis: &str, at: &str, most: f64, mode: &str| {
            format!(
                "\n[[external_axis]]\nname = \"{name}\"\nkind = \"turntable\"\ncarries = \"{carries}\"\n\
                 axis = {axis}\nxyz_mm = {at}\nrange_deg = {}\nspeed_deg_per_s = 50.0\nuse = \"{mode}\"",
                list([-most, most])
            )
        };
        let up = "[0.0, 0.0, 1.0]";
        let text = match self.of("axes") {
            "rail fixed" => rail("rail", "robot", "fixed"),
            "rail indexed" => rail("rail", "robot", "indexed"),
            "rail continuous" => rail("rail", "robot", "continuous"),
            "table fixed" => table("turn", "workpiece", up, &at, 60.0, "fixed"),
            "table indexed" => table("turn", "workpiece", up, &at, 60.0, "indexed"),
            "table continuous" => table("turn", "workpiece", up, &at, 40.0, "continuous"),
            "tilt and turn" => {
                table("tilt", "workpiece", "[0.0, 1.0, 0.0]", &at, 25.0, "fixed")
                    + &table("turn", "workpiece", up, &at, 60.0, "indexed")
            }
            "part rail continuous" => rail("slide", "workpiece", "continuous"),
            "robot table indexed" => table("carousel", "robot", up, "[0.0, 0.0, 0.0]", 15.0, "indexed"),
            "rail and table" => {
                rail("rail", "robot", "indexed") + &table("turn", "workpiece", up, &at, 45.0, "indexed")
            }
            "rail and table continuous" => {
                rail("rail", "robot", "continuous") + &table("turn", "workpiece", up, &at, 45.0, "continuous")
            }
            "held" => table("turn", "workpiece", up, &at, 60.0, "fixed").replace("[-60.0, 60.0]", "[20.0, 20.0]"),
            _ => String::new(),
        };
        self.line(text);
    }

    /// All other tables of the run file.
    fn settings(&mut self) {
        let mut text = String::new();
        let margin = self.of("margin");
        let _ = writeln!(
            text,
            "\n[constraints]\nmin_inverse_condition = 0.05\ncharacteristic_length_mm = 682.0\njoint_margin_deg = {margin}"
        );
        match self.of("bounds") {
            "deflection" => text.push_str("max_deflection_mm = 4.0\n"),
            "base distance" => text.push_str("min_base_distance_mm = 400.0\n"),
            _ => {}
        }
        text.push_str("\n[criterion]\n");
        let _ = match self.of("scored") {
            "weights" => writeln!(text, "weights = {{ wall = 1.0, axis = 0.5, feed = 0.2, surface = 0.7 }}"),
            direction => writeln!(text, "direction = \"{direction}\""),
        };
        let _ =
            writeln!(text, "aggregate = \"{}\"\nforce_uncertainty = {}", self.of("aggregate"), self.of("force errors"));
        if self.of("travel weight") != "0" {
            let _ = writeln!(text, "joint_travel_weight_mm_per_rad = {}", self.of("travel weight"));
        }
        if self.of("confidence") != "none" {
            let _ = writeln!(text, "confidence = {}", self.of("confidence"));
        }
        if self.of("sets") != "one" {
            let _ = writeln!(text, "robots = [\"robot.toml\", \"softer.toml\"]\nover = \"{}\"", self.of("sets"));
        }
        if self.of("segment weights") != "none" {
            text.push_str("\n[[segment]]\nnumber = 1\nweight = 2.5\n");
        }
        match self.of("lean") {
            "ball" => text.push_str(
                "\n[lean]\nlead_deg = [-8, 12]\ntilt_deg = [-10, 10]\nmax_lean_deg = 12\nlead_step_deg = 10\ntilt_step_deg = 10\n\
                 \n[[lean.segment]]\nnumber = 1\nlead_deg = [0, 12]\ntilt_deg = [-4, 10]\n",
            ),
            "bull plane" => text.push_str(
                "\n[lean]\nlead_deg = [2, 8]\ntilt_deg = [-3, 3]\nlead_step_deg = 3\ntilt_step_deg = 3\nrule = \"plane\"\nforce = \"tool\"\n\
                 step_over_mm = 12\nscallop_mm = 2\ncontact_tolerance_mm = 0.02\n",
            ),
            _ => {}
        }
        text.push_str("\n[redundancy]\nbeta_step_deg = 15.0\nfeed_mm_per_s = 40.0\n");
        let turns = self.of("turns");
        for (word, line) in [
            ("beta", "max_beta_rate_deg_per_mm = 3.0"),
            ("per mm", "max_spindle_turn_deg_per_mm = 2.5"),
            ("per s", "max_spindle_turn_deg_per_s = 120.0"),
        ] {
            if turns == word || turns == "all" {
                let _ = writeln!(text, "{line}");
            }
        }
        if self.of("beta") != "free" {
            let _ = writeln!(text, "beta = \"{}\"", self.of("beta"));
        }
        text.push_str("\n[postures]\n");
        match self.of("postures") {
            "some" => text.push_str("allowed = [1, 2, 3, 4]\n"),
            "words" => text.push_str("allowed = [\"front\", \"elbow up\", 8]\n"),
            "never" => text.push_str("changes = \"never\"\n"),
            "weighed moves" => text.push_str("move_weight_mm_per_s = 0.001\n"),
            _ => {}
        }
        match self.of("tie") {
            "default" => {}
            tie => {
                let _ = writeln!(text, "tie_percent = {tie}");
            }
        }
        text.push_str("\n[search]\nseed = 3\npopulation = 4\ngenerations = 0\nbasins = 1\n");
        match self.of("search") {
            "never" => text.push_str("tables = \"never\"\n"),
            "genetic" => text.push_str("postures = \"genetic\"\n"),
            "subset" => text.push_str("path_points = 6\n"),
            "best alone" => text.push_str("worst = false\n"),
            _ => {}
        }
        if self.of("transfer") == "stated" {
            text.push_str(
                "\n[transfer]\nacceleration_time_s = 0.3\njerk_time_s = 0.2\nblend_mm = 3.0\nretract_mm = 35.0\n",
            );
        }
        let is_page = self.of("output") == "page";
        let _ = writeln!(text, "\n[output]\nmaps = {is_page}\npage = {is_page}");
        match self.of("load") {
            "forces" => text.push_str("\n[forces]\nfeed_n = -150.0\nnormal_n = -90.0\naxis_n = 40.0\n"),
            "forces by segment" => text.push_str(
                "\n[forces]\nfeed_n = -150.0\nnormal_n = -90.0\naxis_n = 40.0\n\n\
                 [[forces.segment]]\nnumber = 1\nfeed_n = 60.0\nnormal_n = 200.0\naxis_n = 10.0\n",
            ),
            "stock" => text.push_str(STOCK),
            load @ ("conventional" | "climb") => {
                let _ = writeln!(
                    text,
                    "\n[cut]\nmilling = \"{load}\"\nradial_depth_mm = 3.0\naxial_depth_mm = 4.0\nfeed_per_tooth_mm = 0.06\nconcave_corners = \"left\""
                );
            }
            _ => {}
        }
        text.push_str(&self.tool());
        self.run.push_str(&text);
    }
}
