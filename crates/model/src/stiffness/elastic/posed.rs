//! The chain of an elastic arm at some coordinates: what each of them moves, what loads do about it.

use super::{COUNT, Coordinates, JOINTS, MOUNT, Square, TIP};
use crate::robot::{Pose, Robot, Spindle};
use crate::stiffness::Displacement;
use nalgebra::{Matrix3, Vector3};

/// What of an arm makes its chain.
pub(super) struct Chain<'a> {
    pub robot: &'a Robot,
    pub spindle: &'a Spindle,
    pub bearings: &'a [f64; 6],
}

/// A coordinate of a posed chain, in the frame in which the arm is given.
#[derive(Clone, Copy)]
struct Coordinate {
    /// The direction of its shift, or the axis of its turn.
    axis: Vector3<f64>,
    /// A point of the axis of a turn; none for a shift. m
    place: Option<Vector3<f64>>,
}

/// A posed chain.
pub(super) struct Posed {
    coordinates: [Coordinate; COUNT],
    /// The frames of the rows, each fixed to its link.
    pub links: [Pose<f64>; 6],
    /// The frame of the flange, fixed to the spindle.
    pub flange: Pose<f64>,
    /// The tool frame.
    pub base_from_tool: Pose<f64>,
}

/// A force and a moment that press on the chain, in the frame in which the arm is given.
#[derive(Clone, Copy)]
pub(super) struct Applied {
    /// They act behind so many coordinates.
    pub behind: usize,
    /// Where. m
    pub point: Vector3<f64>,
    /// N
    pub force: Vector3<f64>,
    /// N m
    pub moment: Vector3<f64>,
}

impl Applied {
    const ZERO: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);
    /// Nothing.
    pub const NONE: Self = Self { behind: 0, point: Self::ZERO, force: Self::ZERO, moment: Self::ZERO };
}

/// The pose behind the coordinates so far.
struct Posing {
    pose: Pose<f64>,
    coordinates: [Coordinate; COUNT],
    count: usize,
}

impl Posing {
    fn add(&mut self, coordinate: Coordinate) {
        self.coordinates[self.count] = coordinate;
        self.count += 1;
    }

    fn go(&mut self, along: Vector3<f64>) {
        self.pose.translation += self.pose.rotation * along;
    }

    fn shifts(&mut self, by: Vector3<f64>) {
        for about in 0..3 {
            self.add(Coordinate { axis: self.pose.rotation.column(about).into_owned(), place: None });
        }
        self.go(by);
    }

    /// A turn about a direction of the frame, x (0), y (1) or z (2), of which an angle (rad) is elastic or not.
    fn turn(&mut self, about: usize, angle: f64) {
        let rotation = &mut self.pose.rotation;
        let axis = rotation.column(about).into_owned();
        let (sine, cosine) = libm::sincos(angle);
        let (first, second) = ((about + 1) % 3, (about + 2) % 3);
        let (a, b) = (rotation.column(first).into_owned(), rotation.column(second).into_owned());
        rotation.set_column(first, &(a * cosine + b * sine));
        rotation.set_column(second, &(b * cosine - a * sine));
        let place = Some(self.pose.translation);
        self.add(Coordinate { axis, place });
    }

    fn matrix(&mut self, q: &Coordinates) {
        let at = self.count;
        self.shifts(Vector3::new(q[at], q[at + 1], q[at + 2]));
        (0..3).for_each(|about| self.turn(about, q[at + 3 + about]));
    }
}

impl Chain<'_> {
    /// The chain commanded to joint angles `theta` (rad), deflected by `q` (m and rad).
    pub fn at(&self, theta: &[f64; 6], q: &Coordinates) -> Posed {
        let none = Coordinate { axis: Vector3::zeros(), place: None };
        let mut posing = Posing { pose: self.robot.cell_from_base(), coordinates: [none; COUNT], count: 0 };
        let point = self.robot.base_compliance().map_or_else(Vector3::zeros, |base| *base.point());
        posing.go(point);
        posing.matrix(q);
        posing.go(-point);
        let mut links = [Pose::identity(); 6];
        for (j, row) in self.robot.rows().iter().enumerate() {
            let bearing = Vector3::new(0.0, 0.0, self.bearings[j]);
            let k = JOINTS + 3 * j;
            posing.pose = posing.pose.then(row);
            posing.go(bearing);
            posing.turn(2, theta[j] + q[k]);
            posing.turn(0, q[k + 1]);
            posing.turn(1, q[k + 2]);
            posing.go(-bearing);
            links[j] = posing.pose;
        }
        debug_assert_eq!(posing.count, MOUNT);
        posing.matrix(q);
        let flange = posing.pose;
        posing.pose = flange.then(&self.spindle.flange_from_tool);
        posing.shifts(Vector3::new(q[TIP], q[TIP + 1], q[TIP + 2]));
        Posed { coordinates: posing.coordinates, links, flange, base_from_tool: posing.pose }
    }
}

/// What presses on all that is behind a coordinate, about the origin of the frame of the arm.
struct Sums {
    force: Vector3<f64>,
    /// Moments that are none of forces.
    moment: Vector3<f64>,
    /// Sum of force times place, row by row of the force.
    virial: Matrix3<f64>,
}

impl Sums {
    fn behind(applied: &[Applied], k: usize) -> Self {
        let mut sums = Self { force: Vector3::zeros(), moment: Vector3::zeros(), virial: Matrix3::zeros() };
        for load in applied.iter().filter(|load| load.behind > k) {
            sums.force += load.force;
            sums.moment += load.moment;
            sums.virial += load.force * load.point.transpose();
        }
        sums
    }

    /// The sum of force times place, seen from a place.
    fn from(&self, place: &Vector3<f64>) -> Matrix3<f64> {
        self.virial - self.force * place.transpose()
    }
}

impl Posed {
    /// What loads do on every coordinate: N m on turns, N on shifts.
    pub fn torques(&self, applied: &[Applied]) -> Coordinates {
        Coordinates::from_fn(|k, _| {
            let Coordinate { axis, place } = &self.coordinates[k];
            let behind = applied.iter().filter(|load| load.behind > k);
            match place {
                None => behind.map(|load| axis.dot(&load.force)).sum(),
                Some(place) => {
                    behind.map(|load| axis.cross(&(load.point - place)).dot(&load.force) + axis.dot(&load.moment)).sum()
                }
            }
        })
    }

    /// The derivative of [`Posed::torques`] by the coordinates, row by row. As in
    /// [`load_hessian`](crate::stiffness::loaded::load_hessian), a moment that keeps its direction makes it
    /// unsymmetric.
    pub fn hessian(&self, applied: &[Applied]) -> Square {
        let mut hessian = Square::zeros();
        for j in 0..COUNT {
            let outer = &self.coordinates[j];
            let sums = Sums::behind(applied, j);
            for i in 0..=j {
                // A shift changes no lever.
                let inner = &self.coordinates[i];
                if inner.place.is_none() {
                    continue;
                }
                let of_force = match &outer.place {
                    None => inner.axis.cross(&outer.axis).dot(&sums.force),
                    Some(place) => {
                        let virial = sums.from(place);
                        outer.axis.dot(&(virial * inner.axis)) - inner.axis.dot(&outer.axis) * virial.trace()
                    }
                };
                hessian[(i, j)] = of_force;
                hessian[(j, i)] = of_force;
                if i < j && outer.place.is_some() {
                    hessian[(j, i)] += inner.axis.cross(&outer.axis).dot(&sums.moment);
                }
            }
        }
        hessian
    }

    /// What small changes of the coordinates do to the tool.
    pub fn moved(&self, by: &Coordinates) -> Displacement<f64> {
        let tip = self.base_from_tool.translation;
        let (mut linear, mut angular) = (Vector3::zeros(), Vector3::zeros());
        for (Coordinate { axis, place }, change) in self.coordinates.iter().zip(by.iter()) {
            match place {
                None => linear += axis * *change,
                Some(place) => {
                    linear += axis.cross(&(tip - place)) * *change;
                    angular += axis * *change;
                }
            }
        }
        Displacement { linear, angular }
    }
}
