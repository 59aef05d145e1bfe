//! The files of a run for a choice of options.

use crate::cover::{Choice, Random, value_of};
use crate::values::{Answer, number, placed};
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
    /// Where the part may be: the middle of the cell. m
    part: Vector3<f64>,
    /// Height of axis 2, distance of axis 2 from axis 1, upper arm and forearm. m
    sizes: [f64; 4],
    tool: Isometry3<f64>,
}

/// Writes the files of a choice into a folder that is there. Robots are those of `robots`, a folder of robot files, with a stiffness of
/// the choice.
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
        run: "robot = \"robot.toml\"\ntask = \"task.csv\"\nstiffness_like = \"made up\"\n".to_owned(),
        mount: Isometry3::identity(),
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
    let (shapes, mesh) = writer.shapes();
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
    Ok(Files { run, toml, program, part_moves })
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
        if let Some(controller) = table.get_mut("controller").and_then(Value::as_table_mut) {
            let is_fanuc = controller.get("kind").and_then(Value::as_str) == Some("fanuc");
            controller.insert("is_j3_level".to_owned(), Value::from(is_fanuc));
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
            joints.push(Value::Table(kept));
        }
        table.insert("joints".to_owned(), Value::Array(joints));
        if self.of("confidence") != "none" {
            let scale = 0.04;
            let names = ["joints[1].compliance_urad_per_nm", "joints[3].compliance_urad_per_nm"].map(str::to_owned);
            let mut covariance = Table::new();
            covariance.insert("parameters".to_owned(), Value::from(names.to_vec()));
            let square = scale * scale;
            let rows = vec![Value::from(vec![square, 0.3 * square]), Value::from(vec![0.3 * square, square])];
            covariance.insert("matrix".to_owned(), Value::Array(rows));
            table.insert("covariance".to_owned(), Value::Table(covariance));
        }
        toml::to_string(&table).unwrap_or_default()
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
            self.line(format_args!("\n[mount]\nxyz_mm = {xyz}\n{turned}"));
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
        self.line(format_args!("\n[spindle]\nxyz_mm = {xyz}\n{turned}\nmass_kg = 20.0\ncentre_of_mass_mm = [0.0, 0.0, 120.0]\ninertia_kg_m2 = {{ xx = 0.4, yy = 0.4, zz = 0.1 }}"));
        let middle = self.part * 1e3;
        let wide = if self.of("cell") == "range" { 60.0 } else { 0.0 };
        let span = |at: f64, half: f64| list([(at - half).round(), (at + half).round()]);
        let aside = [0, 1, 2].map(|_| self.random.between(-50.0, 50.0));
        let (x, y, z) =
            (span(middle.x + aside[0], wide), span(middle.y + aside[1], wide), span(middle.z + aside[2], wide));
        let turn = self.random.between(-0.2, 0.1);
        self.line(format_args!(
            "\n[cell]\nx_mm = {x}\ny_mm = {y}\nz_mm = {z}\nq4 = {}",
            list([turn - wide / 200.0, turn + wide / 200.0])
        ));
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
                "\n[[external_axis]]\nname = \"{name}\"\nkind = \"rail\"\ncarries = \"{carries}\"\ndirection = [0.2, 1.0, 0.0]\nrange_mm = [-180.0, 150.0]\nspeed_mm_per_s = 400.0\nuse = \"{mode}\""
            )
        };
        let table = |name: &str, carries: &str, axis: &str, at: &str, most: f64, mode: &str| {
            format!(
                "\n[[external_axis]]\nname = \"{name}\"\nkind = \"turntable\"\ncarries = \"{carries}\"\naxis = {axis}\nxyz_mm = {at}\nrange_deg = {}\nspeed_deg_per_s = 50.0\nuse = \"{mode}\"",
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
        if self.of("confidence") != "none" {
            let _ = writeln!(text, "confidence = {}", self.of("confidence"));
        }
        if self.of("sets") != "one" {
            let _ = writeln!(text, "robots = [\"robot.toml\", \"softer.toml\"]\nover = \"{}\"", self.of("sets"));
        }
        if self.of("segment weights") != "none" {
            text.push_str("\n[[segment]]\nnumber = 1\nweight = 2.5\n");
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
        text.push_str("\n[postures]\n");
        match self.of("postures") {
            "some" => text.push_str("allowed = [1, 2, 3, 4]\n"),
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
                "\n[forces]\nfeed_n = -150.0\nnormal_n = -90.0\naxis_n = 40.0\n\n[[forces.segment]]\nnumber = 1\nfeed_n = 60.0\nnormal_n = 200.0\naxis_n = 10.0\n",
            ),
            load @ ("conventional" | "climb") => {
                let _ = writeln!(
                    text,
                    "\n[cut]\nmilling = \"{load}\"\nradial_depth_mm = 3.0\naxial_depth_mm = 4.0\nfeed_per_tooth_mm = 0.06\nconcave_corners = \"left\""
                );
            }
            _ => {}
        }
        if self.of("tool") != "none" {
            text.push_str("\n[tool]\ncutter_diameter_mm = 16.0\n");
            if matches!(self.of("load"), "conventional" | "climb") {
                text.push_str("teeth = 3\nrotation = \"counterclockwise\"\nkt_mpa = 800.0\nkr = 0.4\nkte_n_per_mm = 20.0\nkre_n_per_mm = 15.0\n");
            }
            if self.of("tool") == "holder" {
                text.push_str("flute_length_mm = 30.0\nholder_mm = [[25.0, 16.0], [40.0, 50.0]]\n");
            }
        }
        self.run.push_str(&text);
    }

    /// The tool path, about the origin of the part, some 120 mm wide.
    fn task(&mut self) -> String {
        struct Step {
            segment: usize,
            place: Vector3<f64>,
            feed: Vector3<f64>,
            axis: Vector3<f64>,
            scored: bool,
        }
        let mut steps: Vec<Step> = Vec::new();
        let mut add = |segment: usize, place: Vector3<f64>, feed: Vector3<f64>, axis: Vector3<f64>| {
            steps.push(Step { segment, place, feed: feed.normalize(), axis: axis.normalize(), scored: true });
        };
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        match self.of("path") {
            "raster" => (0..5).for_each(|k| add(1, x * (25.0 * f64::from(k) - 50.0) - y * 20.0, x, z)),
            "contour" => (0..4).for_each(|k| add(1, x * (20.0 * f64::from(k) - 60.0), x, z)),
            "tilted" => (0..5).for_each(|k| {
                let k = f64::from(k);
                add(1, x * (20.0 * k - 50.0) + z * k * k, x, z + x * (0.06 * k - 0.1) + y * 0.15);
            }),
            _ => (0..7).for_each(|k| {
                add(1, x * (15.0 * f64::from(k) - 50.0) + y * f64::from(k * k), x + y * 0.1 * f64::from(k), z)
            }),
        }
        match self.of("path") {
            "raster" => (0..5).for_each(|k| add(2, x * (50.0 - 25.0 * f64::from(k)) + y * 20.0, -x, z)),
            "contour" => {
                (0..4).for_each(|k| add(2, y * (20.0 * f64::from(k)), y, z));
                (0..5).for_each(|k| {
                    let angle = f64::from(k) * 0.35;
                    add(
                        3,
                        (x * (angle.cos() - 1.0) + y * angle.sin()) * 50.0 + y * 60.0,
                        y * angle.cos() - x * angle.sin(),
                        z,
                    );
                });
            }
            "tilted" => (0..4).for_each(|k| add(2, y * (20.0 * f64::from(k)) - z * 5.0, y, z - y * 0.2)),
            _ => {}
        }
        match self.of("unscored") {
            "plunge" => {
                let mut at = 0;
                while at < steps.len() {
                    if at == 0 || steps[at].segment != steps[at - 1].segment {
                        for height in [10.0, 20.0] {
                            let first = &steps[at];
                            let place = first.place + first.axis * height;
                            let above = Step {
                                segment: first.segment,
                                place,
                                feed: first.feed,
                                axis: first.axis,
                                scored: false,
                            };
                            steps.insert(at, above);
                        }
                        at += 2;
                    }
                    at += 1;
                }
            }
            "turn in place" => {
                if let Some(last) = steps.last() {
                    let (segment, place, feed) = (last.segment, last.place, last.feed);
                    let aside = last.axis.cross(&feed);
                    let axis = (last.axis + aside * 0.12).normalize();
                    steps.push(Step { segment, place, feed, axis, scored: false });
                    steps.push(Step { segment, place: place + feed * 15.0, feed, axis, scored: true });
                }
            }
            _ => {}
        }
        let load = self.of("load");
        let (has_forces, has_moments) = (matches!(load, "task" | "moments"), load == "moments");
        let (has_feeds, has_scored) = (self.of("feeds") == "task", self.of("unscored") != "none");
        let mut text =
            "segment,x_mm,y_mm,z_mm,feed_x,feed_y,feed_z,axis_x,axis_y,axis_z,normal_x,normal_y,normal_z".to_owned();
        for (is_there, names) in [
            (has_forces, ",force_x_n,force_y_n,force_z_n"),
            (has_moments, ",moment_x_nm,moment_y_nm,moment_z_nm"),
            (has_feeds, ",feed_mm_per_s"),
            (has_scored, ",scored"),
        ] {
            text.push_str(if is_there { names } else { "" });
        }
        text.push('\n');
        for step in &steps {
            let normal = (step.axis + step.feed.cross(&step.axis) * 0.5).normalize();
            let mut numbers: Vec<f64> =
                [step.place, step.feed, step.axis, normal].iter().flat_map(|v| [v.x, v.y, v.z]).collect();
            if has_forces {
                numbers.extend([-120.0, 80.0, 60.0].map(|force| force * self.random.between(0.5, 1.5)));
            }
            if has_moments {
                numbers.extend([3.0, -2.0, 1.0].map(|moment| moment * self.random.between(0.5, 1.5)));
            }
            if has_feeds {
                numbers.push(self.random.between(15.0, 45.0).round());
            }
            let words: Vec<String> = numbers.iter().map(|number| format!("{number:.9}")).collect();
            let _ = write!(text, "{},{}", step.segment, words.join(","));
            let _ = writeln!(
                text,
                "{}",
                if !has_scored {
                    ""
                } else if step.scored {
                    ",1"
                } else {
                    ",0"
                }
            );
        }
        text
    }

    /// Surroundings, and a mesh file where they name one.
    fn shapes(&mut self) -> (String, Option<(&'static str, Vec<u8>)>) {
        let kind = self.of("shapes");
        if kind == "none" {
            return (String::new(), None);
        }
        let key = self.key;
        let mut text = String::new();
        let mut shape =
            |name: &str, attached: &str, form: &str, place: Vector3<f64>, turned: Option<Rotation3<f64>>| {
                let turned = turned.map_or(String::new(), |rotation| format!("{}\n", angles(key, &rotation)));
                let _ = writeln!(
                    text,
                    "[[shape]]\nname = \"{name}\"\nattached = \"{attached}\"\n{form}\nxyz_mm = {}\n{turned}",
                    vector(&(place * 1e3))
                );
            };
        let spindle = (self.tool * Point3::new(0.0, 0.0, -0.19)).coords;
        let along = self.tool.rotation.to_rotation_matrix();
        let mut mesh = None;
        if kind == "hull" {
            shape("spindle", "flange", "hull = \"body.obj\"\nunit = \"m\"", spindle, Some(along));
            mesh = Some(("body.obj", block_obj([0.07, 0.07, 0.18]).into_bytes()));
        } else {
            shape("spindle", "flange", "capsule_mm = { radius = 40.0, length = 120.0 }", spindle, Some(along));
        }
        if kind == "mesh" {
            shape("part", "workpiece", "mesh = \"part.stl\"", Vector3::new(0.0, 0.01, -0.052), None);
            mesh = Some(("part.stl", block_stl([170.0, 190.0, 80.0])));
        } else {
            shape("part", "workpiece", "box_mm = [170.0, 190.0, 80.0]", Vector3::new(0.0, 0.01, -0.052), None);
        }
        shape("table", "workpiece", "box_mm = [260.0, 260.0, 30.0]", Vector3::new(0.0, 0.0, -0.12), None);
        if kind == "cell" {
            let [_, _, upper, forearm] = self.sizes;
            let arm = format!("capsule_mm = {{ radius = 110.0, length = {:.1} }}", upper * 1e3);
            shape("upper arm", "link_2", &arm, Vector3::new(upper / 2.0, 0.0, 0.0), Some(about(Vector3::y(), 90.0)));
            let arm = format!("cylinder_mm = {{ radius = 90.0, length = {:.1} }}", forearm * 400.0);
            shape("forearm", "link_4", &arm, Vector3::new(0.0, 0.0, -0.55 * forearm), None);
            let floor = self.part.z - 0.55;
            shape("floor", "base", "box_mm = [5000.0, 5000.0, 60.0]", Vector3::new(self.part.x, 0.0, floor), None);
            shape(
                "fence",
                "base",
                "box_mm = [2500.0, 30.0, 1500.0]",
                Vector3::new(self.part.x, 1.4, floor + 0.8),
                Some(about(Vector3::z(), 8.0)),
            );
            shape(
                "clamp",
                "workpiece",
                "cylinder_mm = { radius = 12.0, length = 40.0 }",
                Vector3::new(0.1, 0.11, 0.01),
                None,
            );
        }
        if let Some(axis) = match self.of("axes") {
            axes if axes.starts_with("table")
                || axes == "held"
                || axes.ends_with("table") && axes.starts_with("rail") =>
            {
                Some("turn")
            }
            "tilt and turn" => Some("tilt"),
            "part rail continuous" => Some("slide"),
            _ => None,
        } {
            shape("carrier", axis, "box_mm = [300.0, 300.0, 40.0]", self.part - Vector3::z() * 0.29, None);
        }
        if kind == "cell" {
            let far = vector(&((self.part - Vector3::new(0.0, 1.6, 0.0)) * 1e3));
            let _ = writeln!(
                text,
                "[[keep_out]]\nname = \"door\"\npoints = [\"tool\", \"wrist\", \"elbow\"]\nhalf_space = {{ xyz_mm = {far}, normal = [0.0, -1.0, 0.0] }}\n"
            );
            let place = vector(&((self.part + Vector3::new(0.3, 0.5, 0.3)) * 1e3));
            let turned = angles(key, &about(Vector3::z(), 20.0));
            let _ = writeln!(
                text,
                "[[keep_out]]\nname = \"cabinet\"\npoints = [\"wrist\", \"elbow\"]\nbox_mm = [200.0, 200.0, 600.0]\nxyz_mm = {place}\n{turned}\n"
            );
        }
        let clearance = if kind == "cell" { 4.0 } else { 6.0 };
        let ignore = match kind {
            "cell" => {
                "[[\"link_2\", \"link_4\"], [\"table\", \"carrier\"], [\"part\", \"carrier\"], [\"floor\", \"link_2\"]]"
            }
            _ => "[[\"table\", \"carrier\"], [\"part\", \"carrier\"]]",
        };
        let has_carrier = text.contains("\"carrier\"");
        let ignore = if has_carrier {
            ignore.to_owned()
        } else {
            ignore
                .replace("[\"table\", \"carrier\"], [\"part\", \"carrier\"]", "")
                .replace(", ,", ",")
                .replace("[, ", "[")
        };
        let ignore = if ignore == "[]" { String::new() } else { format!("ignore = {ignore}\n") };
        let _ = writeln!(text, "[collision]\nclearance_mm = {clearance}\n{ignore}");
        (text, mesh)
    }
}

/// The corners of a block about the origin, and its twelve triangles, outwards.
fn block(edges: [f64; 3]) -> ([Vector3<f64>; 8], [[usize; 3]; 12]) {
    let corner =
        |k: usize| Vector3::from_fn(|axis, _| if k >> axis & 1 == 1 { edges[axis] / 2.0 } else { -edges[axis] / 2.0 });
    let triangles = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    (std::array::from_fn(corner), triangles)
}

fn block_stl(edges: [f64; 3]) -> Vec<u8> {
    let (corners, triangles) = block(edges);
    let mut bytes = vec![b' '; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0_u8; 12]);
        for corner in triangle {
            corners[corner].iter().for_each(|value| bytes.extend((*value as f32).to_le_bytes()));
        }
        bytes.extend([0_u8; 2]);
    }
    bytes
}

fn block_obj(edges: [f64; 3]) -> String {
    let (corners, triangles) = block(edges);
    let mut text = String::new();
    corners.iter().for_each(|c| {
        let _ = writeln!(text, "v {} {} {}", c.x, c.y, c.z);
    });
    triangles.iter().for_each(|t| {
        let _ = writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1);
    });
    text
}
