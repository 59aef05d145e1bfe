//! Where lines along the axes run inside a body: the stock before it is cut, and the finished part.

use crate::error::{ForcesError, LARGEST};
use crate::lattice::{TILE, TileKey, by_tile, lines_of, others, place};
use crate::operation::{ForcesProblem, Stock};
use crate::swept::Swept;
use crate::tile::{NANO, Tile};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::sync::Arc;
use stead_cell::{Solid, TriangleMesh};
use stead_model::robot::Pose;

/// A body in the workpiece frame, ready to be asked for lines.
#[derive(Debug, Clone)]
pub struct Body {
    form: Form,
    /// Lower and upper corner of its extent. m
    pub extent: [Vector3<f64>; 2],
}

#[derive(Debug, Clone)]
enum Form {
    /// A box by its half edges, or a cylinder, in a frame of its own.
    Box(Vector3<f64>, Pose<f64>),
    Cylinder(f64, f64, Pose<f64>),
    Mesh(Arc<Facets>),
    Swept(Swept),
}

/// Triangles in the workpiece frame, and which of them the lines of a tile can meet.
#[derive(Debug)]
struct Facets {
    corners: Vec<[Vector3<f64>; 3]>,
    by_tile: BTreeMap<TileKey, Vec<u32>>,
}

/// The intervals of a line inside a body, and whether its surface was crossed as that of a body is: in, out, in, out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Inside {
    /// Ascending, from the origin of the line. m
    pub intervals: Vec<[f64; 2]>,
    /// Whether every way in is followed by one out.
    pub is_sound: bool,
}

impl Body {
    /// The stock of a problem.
    ///
    /// # Errors
    /// [`ForcesError::Form`], [`ForcesError::NoWall`] and [`ForcesError::Large`].
    pub fn of_stock(problem: &ForcesProblem, cell: f64) -> Result<Self, ForcesError> {
        let small = |extent: [Vector3<f64>; 2]| {
            let length = (extent[1] - extent[0]).max();
            if length > LARGEST { Err(ForcesError::Large(length)) } else { Ok(extent) }
        };
        match &problem.stock {
            Stock::Solid { solid, pose } => {
                // Before the triangles of a mesh in another unit are put into tiles.
                small(solid.extent_at(pose))?;
                Self::new(solid, pose, cell).ok_or(ForcesError::Form)
            }
            Stock::Path(stock) => {
                let swept = Swept::new(&problem.operation, stock, cell).ok_or(ForcesError::NoWall)?;
                Ok(Self { extent: small(swept.extent)?, form: Form::Swept(swept) })
            }
        }
    }

    /// A box, cylinder or closed mesh with its pose; nothing for another form.
    pub fn new(solid: &Solid, pose: &Pose<f64>, cell: f64) -> Option<Self> {
        let form = match solid {
            Solid::Box(edges) => Form::Box(edges / 2.0, *pose),
            Solid::Cylinder { radius, length } => Form::Cylinder(*radius, *length, *pose),
            Solid::Mesh(mesh) => Form::Mesh(Arc::new(Facets::new(mesh, pose, cell))),
            Solid::Capsule { .. } | Solid::Hull(_) => return None,
        };
        Some(Self { form, extent: solid.extent_at(pose) })
    }

    /// Whether its lines are found faster by the tile than one by one.
    pub fn is_by_tile(&self) -> bool {
        matches!(self.form, Form::Mesh(_) | Form::Swept(_))
    }

    /// All lines of a tile, where they are found so.
    fn lines(&self, key: TileKey, extent: &[Vector3<f64>; 2], cell: f64) -> Option<Vec<Inside>> {
        match &self.form {
            Form::Mesh(facets) => Some(facets.lines(key, extent, cell)),
            Form::Swept(swept) => Some(swept.lines(key, cell).into_iter().map(Inside::of).collect()),
            Form::Box(..) | Form::Cylinder(..) => None,
        }
    }

    /// How far a point inside is from the surface along the axis in which that is least; 0 outside. m
    pub fn depth(&self, point: &Vector3<f64>, cell: f64) -> f64 {
        let along = |axis: usize| {
            let tile = others(axis).map(|k| ((point[k] / cell).floor() as i64).div_euclid(TILE));
            let mut o = *point;
            o[axis] = self.extent[0][axis];
            let at = point[axis] - o[axis];
            let inside = self.line((axis, tile[0], tile[1]), &o);
            inside.intervals.iter().map(|[from, to]| (at - from).min(to - at)).fold(0.0, f64::max)
        };
        (0..3).map(along).fold(f64::INFINITY, f64::min)
    }

    /// The part of a line from `o` along an axis that is inside.
    pub fn line(&self, key: TileKey, o: &Vector3<f64>) -> Inside {
        let axis = key.0;
        match &self.form {
            Form::Box(half, pose) => {
                let (w, d) = in_frame(pose, o, axis);
                let mut ends = [f64::NEG_INFINITY, f64::INFINITY];
                for k in 0..3 {
                    slab(&mut ends, w[k], d[k], [-half[k], half[k]]);
                }
                Inside::convex(ends)
            }
            Form::Cylinder(radius, length, pose) => {
                let (w, d) = in_frame(pose, o, axis);
                let mut ends = [f64::NEG_INFINITY, f64::INFINITY];
                slab(&mut ends, w.z, d.z, [-length / 2.0, length / 2.0]);
                let (a, b) = (d.x * d.x + d.y * d.y, w.x * d.x + w.y * d.y);
                let c = w.x * w.x + w.y * w.y - radius * radius;
                let square = b * b - a * c;
                if a < 1e-20 {
                    if c > 0.0 {
                        ends = [0.0, 0.0];
                    }
                } else if square <= 0.0 {
                    ends = [0.0, 0.0];
                } else {
                    let root = square.sqrt();
                    ends = [ends[0].max((-b - root) / a), ends[1].min((-b + root) / a)];
                }
                Inside::convex(ends)
            }
            Form::Mesh(facets) => facets.line(key, o),
            Form::Swept(swept) => Inside::of(swept.line(key, o)),
        }
    }
}

/// A line from `o` along an axis of the workpiece, in another frame.
fn in_frame(pose: &Pose<f64>, o: &Vector3<f64>, axis: usize) -> (Vector3<f64>, Vector3<f64>) {
    let turned = pose.rotation.transpose();
    (turned * (o - pose.translation), turned.column(axis).into_owned())
}

/// Cuts an interval of a line to where a coordinate is between two values.
fn slab(ends: &mut [f64; 2], at: f64, rate: f64, between: [f64; 2]) {
    if rate.abs() < 1e-14 {
        if at < between[0] || at > between[1] {
            *ends = [0.0, 0.0];
        }
        return;
    }
    let [a, b] = between.map(|value| (value - at) / rate);
    *ends = [ends[0].max(a.min(b)), ends[1].min(a.max(b))];
}

impl Inside {
    /// Ascending intervals.
    pub fn of(intervals: Vec<[f64; 2]>) -> Self {
        Self { intervals, is_sound: true }
    }

    fn convex(ends: [f64; 2]) -> Self {
        Self::of(if ends[0] < ends[1] { vec![ends] } else { Vec::new() })
    }

    /// Between crossings of triangles that face outwards: on the way in they face against the line.
    fn between(mut crossings: Vec<(f64, f64)>) -> Self {
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
        let mut inside = Self { intervals: Vec::new(), is_sound: true };
        let (mut depth, mut from) = (0_i32, 0.0);
        for (along, facing) in crossings {
            let before = depth;
            depth += if facing < 0.0 { 1 } else { -1 };
            match (before, depth) {
                (0, 1) => from = along,
                (1, 0) if along > from => inside.intervals.push([from, along]),
                (1, 0) => {}
                _ => inside.is_sound = false,
            }
        }
        inside.is_sound &= depth == 0;
        inside
    }
}

impl Facets {
    fn new(mesh: &TriangleMesh, pose: &Pose<f64>, cell: f64) -> Self {
        let vertices: Vec<Vector3<f64>> = mesh.vertices().iter().map(|vertex| pose.point(vertex)).collect();
        let corners: Vec<[Vector3<f64>; 3]> =
            mesh.triangles().iter().map(|triangle| triangle.map(|vertex| vertices[vertex as usize])).collect();
        let reach = |corners: &[Vector3<f64>; 3]| [0, 1, 2].map(|k| ends(corners.map(|corner| corner[k])));
        let by_tile = by_tile((0..).zip(corners.iter().map(reach)), cell);
        Self { corners, by_tile }
    }

    fn line(&self, key: TileKey, o: &Vector3<f64>) -> Inside {
        let numbers = self.by_tile.get(&key).into_iter().flatten();
        Inside::between(numbers.filter_map(|number| self.crossing(*number, key.0, o)).collect())
    }

    /// All lines of a tile, triangle by triangle: each meets few of them.
    fn lines(&self, key: TileKey, extent: &[Vector3<f64>; 2], cell: f64) -> Vec<Inside> {
        let (axis, i, j) = key;
        let mut crossings: Vec<Vec<(f64, f64)>> = vec![Vec::new(); (TILE * TILE) as usize];
        for number in self.by_tile.get(&key).into_iter().flatten() {
            let corners = &self.corners[*number as usize];
            let [rows, columns] =
                [0, 1].map(|side| lines_of([i, j][side], ends(corners.map(|corner| corner[others(axis)[side]])), cell));
            for line in rows.flat_map(|row| columns.clone().map(move |column| (row * TILE + column) as usize)) {
                crossings[line].extend(self.crossing(*number, axis, &origin(extent, cell, key, line)));
            }
        }
        crossings.into_iter().map(Inside::between).collect()
    }

    /// Where a line from `o` along an axis crosses a triangle, and whether that faces along it.
    fn crossing(&self, number: u32, axis: usize, o: &Vector3<f64>) -> Option<(f64, f64)> {
        let [a, b] = others(axis);
        let corners = &self.corners[number as usize];
        let flat = corners.map(|corner| [corner[a] - o[a], corner[b] - o[b]]);
        let area = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
        // An edge that two triangles share is reckoned the same way for both, so that a line meets one of them.
        let side = |p: usize, q: usize| {
            let is_turned = flat[p] > flat[q];
            let area = if is_turned { -area(flat[q], flat[p]) } else { area(flat[p], flat[q]) };
            (area, if area == 0.0 { is_turned } else { area > 0.0 })
        };
        let [(u, is_u), (v, is_v), (w, is_w)] = [side(1, 2), side(2, 0), side(0, 1)];
        let sum = u + v + w;
        let is_met = is_u == is_v && is_v == is_w && sum != 0.0;
        let along = (corners[0][axis] * u + corners[1][axis] * v + corners[2][axis] * w) / sum;
        is_met.then_some((along - o[axis], sum.signum()))
    }
}

/// The least and the most of three numbers.
fn ends(values: [f64; 3]) -> [f64; 2] {
    values.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

/// Where a line of a tile begins, at the lower end of the extent.
pub(crate) fn origin(extent: &[Vector3<f64>; 2], cell: f64, key: TileKey, line: usize) -> Vector3<f64> {
    let (axis, i, j) = key;
    let [a, b] = others(axis);
    let line = line as i64;
    let at = place(i * TILE + line / TILE, j * TILE + line % TILE);
    let mut o = Vector3::zeros();
    (o[a], o[b], o[axis]) = (at[0] * cell, at[1] * cell, extent[0][axis]);
    o
}

/// The lines of a tile inside a body, from the lower end of an extent.
pub(crate) fn tile_of(body: &Body, extent: &[Vector3<f64>; 2], cell: f64, key: TileKey) -> Tile {
    let axis = key.0;
    let length = (extent[1][axis] - extent[0][axis]) * NANO;
    let nano = |end: f64| (end * NANO).round().clamp(0.0, length.round()) as u32;
    let [a, b] = others(axis);
    let mut tile = Tile::empty();
    let mut put = |line: usize, inside: Inside| {
        let intervals: Vec<[u32; 2]> =
            inside.intervals.iter().map(|ends| ends.map(nano)).filter(|[from, to]| to > from).collect();
        tile.set(line, &intervals);
        if !inside.is_sound {
            tile.unsound.push(line);
        }
    };
    if let Some(lines) = body.lines(key, extent, cell) {
        lines.into_iter().enumerate().for_each(|(line, inside)| put(line, inside));
        return tile;
    }
    for line in 0..(TILE * TILE) as usize {
        let o = origin(extent, cell, key, line);
        let is_beside = |k: usize| o[k] < body.extent[0][k] || o[k] > body.extent[1][k];
        if !is_beside(a) && !is_beside(b) {
            put(line, body.line(key, &o));
        }
    }
    tile
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::tiles_within;

    /// A block with a pyramid on top, in a turned pose: triangles large and small, and edges that lines may meet.
    #[test]
    fn lines_of_a_tile_are_those_asked_for_one_by_one() {
        let corner = |x: f64, y: f64, z: f64| Vector3::new(x, y, z) * 1e-2;
        let vertices = [
            corner(0.0, 0.0, 0.0),
            corner(4.0, 0.0, 0.0),
            corner(4.0, 3.0, 0.0),
            corner(0.0, 3.0, 0.0),
            corner(2.1, 1.3, 2.0),
        ];
        let triangles = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = TriangleMesh::new(&vertices, &triangles).unwrap();
        let rotation = *nalgebra::Rotation3::from_euler_angles(0.3, -0.2, 0.5).matrix();
        for pose in [Pose::identity(), Pose { rotation, translation: Vector3::new(0.003, -0.001, 0.002) }] {
            let cell = 0.7e-3;
            let body = Body::new(&Solid::Mesh(mesh.clone().into()), &pose, cell).unwrap();
            let Form::Mesh(facets) = &body.form else { panic!("a mesh") };
            let mut crossed = 0;
            let reach = [0, 1, 2].map(|k| body.extent.map(|corner| corner[k]));
            for key in tiles_within(&reach, cell) {
                let all = facets.lines(key, &body.extent, cell);
                for (line, found) in all.iter().enumerate() {
                    assert_eq!(*found, body.line(key, &origin(&body.extent, cell, key, line)), "{key:?} {line}");
                    crossed += found.intervals.len();
                }
            }
            assert!(crossed > 3000, "{crossed}");
        }
    }
}
