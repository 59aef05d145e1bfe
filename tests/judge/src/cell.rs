//! What the input files state: arm, spindle, cell, path, shapes; and where all of it is in the frame of the cell.

use crate::arm::Arm;
use crate::path::{self, Point};
use crate::solid::Solid;
use crate::values::{Answer, number, placed, pose, range, rotation, section, sections, text, texts, vector};
use crate::yielding::Beside;
use nalgebra::{Isometry3, Point3, Rotation3, Vector3};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

#[derive(Debug, Clone)]
pub(crate) struct Axis {
    pub name: String,
    pub is_rail: bool,
    pub carries_robot: bool,
    pub direction: Vector3<f64>,
    pub point: Vector3<f64>,
    pub range: [f64; 2],
    pub speed: Option<f64>,
    pub mode: String,
}

impl Axis {
    fn motion(&self, position: f64) -> Isometry3<f64> {
        if self.is_rail {
            return Isometry3::translation(
                self.direction.x * position,
                self.direction.y * position,
                self.direction.z * position,
            );
        }
        let there = Isometry3::translation(self.point.x, self.point.y, self.point.z);
        there * Isometry3::rotation(self.direction * position) * there.inverse()
    }
}

/// What a shape moves with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Frame {
    Cell,
    Part,
    /// From 1; the flange is 6.
    Link(usize),
    /// From 0.
    Axis(usize),
}

#[derive(Clone)]
pub(crate) struct Body {
    pub name: String,
    pub attached: String,
    pub frame: Frame,
    pub pose: Isometry3<f64>,
    pub solid: Solid,
}

pub(crate) struct Zone {
    pub name: String,
    pub points: Vec<String>,
    /// The pose of a box and its half edges.
    edges: Option<(Isometry3<f64>, Vector3<f64>)>,
    /// A point and the direction into the zone.
    half_space: Option<[Vector3<f64>; 2]>,
}

impl Zone {
    /// How deep a point is in it; outside, its distance below zero. m
    pub(crate) fn depth(&self, point: &Vector3<f64>) -> f64 {
        if let Some((pose, half)) = &self.edges {
            let inside = half - (pose.inverse() * Point3::from(*point)).coords.abs();
            let beyond = inside.map(|depth| depth.min(0.0)).norm();
            return if beyond > 0.0 { -beyond } else { inside.min() };
        }
        self.half_space.map_or(f64::NEG_INFINITY, |[at, into]| (point - at).dot(&into))
    }
}

/// Everything that the files of a run state.
pub(crate) struct Cell {
    pub run: Table,
    pub arm: Arm,
    /// Stiffness sets of the criterion.
    pub sets: Vec<Arm>,
    /// What yields beside the arm.
    pub beside: Beside,
    /// Tool frame in the flange frame.
    pub tool: Isometry3<f64>,
    pub mount: Isometry3<f64>,
    pub axes: Vec<Axis>,
    pub orientations: Vec<(String, Rotation3<f64>)>,
    pub points: Vec<Point>,
    pub bodies: Vec<Body>,
    pub pairs: Vec<[usize; 2]>,
    pub zones: Vec<Zone>,
    /// m
    pub clearance: f64,
}

/// Where the part is clamped: in the cell with all axes at zero.
#[derive(Debug, Clone)]
pub(crate) struct Placement {
    pub place: Vector3<f64>,
    pub yaw: f64,
    pub orientation: Rotation3<f64>,
}

/// Where everything is at one moment, in the frame of the cell.
#[derive(Debug, Clone)]
pub(crate) struct Stand {
    /// What carries the robot: the cell where no axis does.
    pub carrier: Isometry3<f64>,
    /// Base of the rows, then the frames of the rows.
    pub frames: [Isometry3<f64>; 7],
    pub part: Isometry3<f64>,
    pub tool: Isometry3<f64>,
    axes: Vec<Isometry3<f64>>,
}

fn parse(file: &Path) -> Answer<Table> {
    let told = |error: String| format!("{}: {error}", file.display());
    let content = std::fs::read_to_string(file).map_err(|error| told(error.to_string()))?;
    content.parse().map_err(|error: toml::de::Error| told(error.to_string()))
}

impl Cell {
    pub(crate) fn read(file: &Path) -> Answer<Self> {
        let run = parse(file)?;
        let folder = file.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        let beside = |key: &str| text(&run, key).map(|name| folder.join(name)).ok_or_else(|| format!("no {key}"));
        let arm = Arm::read(&beside("robot")?)?;
        let criterion = section(&run, "criterion");
        let set_files = criterion.and_then(|table| texts(table, "robots")).unwrap_or_default();
        let sets = set_files.iter().map(|name| Arm::read(&folder.join(name))).collect::<Answer<Vec<_>>>()?;
        let tool = pose(section(&run, "spindle").ok_or("no spindle")?)?;
        let around = text(&run, "surroundings").map(|name| folder.join(name));
        let around = around.map(|file| Ok::<_, String>((parse(&file)?, file))).transpose()?;
        // In the run, or in its surroundings.
        let mounts = [Some(&run), around.as_ref().map(|(table, _)| table)];
        let mount = mounts.into_iter().flatten().find_map(|table| section(table, "mount"));
        let mount = mount.map_or(Ok(Isometry3::identity()), pose)?;
        let axes = sections(&run, "external_axis").into_iter().map(axis).collect::<Answer<Vec<_>>>()?;
        let cell = section(&run, "cell").ok_or("no cell")?;
        let mut orientations = Vec::new();
        for table in sections(cell, "orientations") {
            orientations.push((text(table, "name").unwrap_or_default().to_owned(), rotation(table)?));
        }
        if let Some(name) = text(cell, "orientation") {
            orientations.retain(|(known, _)| known == name);
        }
        let mut points = path::read(&beside("task")?, &run)?;
        if run.contains_key("stock") {
            points = path::with_stock(&points, &folder.join(path::WITH_STOCK), &run)?;
        }
        let mut all = Self {
            arm,
            sets,
            beside: Beside::read(&run),
            tool,
            mount,
            axes,
            orientations,
            points,
            bodies: Vec::new(),
            pairs: Vec::new(),
            zones: Vec::new(),
            clearance: 0.01,
            run,
        };
        let mut ignored = Vec::new();
        if let Some((table, file)) = &around {
            all.stand(table, file.parent().unwrap_or(&folder), &mut ignored)?;
        }
        let own = all.run.clone();
        all.stand(&own, &folder, &mut ignored)?;
        all.pair(&ignored);
        Ok(all)
    }

    /// Shapes, zones and clearance of a table.
    fn stand(&mut self, table: &Table, folder: &Path, ignored: &mut Vec<[String; 2]>) -> Answer<()> {
        for shape in sections(table, "shape") {
            let attached = text(shape, "attached").ok_or("a shape attached to nothing")?;
            let frame = match attached {
                "base" => Frame::Cell,
                "workpiece" => Frame::Part,
                "flange" => Frame::Link(6),
                other => match other.strip_prefix("link_").and_then(|number| number.parse().ok()) {
                    Some(number) => Frame::Link(number),
                    None => Frame::Axis(
                        self.axes.iter().position(|axis| axis.name == other).ok_or(format!("no axis {other}"))?,
                    ),
                },
            };
            self.bodies.push(Body {
                name: text(shape, "name").unwrap_or_default().to_owned(),
                attached: attached.to_owned(),
                frame,
                pose: pose(shape)?,
                solid: Solid::read(shape, folder)?,
            });
        }
        for zone in sections(table, "keep_out") {
            let half = vector(zone, "box_mm").map(|edges| edges * 0.5e-3);
            let half_space = section(zone, "half_space")
                .and_then(|table| Some([vector(table, "xyz_mm")? * 1e-3, vector(table, "normal")?.normalize()]));
            self.zones.push(Zone {
                name: text(zone, "name").unwrap_or_default().to_owned(),
                points: texts(zone, "points").unwrap_or_default(),
                edges: half.map(|half| Ok::<_, String>((pose(zone)?, half))).transpose()?,
                half_space,
            });
        }
        if let Some(collision) = section(table, "collision") {
            if let Some(clearance) = number(collision, "clearance_mm") {
                self.clearance = clearance * 1e-3;
            }
            for pair in collision.get("ignore").and_then(Value::as_array).into_iter().flatten() {
                let names: Vec<&str> = pair.as_array().into_iter().flatten().filter_map(Value::as_str).collect();
                if let [a, b] = names[..] {
                    ignored.push([a.to_owned(), b.to_owned()]);
                }
            }
        }
        Ok(())
    }

    /// All pairs but those on one frame, on neighbouring links, and those that may touch.
    fn pair(&mut self, ignored: &[[String; 2]]) {
        let is = |body: &Body, word: &String| body.name == *word || body.attached == *word;
        for a in 0..self.bodies.len() {
            for b in a + 1..self.bodies.len() {
                let [one, other] = [&self.bodies[a], &self.bodies[b]];
                let may_touch =
                    ignored.iter().any(|[p, q]| (is(one, p) && is(other, q)) || (is(one, q) && is(other, p)));
                if !may_touch && meets(one, other) {
                    self.pairs.push([a, b]);
                }
            }
        }
    }

    pub(crate) fn placement(&self, place: Vector3<f64>, yaw: f64, orientation: Option<&str>) -> Answer<Placement> {
        let rotation = match (orientation, &self.orientations[..]) {
            (None, []) => Rotation3::identity(),
            (None, [(_, only)]) => *only,
            (Some(name), all) => all.iter().find(|(known, _)| known == name).ok_or(format!("no orientation {name}"))?.1,
            (None, _) => return Err("the results name no orientation".to_owned()),
        };
        Ok(Placement { place, yaw, orientation: rotation })
    }

    fn carried(&self, positions: &[f64], robot: bool, last: usize) -> Isometry3<f64> {
        let mut pose = Isometry3::identity();
        for (k, axis) in self.axes.iter().enumerate().take(last + 1) {
            if axis.carries_robot == robot {
                pose *= axis.motion(positions[k]);
            }
        }
        pose
    }

    /// Where the axes that carry the part have brought it.
    pub(crate) fn carried_part(&self, positions: &[f64]) -> Isometry3<f64> {
        self.carried(positions, false, self.axes.len())
    }

    /// Where all is with these joint angles (rad) and positions of the external axes (m or rad).
    pub(crate) fn at(&self, placement: &Placement, joints: &[f64; 6], positions: &[f64]) -> Stand {
        let last = self.axes.len();
        let carrier = self.carried(positions, true, last);
        let frames = self.arm.frames(&(carrier * self.mount), joints);
        let clamped = placed(&Rotation3::from_axis_angle(&Vector3::z_axis(), placement.yaw), &placement.place);
        let lies = placed(&placement.orientation, &Vector3::zeros());
        let part = self.carried(positions, false, last) * clamped * lies;
        let axes = (0..last).map(|k| self.carried(positions, self.axes[k].carries_robot, k)).collect();
        Stand { carrier, frames, part, tool: frames[6] * self.tool, axes }
    }

    pub(crate) fn pose_of(&self, stand: &Stand, body: &Body) -> Isometry3<f64> {
        let frame = match body.frame {
            Frame::Cell => Isometry3::identity(),
            Frame::Part => stand.part,
            Frame::Link(number) => stand.frames[number],
            Frame::Axis(number) => stand.axes[number],
        };
        frame * body.pose
    }

    /// The least distance of these pairs of bodies and the pair, where it is below a limit. m
    pub(crate) fn nearest(
        &self,
        bodies: &[Body],
        pairs: &[[usize; 2]],
        stand: &Stand,
        limit: f64,
    ) -> Option<(f64, [usize; 2])> {
        let poses: Vec<Isometry3<f64>> = bodies.iter().map(|body| self.pose_of(stand, body)).collect();
        let mut best: Option<(f64, [usize; 2])> = None;
        for pair in pairs {
            let [a, b] = *pair;
            let within = best.map_or(limit, |(distance, _)| distance);
            if bodies[a].solid.least_distance(&poses[a], &bodies[b].solid, &poses[b]) >= within {
                continue;
            }
            let distance = bodies[a].solid.distance(&poses[a], &bodies[b].solid, &poses[b]);
            if distance < within {
                best = Some((distance, *pair));
            }
        }
        best
    }

    /// How deep the arm is in a zone, and which. m
    pub(crate) fn zone_depth(&self, stand: &Stand) -> Option<(f64, String)> {
        let mut deepest: Option<(f64, String)> = None;
        for zone in &self.zones {
            for point in &zone.points {
                let place = match point.as_str() {
                    "tool" => stand.tool.translation.vector,
                    "wrist" => self.arm.wrist(&stand.frames),
                    _ => stand.frames[3].translation.vector,
                };
                let depth = zone.depth(&place);
                if deepest.as_ref().is_none_or(|(known, _)| depth > *known) {
                    deepest = Some((depth, format!("{point} in {}", zone.name)));
                }
            }
        }
        deepest
    }

    pub(crate) fn setting(&self, table: &str, key: &str) -> Option<f64> {
        number(section(&self.run, table)?, key)
    }
}

/// Two on the flange, or on one frame, stand still against each other; neighbouring links touch where their joint is.
/// What is mounted on the flange is no link.
fn meets(a: &Body, b: &Body) -> bool {
    let are_links = [a, b].iter().all(|body| body.attached.starts_with("link_"));
    match (a.frame, b.frame) {
        (Frame::Link(j), Frame::Link(k)) if are_links => j.abs_diff(k) > 1,
        (a, b) => a != b,
    }
}

fn axis(table: &Table) -> Answer<Axis> {
    let is_rail = text(table, "kind") == Some("rail");
    let (along, span, speed, unit) = match is_rail {
        true => ("direction", "range_mm", "speed_mm_per_s", 1e-3),
        false => ("axis", "range_deg", "speed_deg_per_s", 1_f64.to_radians()),
    };
    Ok(Axis {
        name: text(table, "name").unwrap_or_default().to_owned(),
        is_rail,
        carries_robot: text(table, "carries") == Some("robot"),
        direction: vector(table, along).ok_or("an axis without direction")?.normalize(),
        point: vector(table, "xyz_mm").unwrap_or_else(Vector3::zeros) * 1e-3,
        range: range(table, span, unit).ok_or("an axis without range")?,
        speed: number(table, speed).map(|speed| speed * unit),
        mode: text(table, "use").unwrap_or_default().to_owned(),
    })
}
