//! What does not depend on the posture: base and part, and all that is fixed to the tool.

use super::Normal;
use crate::problem::Problem;
use nalgebra::{Matrix3, Matrix6, Vector3};
use stead_numerics::simd::{Lanes, Simd};

/// What is the same in all states of a problem: matrices, where it has any.
#[derive(Debug, Clone)]
pub(in crate::evaluate::batch) struct Fixed {
    /// In the root frame: where the base yields, and how.
    base: Option<(Vector3<f64>, Matrix6<f64>)>,
    /// What is fixed to the flange, at the tool centre point, per force and per moment: mount and tip, in the flange
    /// frame.
    pub flange: [Matrix3<f64>; 2],
    /// The same in the tool frame, with the springs of joint 6 normal to its axis.
    tool: [Matrix3<f64>; 2],
    /// Of the one set of springs: compliance of joint 1 where it is alike about x and y, and where it yields.
    first: f64,
    first_height: f64,
}

/// What a point at a placement adds to the parts of the deflection along the scored directions: `a + b cos(beta) + c
/// sin(beta) + d cos(2 beta) + e sin(2 beta)`, and, where errors of the force are covered, how base and part answer a
/// unit force along each, in the root frame.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::evaluate::batch) struct FixedParts {
    terms: [[f64; 5]; 3],
    pub responses: [Vector3<f64>; 3],
}

/// What acts on a path point, in the root frame.
pub(in crate::evaluate::batch) struct PlacedLoad<'a> {
    /// Axes of the point, as columns.
    pub axes: &'a Matrix3<f64>,
    /// Rotation of the workpiece.
    pub workpiece: &'a Matrix3<f64>,
    /// Tool centre point. m
    pub tip: &'a Vector3<f64>,
    /// Force (N) and moment (N m).
    pub force: &'a Vector3<f64>,
    pub moment: &'a Vector3<f64>,
    pub directions: &'a [Vector3<f64>; 3],
}

impl Fixed {
    pub fn new(problem: &Problem, normal: &Normal) -> Self {
        let g = problem.robot.geometry();
        let root_from_base = g.base_from_root.transpose();
        let base = problem.robot.yielding_base().map(|(frame, matrix)| {
            let rotation = root_from_base * frame.rotation;
            let mut both = Matrix6::zeros();
            both.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
            both.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation);
            (root_from_base * (frame.translation - g.root_in_base), both * matrix * both.transpose())
        });
        let tool = &problem.spindle.flange_from_tool;
        let reach = tool.translation;
        let block =
            |matrix: &Matrix6<f64>, row: usize, column: usize| matrix.fixed_view::<3, 3>(row, column).into_owned();
        let mut flange = [Matrix3::zeros(); 2];
        if let Some(mount) = &problem.spindle.mount {
            // Displacement at the tool centre point: u + phi x q, under the moment m + q x f.
            let lever = reach.cross_matrix();
            let turning = block(mount, 0, 3) - lever * block(mount, 3, 3);
            let shifting = block(mount, 0, 0) - lever * block(mount, 3, 0);
            flange = [shifting + turning * lever, turning];
        }
        if let Some(tip) = &problem.spindle.tip {
            flange[0] += tool.rotation * tip * tool.rotation.transpose();
        }
        let sixth = normal.of_sixth(&reach);
        let in_tool = |k: usize| tool.rotation.transpose() * (flange[k] + sixth[k]) * tool.rotation;
        Self {
            base,
            flange,
            tool: [in_tool(0), in_tool(1)],
            first: normal.first_alike(),
            first_height: normal.first_height(&problem.robot),
        }
    }

    /// What a point adds, where there is one set of springs, and no error is covered (`is_plain`): all that does not
    /// depend on the posture. Else, what does not depend on the springs and on beta.
    pub fn parts(&self, is_plain: bool, part: Option<&Matrix3<f64>>, load: &PlacedLoad<'_>) -> FixedParts {
        let mut found = FixedParts::default();
        let PlacedLoad { axes, workpiece, tip, force, moment, directions } = load;
        let part = part.map(|matrix| *workpiece * matrix * workpiece.transpose());
        let answer = |force: &Vector3<f64>, moment: &Vector3<f64>| {
            let mut moved = part.map_or_else(Vector3::zeros, |part| part * force);
            if let Some((point, matrix)) = &self.base {
                let reach = *tip - point;
                let turning = moment + reach.cross(force);
                let block = |row: usize, column: usize| matrix.fixed_view::<3, 3>(row, column);
                let shift = block(0, 0) * force + block(0, 3) * turning;
                moved += shift + (block(3, 0) * force + block(3, 3) * turning).cross(&reach);
            }
            moved
        };
        let moved = answer(force, moment);
        let lever = Vector3::new(tip.x, tip.y, tip.z - self.first_height);
        let turning = *moment + lever.cross(force);
        for (k, direction) in directions.iter().enumerate() {
            found.terms[k][0] = moved.dot(direction);
            if is_plain {
                let across = lever.cross(direction);
                found.terms[k][0] += self.first * (turning.x * across.x + turning.y * across.y);
                let in_point = |vector: &Vector3<f64>| axes.tr_mul(vector);
                self.add_of_tool(&mut found.terms[k], &in_point(direction), [&in_point(force), &in_point(moment)]);
            } else {
                found.responses[k] = answer(direction, &Vector3::zeros());
            }
        }
        found
    }

    /// What is fixed to the tool adds along a direction n, which like force and moment is given on the axes of the
    /// point. There, with P the rotation from the point to the tool, the matrices are `P^T C P`.
    fn add_of_tool(&self, terms: &mut [f64; 5], n: &Vector3<f64>, wrench: [&Vector3<f64>; 2]) {
        for (matrix, load) in self.tool.iter().zip(wrench) {
            let symmetric = (matrix + matrix.transpose()) * 0.5;
            let (mean, half) = ((symmetric.m11 + symmetric.m22) * 0.5, (symmetric.m11 - symmetric.m22) * 0.5);
            let (mixed, x, y) = (symmetric.m12, symmetric.m13, symmetric.m23);
            let (same, odd) = (n.x * load.x - n.y * load.y, n.x * load.y + n.y * load.x);
            let (along, aside) = (n.x * load.z + n.z * load.x, n.y * load.z + n.z * load.y);
            terms[0] += mean * (n.x * load.x + n.y * load.y) + symmetric.m33 * n.z * load.z;
            terms[1] += y * aside - x * along;
            terms[2] -= y * along + x * aside;
            terms[3] += half * same - mixed * odd;
            terms[4] += mixed * same + half * odd;
            // What is left of a matrix that is not symmetric turns like a vector.
            let spin = Vector3::new(
                (matrix.m32 - matrix.m23) * 0.5,
                (matrix.m13 - matrix.m31) * 0.5,
                (matrix.m21 - matrix.m12) * 0.5,
            );
            let turned = load.cross(n);
            terms[0] -= spin.z * turned.z;
            terms[1] += spin.x * turned.x - spin.y * turned.y;
            terms[2] += spin.y * turned.x + spin.x * turned.y;
        }
    }
}

impl FixedParts {
    /// At the cosines and sines of beta. m
    #[inline(always)]
    pub fn at<S: Simd, const N: usize>(&self, simd: S, cosine: Lanes<S>, sine: Lanes<S>) -> [Lanes<S>; N] {
        let twice = [cosine * cosine - sine * sine, cosine * sine * 2.0];
        let mut parts = [Lanes::splat(simd, 0.0); N];
        for (part, [a, b, c, d, e]) in parts.iter_mut().zip(self.terms) {
            *part = cosine * b + sine * c + twice[0] * d + twice[1] * e + a;
        }
        parts
    }
}
