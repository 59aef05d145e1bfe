//! Trees of boxes over the triangles of meshes, and the search of two of them at once for the triangles that are
//! nearest.

use parry3d_f64::math::{Matrix, Pose as ParryPose, Vector};
use parry3d_f64::shape::Triangle;

/// The triangles of a mesh in nested boxes, each halved across its longest edge. The first contains all.
#[derive(Clone)]
pub struct Tree {
    nodes: Vec<Node>,
}

/// A box along the axes of the mesh, and a sphere, around some of the triangles.
#[derive(Clone, Copy)]
struct Node {
    centre: Vector,
    /// Half the edges. m
    half: Vector,
    /// Of the sphere about the centre. m
    radius: f64,
    within: Within,
}

#[derive(Clone, Copy)]
enum Within {
    /// The number of the only triangle.
    One(u32),
    /// Two halves: the node that follows, and the one of this number.
    Two(usize),
}

/// By what boxes and spheres are larger, so that rounding does not make boxes part whose triangles touch. m
pub const MARGIN: f64 = 1e-9;

/// Pose of the second of two meshes in the frame of the first.
struct Between {
    rotation: Matrix,
    inverse: Matrix,
    translation: Vector,
    /// The magnitudes of the entries of the rotation, and of its inverse.
    magnitudes: [Matrix; 2],
}

impl Between {
    fn new(pose: &ParryPose) -> Self {
        let rotation = Matrix::from_quat(pose.rotation);
        let inverse = rotation.transpose();
        Self { rotation, inverse, translation: pose.translation, magnitudes: [rotation.abs(), inverse.abs()] }
    }

    /// What the triangles of two nodes are apart at the least: by the boxes, each within a box along the axes of the
    /// other, and by the spheres. m
    fn bound(&self, a: &Node, b: &Node) -> f64 {
        let apart = self.rotation * b.centre + self.translation - a.centre;
        let in_first = apart.abs() - a.half - self.magnitudes[0] * b.half;
        let in_second = (self.inverse * apart).abs() - b.half - self.magnitudes[1] * a.half;
        let [first, second] = [in_first, in_second].map(|gaps| gaps.max(Vector::ZERO).length_squared());
        first.max(second).sqrt().max(apart.length() - a.radius - b.radius)
    }
}

impl Tree {
    /// Of triangles, which keep their numbers.
    pub fn new(triangles: &[Triangle]) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(2 * triangles.len()) };
        let mut numbers: Vec<u32> = (0..triangles.len() as u32).collect();
        if !numbers.is_empty() {
            tree.grow(triangles, &mut numbers);
        }
        tree
    }

    /// Adds what contains the triangles of these numbers, at least one.
    fn grow(&mut self, triangles: &[Triangle], numbers: &mut [u32]) {
        let corners = numbers.iter().flat_map(|number| *triangles[*number as usize].vertices());
        let corners: Vec<Vector> = corners.collect();
        let (low, high) = corners.iter().fold((corners[0], corners[0]), |(low, high), v| (low.min(*v), high.max(*v)));
        let (centre, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let radius = corners.iter().map(|corner| (*corner - centre).length()).fold(0.0, f64::max) + MARGIN;
        let at = self.nodes.len();
        self.nodes.push(Node { centre, half: half + Vector::splat(MARGIN), radius, within: Within::One(numbers[0]) });
        if numbers.len() > 1 {
            let axis = (1..3).fold(0, |longest, k| if half[k] > half[longest] { k } else { longest });
            let place = |number: u32| triangles[number as usize].vertices().iter().map(|v| v[axis]).sum::<f64>();
            let by_place = |a: &u32, b: &u32| place(*a).total_cmp(&place(*b)).then(a.cmp(b));
            let middle = numbers.len() / 2;
            numbers.select_nth_unstable_by(middle, by_place);
            let (first, second) = numbers.split_at_mut(middle);
            self.grow(triangles, first);
            self.nodes[at].within = Within::Two(self.nodes.len());
            self.grow(triangles, second);
        }
    }

    /// The numbers of a triangle of this mesh and of one of another at a pose, and how far they are apart, where no two
    /// are nearer and that is below `limit`, a positive number; the first two found that touch, where any do.
    /// `distance` returns that of two triangles where it is below the limit that it is given; else a value not below
    /// that.
    pub fn nearest(
        &self,
        pose: &ParryPose,
        other: &Self,
        limit: f64,
        distance: impl Fn(u32, u32, f64) -> f64,
    ) -> Option<(u32, u32, f64)> {
        let between = Between::new(pose);
        let bound = |a: usize, b: usize| between.bound(&self.nodes[a], &other.nodes[b]);
        let mut open = Vec::with_capacity(64);
        if !self.nodes.is_empty() && !other.nodes.is_empty() {
            open.push((bound(0, 0), 0, 0));
        }
        let (mut nearest, mut limit) = (None, limit);
        while let Some((least, a, b)) = open.pop() {
            if least >= limit {
                continue;
            }
            let (first, second) = (&self.nodes[a], &other.nodes[b]);
            let halves = match (first.within, second.within) {
                (Within::One(on_first), Within::One(on_second)) => {
                    let found = distance(on_first, on_second, limit);
                    if found < limit {
                        (nearest, limit) = (Some((on_first, on_second, found)), found);
                    }
                    if limit <= 0.0 {
                        break;
                    }
                    continue;
                }
                (Within::Two(next), Within::One(_)) => [(a + 1, b), (next, b)],
                (Within::One(_), Within::Two(next)) => [(a, b + 1), (a, next)],
                // The larger one.
                (Within::Two(next), Within::Two(_)) if first.radius > second.radius => [(a + 1, b), (next, b)],
                (Within::Two(_), Within::Two(next)) => [(a, b + 1), (a, next)],
            };
            let [one, two] = halves.map(|(a, b)| (bound(a, b), a, b));
            // The nearer one first.
            let both = if one.0 <= two.0 { [two, one] } else { [one, two] };
            open.extend(both.into_iter().filter(|(least, ..)| *least < limit));
        }
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collider::convex::core_distance;
    use crate::collider::mesh::Mesh;
    use crate::solid::TriangleMesh;
    use nalgebra::Vector3;
    use parry3d_f64::math::Rotation;
    use parry3d_f64::query::PointQuery;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use std::cell::Cell;
    use std::f64::consts::{PI, TAU};

    /// A closed surface with bumps, from 0.7 to 1.3 of its size (m) from the origin.
    fn bumpy(size: f64, [rings, around]: [u32; 2], random: &mut ChaCha8Rng) -> TriangleMesh {
        let [shift, waves] = [random.random_range(0.0..TAU), random.random_range(1.0..5.0)];
        let at = |ring: u32, k: u32| {
            let (down, about) = (PI * f64::from(ring) / f64::from(rings), TAU * f64::from(k) / f64::from(around));
            let [(s, c), (sine, cosine)] = [libm::sincos(down), libm::sincos(about)];
            let bumps = s * libm::sin(waves * down + shift) * libm::cos(3.0 * about + shift);
            Vector3::new(s * cosine, s * sine, c) * size * (1.0 + 0.3 * bumps)
        };
        let mut corners = vec![at(0, 0), at(rings, 0)];
        corners.extend((1..rings).flat_map(|ring| (0..around).map(move |k| (ring, k))).map(|(ring, k)| at(ring, k)));
        let number = |ring: u32, k: u32| match ring {
            0 => 0,
            _ if ring == rings => 1,
            _ => 2 + (ring - 1) * around + k % around,
        };
        let quad = |ring: u32, k: u32| {
            let [a, b, c, d] = [(ring, k), (ring + 1, k), (ring + 1, k + 1), (ring, k + 1)].map(|(r, k)| number(r, k));
            [[a, b, c], [a, c, d]].into_iter().filter(|[a, b, c]| a != b && b != c && c != a)
        };
        let triangles = (0..rings).flat_map(|ring| (0..around).map(move |k| (ring, k)));
        TriangleMesh::new(&corners, &triangles.flat_map(|(ring, k)| quad(ring, k)).collect::<Vec<_>>()).unwrap()
    }

    fn triangles(mesh: &TriangleMesh) -> Vec<Triangle> {
        let corner = |number: u32| crate::collider::convex::vector(&mesh.vertices()[number as usize]);
        mesh.triangles().iter().map(|corners| Triangle::from(corners.map(corner))).collect()
    }

    /// Somewhere at a distance from the origin, turned anyhow.
    fn anywhere(distance: f64, random: &mut ChaCha8Rng) -> ParryPose {
        let mut direction = || Vector::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        let [place, turn] = [direction().normalize() * distance, direction() * 3.0];
        ParryPose::from_parts(place, Rotation::from_scaled_axis(turn))
    }

    /// Meshes that are far, near, that touch and that hold one another, against all pairs of triangles.
    #[test]
    fn two_meshes_are_as_far_apart_as_their_nearest_triangles() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let [mut far, mut near, mut touching, mut nested] = [0; 4];
        for case in 0..240 {
            // Far, near, through one another, and one within the other.
            let (size, from, to) = [(0.8, 3.0, 6.0), (0.8, 1.4, 2.4), (1.0, 0.4, 1.5), (0.1, 0.0, 0.3)][case % 4];
            let [first, second] = [(1.0, [6, 7]), (size, [5, 6])].map(|(size, grid)| bumpy(size, grid, &mut random));
            let pose = anywhere(random.random_range(from..to), &mut random);
            let limit = [f64::MIN_POSITIVE, 0.05, 0.5, 10.0][case / 4 % 4];
            let [on_first, on_second] = [triangles(&first), triangles(&second)];
            let others = on_first.iter().flat_map(|a| on_second.iter().map(move |b| (a, b)));
            let plain = others.map(|(a, b)| core_distance(a, &pose, b, f64::INFINITY).0).fold(f64::INFINITY, f64::min);
            let expected = if case % 4 == 3 { 0.0 } else { plain };
            let [first, second] = [first, second].map(|mesh| Mesh::new(&mesh).unwrap());
            let found = first.distance_to_mesh(&pose, &second, limit).0;
            let turned = second.distance_to_mesh(&pose.inverse(), &first, limit).0;
            for found in [found, turned] {
                assert!((found.min(limit) - expected.min(limit)).abs() < 1e-9, "{case}: {found} {expected} {limit}");
                assert_eq!(found <= 0.0, expected <= 0.0, "{case}");
            }
            match first.nearest_of_mesh(&pose, &second, limit) {
                Some((distance, [a, b])) => {
                    assert!((distance - expected).abs() < 1e-9 && distance < limit, "{case}: {distance} {expected}");
                    assert!(((b - a).length() - distance).abs() < 1e-9);
                    let off = |triangles: &[Triangle], point: Vector| {
                        let off = triangles.iter().map(|own| own.distance_to_local_point(point, true));
                        off.fold(f64::INFINITY, f64::min)
                    };
                    assert!(off(&on_first, a) < 1e-9 && off(&on_second, pose.inverse_transform_point(b)) < 1e-9);
                }
                None => assert!(expected <= 0.0 || expected >= limit, "{case}: {expected} {limit}"),
            }
            match (case % 4 == 3, expected <= 0.0, expected >= limit) {
                (true, ..) => nested += 1,
                (_, true, _) => touching += 1,
                (_, _, true) => far += 1,
                _ => near += 1,
            }
        }
        assert!([far, near, touching, nested].iter().all(|count| *count >= 30), "{far} {near} {touching} {nested}");
    }

    /// Of two meshes of 1650 triangles that come near, few of the 2.7 million pairs are looked at.
    #[test]
    fn most_pairs_are_not_looked_at() {
        let mut random = ChaCha8Rng::seed_from_u64(8);
        let [first, second] = [30, 31].map(|rings| triangles(&bumpy(1.0, [rings, 28], &mut random)));
        let trees = [&first, &second].map(|triangles| Tree::new(triangles));
        let (looked_at, cases) = (Cell::new(0), 40);
        for _ in 0..cases {
            let pose = anywhere(random.random_range(1.7..2.5), &mut random);
            trees[0].nearest(&pose, &trees[1], 0.5, |a, b, known| {
                looked_at.set(looked_at.get() + 1);
                core_distance(&first[a as usize], &pose, &second[b as usize], known).0
            });
        }
        let each = looked_at.get() / cases;
        assert!((1..1500).contains(&each), "{each}");
    }
}
