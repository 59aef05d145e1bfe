//! The tool path and what the work does to the tool along it, in the frame of the task file.

use crate::values::{Answer, number, required, section, sections, text};
use nalgebra::{Matrix3, Vector3};
use std::path::Path as File;
use toml::Table;

#[derive(Debug, Clone)]
pub(crate) struct Point {
    /// From 1.
    pub segment: usize,
    pub place: Vector3<f64>,
    /// Feed made normal to the tool axis, left of it, tool axis, as columns.
    pub axes: Matrix3<f64>,
    /// The feed as it is stated.
    pub feed: Vector3<f64>,
    pub normal: Option<Vector3<f64>>,
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
    /// Whether the run states the force in the frame of the tool.
    pub is_of_tool: bool,
    /// How the part yields there, where the task says so. m/N
    pub part: Option<Matrix3<f64>>,
    /// m/s
    pub speed: Option<f64>,
    pub is_scored: bool,
    /// Ranges of lead and tilt, where the task says so. rad
    pub leans: [Option<[f64; 2]>; 2],
}

/// Beside a run with `[stock]`: the task with the forces along it and the points that they add, as `stead forces`
/// writes it from the same tables. The judge removes no material.
pub(crate) const WITH_STOCK: &str = "with-stock.csv";

/// The points of such a task: those of the path itself are there in their order, and the others on the straight line
/// between two of them.
pub(crate) fn with_stock(own: &[Point], file: &File, run: &Table) -> Answer<Vec<Point>> {
    let points = read(file, run)?;
    let mut next = 0;
    for (number, point) in points.iter().enumerate() {
        let is_near = |a: &Vector3<f64>, b: &Vector3<f64>| (a - b).amax() < 1e-8;
        let told = || format!("{}: point {} is none of the task", file.display(), number + 1);
        let of_task = own.get(next).ok_or_else(told)?;
        if is_near(&of_task.place, &point.place) && (of_task.axes - point.axes).amax() < 1e-6 {
            next += 1;
            continue;
        }
        let before = own.get(next.wrapping_sub(1)).ok_or_else(told)?;
        let way = of_task.place - before.place;
        let share = (point.place - before.place).dot(&way) / way.norm_squared();
        let is_between = (0.0..=1.0).contains(&share) && is_near(&(before.place + way * share), &point.place);
        if !is_between || point.segment != of_task.segment || point.is_scored != of_task.is_scored {
            return Err(told());
        }
    }
    if next == own.len() { Ok(points) } else { Err(format!("{}: points of the task are missing", file.display())) }
}

/// Reads the task, with the forces that the run states where the task has none.
pub(crate) fn read(file: &File, run: &Table) -> Answer<Vec<Point>> {
    let told = |error: String| format!("{}: {error}", file.display());
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(file).map_err(|error| told(error.to_string()))?;
    let names: Vec<String> =
        reader.headers().map_err(|error| told(error.to_string()))?.iter().map(str::to_owned).collect();
    let mut points: Vec<Point> = Vec::new();
    let has_forces = names.iter().any(|name| name == "force_x_n");
    for record in reader.records() {
        let record = record.map_err(|error| told(error.to_string()))?;
        let value = |name: &str| {
            let column = names.iter().position(|known| known == name)?;
            record.get(column)?.parse::<f64>().ok()
        };
        let three = |stem: &str, unit: &str| {
            Some(Vector3::new(
                value(&format!("{stem}x{unit}"))?,
                value(&format!("{stem}y{unit}"))?,
                value(&format!("{stem}z{unit}"))?,
            ))
        };
        let missing = || told("a column is missing".to_owned());
        let feed = three("feed_", "").ok_or_else(missing)?.normalize();
        let axis = three("axis_", "").ok_or_else(missing)?.normalize();
        let ahead = (feed - axis * feed.dot(&axis)).normalize();
        points.push(Point {
            segment: value("segment").ok_or_else(missing)? as usize,
            place: three("", "_mm").ok_or_else(missing)? * 1e-3,
            axes: Matrix3::from_columns(&[ahead, axis.cross(&ahead), axis]),
            feed,
            normal: three("normal_", "").map(|normal| normal.normalize()),
            force: three("force_", "_n").unwrap_or_else(Vector3::zeros),
            moment: three("moment_", "_nm").unwrap_or_else(Vector3::zeros),
            is_of_tool: !has_forces,
            part: part(&value),
            speed: value("feed_mm_per_s").map(|speed| speed * 1e-3),
            is_scored: value("scored").is_none_or(|scored| scored != 0.0),
            leans: ["lead", "tilt"].map(|of| {
                let end = |end: &str| value(&format!("{of}_{end}_deg")).map(f64::to_radians);
                Some([end("min")?, end("max")?])
            }),
        });
    }
    if !has_forces && !run.contains_key("stock") {
        load(&mut points, run)?;
    }
    for point in points.iter_mut().filter(|point| !point.is_scored) {
        (point.force, point.moment) = (Vector3::zeros(), Vector3::zeros());
    }
    Ok(points)
}

/// The compliance of the part in the columns of a point.
fn part(value: &dyn Fn(&str) -> Option<f64>) -> Option<Matrix3<f64>> {
    let of = |entry: &str| value(&format!("part_{entry}_um_per_n")).map(|micro| micro * 1e-6);
    let (xy, xz, yz) = (of("xy")?, of("xz")?, of("yz")?);
    Some(Matrix3::new(of("xx")?, xy, xz, xy, of("yy")?, yz, xz, yz, of("zz")?))
}

fn load(points: &mut [Point], run: &Table) -> Answer<()> {
    if let Some(forces) = section(run, "forces") {
        let of = |table: &Table| {
            Ok::<_, String>(Vector3::new(
                required(table, "feed_n")?,
                required(table, "normal_n")?,
                required(table, "axis_n")?,
            ))
        };
        let all = of(forces)?;
        for point in points.iter_mut() {
            let own = sections(forces, "segment")
                .into_iter()
                .find(|table| number(table, "number") == Some(point.segment as f64));
            point.force = point.axes * own.map_or(Ok(all), of)?;
        }
        return Ok(());
    }
    let (Some(tool), Some(cut)) = (section(run, "tool"), section(run, "cut")) else {
        return Err("no forces".to_owned());
    };
    let cutter = Milling::read(tool, cut)?;
    let last = points.iter().map(|point| point.segment).max().unwrap_or(0);
    for segment in 1..=last {
        let own: Vec<usize> = (0..points.len()).filter(|i| points[*i].segment == segment).collect();
        let (Some(first), Some(end)) = (own.first().copied(), own.last().copied()) else { continue };
        let is_corner = points.get(end + 1).is_some_and(|next| cutter.is_corner(&points[end], next));
        let mut left: f64 = (first + 1..=end).map(|i| (points[i].place - points[i - 1].place).norm()).sum();
        for i in own {
            if i > first {
                left -= (points[i].place - points[i - 1].place).norm();
            }
            let share = if is_corner { (1.0 - left / (cutter.radius + cutter.width)).clamp(0.0, 1.0) } else { 0.0 };
            let width = cutter.width + (2.0 * cutter.radius - cutter.width) * share;
            points[i].force = points[i].axes * cutter.mean_force(width);
        }
    }
    Ok(())
}

/// A cutter in its cut, with a mean over the turn by quadrature.
struct Milling {
    teeth: f64,
    radius: f64,
    width: f64,
    depth: f64,
    chip: f64,
    tangential: f64,
    radial: f64,
    axial: f64,
    edges: [f64; 2],
    /// 1 anticlockwise from above, -1 clockwise.
    spin: f64,
    /// 1 where the wall is on the left, -1 on the right.
    wall: f64,
    corner: Option<f64>,
}

impl Milling {
    fn read(tool: &Table, cut: &Table) -> Answer<Self> {
        let tangential = required(tool, "kt_mpa")? * 1e6;
        let radial = match number(tool, "kr") {
            Some(share) => share * tangential,
            None => required(tool, "kr_mpa")? * 1e6,
        };
        let spin = if text(tool, "rotation") == Some("counterclockwise") { 1.0 } else { -1.0 };
        let is_climb = text(cut, "milling") == Some("climb");
        Ok(Self {
            teeth: required(tool, "teeth")?,
            radius: required(tool, "cutter_diameter_mm")? * 0.5e-3,
            width: required(cut, "radial_depth_mm")? * 1e-3,
            depth: required(cut, "axial_depth_mm")? * 1e-3,
            chip: required(cut, "feed_per_tooth_mm")? * 1e-3,
            tangential,
            radial,
            axial: number(tool, "ka_mpa").unwrap_or(0.0) * 1e6,
            edges: [required(tool, "kte_n_per_mm")? * 1e3, required(tool, "kre_n_per_mm")? * 1e3],
            spin,
            wall: if is_climb { spin } else { -spin },
            corner: match text(cut, "concave_corners") {
                Some("left") => Some(1.0),
                Some("right") => Some(-1.0),
                _ => None,
            },
        })
    }

    fn is_corner(&self, end: &Point, next: &Point) -> bool {
        let axis = end.axes.column(2).into_owned();
        let turn = axis.dot(&end.feed.cross(&next.feed)).atan2(end.feed.dot(&next.feed));
        let is_near = (end.place - next.place).norm() < self.radius;
        self.corner.is_some_and(|side| is_near && turn * side > 5_f64.to_radians())
    }

    /// Along feed, left, axis. N
    fn mean_force(&self, width: f64) -> Vector3<f64> {
        // A tooth at an angle from the feed, towards the wall: it cuts in front of the cutter, within the width of cut
        // from the wall.
        let from = (1.0 - width / self.radius).clamp(-1.0, 1.0).asin();
        let to = std::f64::consts::FRAC_PI_2;
        let steps = 4000;
        let mut sum = Vector3::zeros();
        for k in 0..=steps {
            let angle = (from + (to - from) * f64::from(k) / f64::from(steps)) * self.wall;
            let weight = if k == 0 || k == steps {
                1.0
            } else if k % 2 == 1 {
                4.0
            } else {
                2.0
            };
            let outward = Vector3::new(angle.cos(), angle.sin(), 0.0);
            let motion = Vector3::new(-angle.sin(), angle.cos(), 0.0) * self.spin;
            let thickness = self.chip * outward.x;
            let tangential = self.tangential * thickness + self.edges[0];
            let radial = self.radial * thickness + self.edges[1];
            let force = -(motion * tangential + outward * radial) + Vector3::z() * (self.axial * thickness);
            sum += force * weight;
        }
        sum * (self.depth * (to - from) / (3.0 * f64::from(steps)) * self.teeth / std::f64::consts::TAU)
    }
}
