//! The arm as a finite chain at rest, in which turns do not commute and levers change: what the sum over everything
//! that yields is the slope of.

use super::*;
use nalgebra::{DMatrix, DVector};
use stead_numerics::rotation::{rotation_from_vector, rotation_vector};

/// The coordinates of a chain: six of the base, three of every joint, six of the flange.
const COUNT: usize = 30;

struct FiniteArm<'a> {
    robot: &'a Robot,
    spindle: &'a Spindle,
    theta: [f64; 6],
}

/// A coordinate of a posed chain: the axis of its shift or turn in the base frame, and a point of the axis of a turn.
struct Coordinate {
    axis: Vector3<f64>,
    place: Option<Vector3<f64>>,
}

/// A posed chain as it is put together from the base on.
struct Posing {
    pose: Pose<f64>,
    coordinates: Vec<Coordinate>,
}

impl Posing {
    fn shift(&mut self, by: Vector3<f64>) {
        self.pose = self.pose.then(&Pose { translation: by, ..Pose::identity() });
    }

    /// Three shifts and three turns that come together, by values so small that their order does not matter to second
    /// order.
    fn matrix(&mut self, q: &[f64]) {
        let axes = self.pose.rotation;
        let columns = [0, 1, 2].map(|k| axes.column(k).into_owned());
        self.coordinates.extend(columns.map(|axis| Coordinate { axis, place: None }));
        self.shift(vector![q[0], q[1], q[2]]);
        let place = Some(self.pose.translation);
        self.coordinates.extend(columns.map(|axis| Coordinate { axis, place }));
        self.pose.rotation *= rotation_from_vector(&vector![q[3], q[4], q[5]]);
    }

    fn turn(&mut self, about: usize, angle: f64) {
        let axis = self.pose.rotation.column(about).into_owned();
        self.coordinates.push(Coordinate { axis, place: Some(self.pose.translation) });
        self.pose.rotation *= rotation_from_vector(&Vector3::ith(about, angle));
    }
}

impl FiniteArm<'_> {
    /// The compliance of all coordinates.
    fn compliance(&self) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(COUNT, COUNT);
        all.view_mut((0, 0), (6, 6)).copy_from(self.robot.base_compliance().unwrap().matrix());
        let axial = self.robot.compliances_at(&self.theta);
        for j in 0..6 {
            let [x, y] = self.robot.normal_springs().unwrap()[j].compliance;
            for (k, compliance) in [axial[j], x, y].into_iter().enumerate() {
                all[(6 + 3 * j + k, 6 + 3 * j + k)] = compliance;
            }
        }
        all.view_mut((24, 24), (6, 6)).copy_from(&self.spindle.mount.unwrap());
        all
    }

    /// The tool frame where the coordinates are `q`, and what each of them moves.
    fn at(&self, q: &[f64]) -> (Pose<f64>, Vec<Coordinate>) {
        let mut posing = Posing { pose: Pose::identity(), coordinates: Vec::new() };
        let point = *self.robot.base_compliance().unwrap().point();
        posing.shift(point);
        posing.matrix(&q[..6]);
        posing.shift(-point);
        for j in 0..6 {
            let bearing = vector![0.0, 0.0, self.robot.normal_springs().unwrap()[j].bearing];
            posing.pose = posing.pose.then(&self.robot.rows()[j]);
            posing.shift(bearing);
            // Behind the drive's turn come the elastic ones, about z, x and y.
            let [z, x, y] = [0, 1, 2].map(|k| q[6 + 3 * j + k]);
            posing.turn(2, self.theta[j] + z);
            posing.turn(0, x);
            posing.turn(1, y);
            posing.shift(-bearing);
        }
        posing.matrix(&q[24..]);
        (posing.pose.then(&self.spindle.flange_from_tool), posing.coordinates)
    }

    /// The tool frame at rest under a force and a moment that keep their directions.
    fn at_rest(&self, force: &Vector3<f64>, moment: &Vector3<f64>) -> Pose<f64> {
        let compliance = self.compliance();
        let mut q = DVector::zeros(COUNT);
        for _ in 0..60 {
            let (tool, coordinates) = self.at(q.as_slice());
            let torque = coordinates.iter().map(|Coordinate { axis, place }| match place {
                None => axis.dot(force),
                Some(place) => axis.cross(&(tool.translation - place)).dot(force) + axis.dot(moment),
            });
            q = &compliance * DVector::from_iterator(COUNT, torque);
        }
        self.at(q.as_slice()).0
    }
}

#[test]
fn the_sum_is_the_slope_of_the_finite_chain_at_rest() {
    for (number, arm) in odd_arms().into_iter().enumerate().step_by(3) {
        let (robot, mut spindle) = everything(arm);
        spindle.tip = None;
        let k = number as f64;
        let theta = [0.3 + 0.1 * k, -0.4, 0.7 - 0.1 * k, 1.1, -0.9 + 0.05 * k, 2.0];
        let (force, moment) = (vector![120.0, -80.0, 60.0], vector![4.0, -7.0, 12.0]);
        let chain = FiniteArm { robot: &robot, spindle: &spindle, theta };
        let [up, down] = [0.002, -0.002].map(|share| chain.at_rest(&(force * share), &(moment * share)));
        let linear = (up.translation - down.translation) / 0.004;
        let angular = rotation_vector(&(up.rotation * down.rotation.transpose())) / 0.004;
        let frames = Frames::new(&robot, &theta);
        let tip = frames.base_from_flange.point(&spindle.flange_from_tool.translation);
        let arm = WholeArm::new(&robot, &spindle, &frames, robot.compliances_at(&theta), tip);
        let found = arm.displacement(&force, &moment);
        assert!((found.linear - linear).norm() < 3e-9 * linear.norm(), "{} {linear}", found.linear);
        assert!((found.angular - angular).norm() < 3e-9 * angular.norm(), "{} {angular}", found.angular);
    }
}
