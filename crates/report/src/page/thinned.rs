//! Surfaces with fewer triangles, to be looked at.
//!
//! Edges are drawn together to one of their ends or to their middle, those first that change the surface least: by the
//! sum of the squared distances from the planes of the triangles that have gone into a corner, each as heavy as its
//! triangle is large (quadric error metrics, Garland and Heckbert 1997). The same surface gives the same triangles.

use nalgebra::{Matrix3, Vector3};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};
use stead_removal::surface::Surface;

/// What changes the surface by no more goes though there are few enough triangles, over the fourth power of its size:
/// an area of a hundredth of the size square, moved by a ten thousandth of the size.
const FREE: f64 = 1e-12;
/// What the fourth power of its length adds to the error of an edge, so that of equal ones the short ones go first.
const LENGTH: f64 = 1e-12;
/// Cosine of the largest turn of a triangle about a corner that moves.
const TURN: f64 = 0.2;

/// The sum of the squared distances from planes, each with a weight: of a point p it is `p A p + 2 b p + c`.
#[derive(Debug, Clone, Copy)]
struct Quadric {
    a: Matrix3<f64>,
    b: Vector3<f64>,
    c: f64,
}

impl Quadric {
    fn zero() -> Self {
        Self { a: Matrix3::zeros(), b: Vector3::zeros(), c: 0.0 }
    }

    /// That of the plane of a triangle.
    fn of(corners: [Vector3<f64>; 3]) -> Self {
        let across = normal(corners);
        let weight = across.norm() / 2.0;
        let Some(normal) = across.try_normalize(0.0) else { return Self::zero() };
        let offset = -normal.dot(&corners[0]);
        Self { a: normal * normal.transpose() * weight, b: normal * (offset * weight), c: offset * offset * weight }
    }

    fn plus(&self, other: &Self) -> Self {
        Self { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }

    fn at(&self, point: &Vector3<f64>) -> f64 {
        point.dot(&(self.a * point)) + 2.0 * self.b.dot(point) + self.c
    }
}

/// Twice as long as a triangle is large, out of it.
fn normal(corners: [Vector3<f64>; 3]) -> Vector3<f64> {
    (corners[1] - corners[0]).cross(&(corners[2] - corners[0]))
}

/// An edge that may be drawn together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    /// The bits of the cost, which none has below zero: they are in the order of the costs.
    cost: u64,
    ends: [u32; 2],
    /// How often its ends had moved when it was looked at.
    moved: [u32; 2],
}

/// A surface on its way.
struct Thinning {
    corners: Vec<Vector3<f64>>,
    quadrics: Vec<Quadric>,
    moved: Vec<u32>,
    /// Numbers of the triangles about each corner; none about one that is gone.
    about: Vec<Vec<u32>>,
    /// `None` where one is gone.
    triangles: Vec<Option<[u32; 3]>>,
    left: usize,
    edges: BinaryHeap<Reverse<Edge>>,
}

/// The surface with at most so many triangles, where its form allows it, and with fewer where these do as well.
pub(super) fn thinned(surface: &Surface, most: usize) -> Surface {
    let [low, high] = extent(surface);
    let size = (high - low).norm();
    let mut thinning = Thinning::of(surface);
    while let Some(Reverse(edge)) = thinning.edges.pop() {
        if thinning.left <= most && f64::from_bits(edge.cost) > FREE * size.powi(4) {
            break;
        }
        thinning.collapse(&edge);
    }
    thinning.surface()
}

/// A surface of any form with at most so many triangles: thinned, or where that is not enough, since it has holes or
/// edges of more than two triangles, with its corners drawn together to the middles of ever larger cubes.
pub(super) fn thinned_to(surface: &Surface, most: usize) -> Surface {
    let few = thinned(surface, most);
    let [low, high] = extent(&few);
    let size = (high - low).amax();
    let mut cubes = 256.0_f64;
    let mut fewer = few;
    while fewer.triangles.len() > most && cubes >= 1.0 {
        fewer = clustered(surface, &low, size / cubes);
        cubes *= 0.8;
    }
    fewer
}

/// The surface with the corners within each cube of a size drawn together.
fn clustered(surface: &Surface, low: &Vector3<f64>, cube: f64) -> Surface {
    let mut numbers: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let mut sums: Vec<(Vector3<f64>, f64)> = Vec::new();
    let cluster: Vec<u32> = surface
        .vertices
        .iter()
        .map(|corner| {
            let place = <[f64; 3]>::from((corner - low) / cube).map(|part| part.floor() as i64);
            let number = *numbers.entry(place).or_insert_with(|| {
                sums.push((Vector3::zeros(), 0.0));
                sums.len() as u32 - 1
            });
            let (sum, count) = &mut sums[number as usize];
            *sum += corner;
            *count += 1.0;
            number
        })
        .collect();
    let mut known = BTreeSet::new();
    let triangles = surface.triangles.iter().map(|triangle| triangle.map(|corner| cluster[corner as usize]));
    let kept = triangles.filter(|[a, b, c]| {
        let mut sorted = [*a, *b, *c];
        sorted.sort_unstable();
        a != b && b != c && c != a && known.insert(sorted)
    });
    Surface { triangles: kept.collect(), vertices: sums.into_iter().map(|(sum, count)| sum / count).collect() }
}

/// The ends of a surface along x, y and z; both at nothing where it has no corner.
fn extent(surface: &Surface) -> [Vector3<f64>; 2] {
    let mut corners = surface.vertices.iter();
    let first = corners.next().copied().unwrap_or_default();
    corners.fold([first; 2], |[low, high], corner| [low.inf(corner), high.sup(corner)])
}

impl Thinning {
    fn of(surface: &Surface) -> Self {
        let count = surface.vertices.len();
        let mut thinning = Self {
            corners: surface.vertices.clone(),
            quadrics: vec![Quadric::zero(); count],
            moved: vec![0; count],
            about: vec![Vec::new(); count],
            triangles: surface.triangles.iter().copied().map(Some).collect(),
            left: surface.triangles.len(),
            edges: BinaryHeap::new(),
        };
        for (number, triangle) in surface.triangles.iter().enumerate() {
            let quadric = Quadric::of(triangle.map(|corner| surface.vertices[corner as usize]));
            for corner in triangle.map(|corner| corner as usize) {
                thinning.quadrics[corner] = thinning.quadrics[corner].plus(&quadric);
                thinning.about[corner].push(number as u32);
            }
        }
        for [a, b, c] in &surface.triangles {
            // Every edge is met from both sides.
            let edges = [[*a, *b], [*b, *c], [*c, *a]];
            edges.into_iter().filter(|[from, to]| from < to).for_each(|ends| thinning.offer(ends));
        }
        thinning
    }

    /// The triangles about a corner, with their numbers.
    fn around(&self, corner: u32) -> impl Iterator<Item = (u32, [u32; 3])> {
        self.about[corner as usize].iter().filter_map(|number| Some((*number, self.triangles[*number as usize]?)))
    }

    /// What it costs to draw an edge together, and where to.
    fn best_place(&self, ends: [u32; 2]) -> (f64, Vector3<f64>) {
        let [a, b] = ends.map(|end| self.corners[end as usize]);
        let quadric = self.quadrics[ends[0] as usize].plus(&self.quadrics[ends[1] as usize]);
        let places = [a, b, (a + b) / 2.0].map(|place| (quadric.at(&place).max(0.0), place));
        let [first, second, third] = places;
        let less = |least: (f64, _), place: (f64, _)| if place.0 < least.0 { place } else { least };
        let (least, place) = less(less(first, second), third);
        (least + LENGTH * (b - a).norm_squared() * (b - a).norm_squared(), place)
    }

    fn offer(&mut self, ends: [u32; 2]) {
        let moved = ends.map(|end| self.moved[end as usize]);
        self.edges.push(Reverse(Edge { cost: self.best_place(ends).0.to_bits(), ends, moved }));
    }

    /// Draws an edge together, where it is still as it was and nothing is turned over or closed by it.
    fn collapse(&mut self, edge: &Edge) {
        let [a, b] = edge.ends;
        if edge.ends.map(|end| self.moved[end as usize]) != edge.moved {
            return;
        }
        let (_, to) = self.best_place(edge.ends);
        let at_edge: Vec<u32> =
            self.around(a).filter(|(_, triangle)| triangle.contains(&b)).map(|(number, _)| number).collect();
        if at_edge.len() != 2 || self.common_neighbours(a, b) != 2 || self.turns_over(a, b, &to) {
            return;
        }
        for number in &at_edge {
            self.triangles[*number as usize] = None;
        }
        self.left -= 2;
        let of_b: Vec<(u32, [u32; 3])> = self.around(b).collect();
        for (number, triangle) in &of_b {
            self.triangles[*number as usize] = Some(triangle.map(|corner| if corner == b { a } else { corner }));
        }
        let mut about: Vec<u32> = self.around(a).map(|(number, _)| number).collect();
        about.extend(of_b.iter().map(|(number, _)| *number));
        self.about[b as usize].clear();
        self.about[a as usize] = about;
        self.corners[a as usize] = to;
        self.quadrics[a as usize] = self.quadrics[a as usize].plus(&self.quadrics[b as usize]);
        for end in edge.ends {
            self.moved[end as usize] += 1;
        }
        for neighbour in self.neighbours(a) {
            self.offer([a.min(neighbour), a.max(neighbour)]);
        }
    }

    /// In the order of their numbers.
    fn neighbours(&self, corner: u32) -> Vec<u32> {
        let mut all: Vec<u32> =
            self.around(corner).flat_map(|(_, triangle)| triangle).filter(|other| *other != corner).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn common_neighbours(&self, a: u32, b: u32) -> usize {
        let of_b = self.neighbours(b);
        self.neighbours(a).iter().filter(|neighbour| of_b.binary_search(neighbour).is_ok()).count()
    }

    /// Whether a triangle that stays would face elsewhere with both corners at a place.
    fn turns_over(&self, a: u32, b: u32, to: &Vector3<f64>) -> bool {
        let one = |from: u32, other: u32| {
            self.around(from).filter(|(_, triangle)| !triangle.contains(&other)).any(|(_, triangle)| {
                let before = normal(triangle.map(|corner| self.corners[corner as usize]));
                let after =
                    normal(triangle.map(|corner| if corner == from { *to } else { self.corners[corner as usize] }));
                after.dot(&before) <= TURN * after.norm() * before.norm()
            })
        };
        one(a, b) || one(b, a)
    }

    /// What is left, corners in their order.
    fn surface(self) -> Surface {
        let mut numbers = vec![u32::MAX; self.corners.len()];
        let mut left = Surface::default();
        for triangle in self.triangles.iter().flatten() {
            for corner in triangle {
                numbers[*corner as usize] = 0;
            }
        }
        for (number, corner) in numbers.iter_mut().zip(&self.corners).filter(|(number, _)| **number == 0) {
            *number = left.vertices.len() as u32;
            left.vertices.push(*corner);
        }
        left.triangles =
            self.triangles.iter().flatten().map(|triangle| triangle.map(|corner| numbers[corner as usize])).collect();
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A closed sheet about a box of 2 x 1 x 1 whose sides have so many squares along each unit, drawn onto a form.
    fn sheet(squares: usize, form: fn(Vector3<f64>) -> Vector3<f64>) -> Surface {
        let mut numbers: BTreeMap<[usize; 3], u32> = BTreeMap::new();
        let mut surface = Surface::default();
        let counts = [2 * squares, squares, squares];
        for axis in 0..3 {
            let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
            for is_high in [false, true] {
                for i in 0..counts[u] {
                    for j in 0..counts[v] {
                        let mut around = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[di, dj]| {
                            let mut node = [0; 3];
                            (node[axis], node[u], node[v]) = (if is_high { counts[axis] } else { 0 }, i + di, j + dj);
                            *numbers.entry(node).or_insert_with(|| {
                                let place = Vector3::from_fn(|k, _| node[k] as f64 / squares as f64);
                                surface.vertices.push(form(place));
                                surface.vertices.len() as u32 - 1
                            })
                        });
                        if !is_high {
                            around.reverse();
                        }
                        let [p, q, r, s] = around;
                        surface.triangles.extend([[p, q, r], [p, r, s]]);
                    }
                }
            }
        }
        surface
    }

    fn volume(surface: &Surface) -> f64 {
        let sixth = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| surface.vertices[corner as usize]);
            a.dot(&b.cross(&c)) / 6.0
        };
        surface.triangles.iter().map(sixth).sum()
    }

    /// Every edge has a triangle on either side.
    fn assert_closed(surface: &Surface) {
        let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for [a, b, c] in &surface.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.entry([*from.min(to), *from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|balance| *balance == 0));
    }

    #[test]
    fn flat_sides_take_few_triangles_and_keep_every_corner() {
        let full = sheet(20, |place| place);
        let few = thinned(&full, usize::MAX);
        assert_closed(&few);
        assert!((volume(&few) - 2.0).abs() < 1e-9 && full.triangles.len() == 8000);
        assert!(few.triangles.len() < 60, "{}", few.triangles.len());
        assert_eq!(thinned(&full, usize::MAX), few);
    }

    /// Loose triangles, as some programs write them, share no edge that could be drawn together.
    #[test]
    fn loose_triangles_come_down_to_what_is_allowed_and_stay_where_they_are() {
        let ball = sheet(16, |place| (place - Vector3::new(1.0, 0.5, 0.5)).normalize());
        let mut loose = Surface::default();
        for triangle in &ball.triangles {
            let first = loose.vertices.len() as u32;
            loose.vertices.extend(triangle.map(|corner| ball.vertices[corner as usize]));
            loose.triangles.push([first, first + 1, first + 2]);
        }
        assert!(thinned(&loose, 500).triangles.len() > 500);
        let few = thinned_to(&loose, 500);
        assert!(few.triangles.len() <= 500 && few.triangles.len() > 200, "{}", few.triangles.len());
        assert!(few.vertices.iter().all(|corner| (corner.norm() - 1.0).abs() < 0.1));
        assert_eq!(thinned_to(&loose, 500), few);
        assert_eq!(thinned_to(&Surface::default(), 10), Surface::default());
        assert!(thinned_to(&ball, 500).triangles.len() <= 500);
    }

    #[test]
    fn a_round_form_has_as_many_triangles_as_are_allowed_and_stays_round() {
        let ball = sheet(16, |place| (place - Vector3::new(1.0, 0.5, 0.5)).normalize());
        for most in [2000, 500] {
            let few = thinned(&ball, most);
            assert_closed(&few);
            assert!(few.triangles.len() <= most && few.triangles.len() > most - 4, "{}", few.triangles.len());
            // Even triangles with their corners on the ball have edges of e^2 = 16 pi / (sqrt(3) N); their middles are
            // e^2 / 6 below it, and 3 e^2 / 8 of the volume is missing. Twice as much is as good as half as many.
            let edge_squared = 16.0 * std::f64::consts::PI / (3.0_f64.sqrt() * most as f64);
            let missing = 1.0 - volume(&few) / (4.0 / 3.0 * std::f64::consts::PI);
            assert!(missing > 0.0 && missing < 2.0 * 0.375 * edge_squared, "{missing}");
            let far = few.vertices.iter().map(|corner| (corner.norm() - 1.0).abs()).fold(0.0, f64::max);
            assert!(far < edge_squared / 6.0, "{far}");
        }
    }
}
