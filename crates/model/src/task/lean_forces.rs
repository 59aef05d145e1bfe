//! Wrenches that are computed for every lean of the tool.

use super::lean::Lean;
use super::{KeptPoint, Task, TaskError, Wrench};
use nalgebra::Matrix3;
use std::sync::Arc;

/// The wrenches of a tool that leans, at every point of a path on a grid of lead and tilt.
#[derive(Debug, Clone, PartialEq)]
pub struct LeanForces {
    points: Vec<PointLeanForces>,
}

/// The wrenches of a tool that leans at a path point, each about its own tip, in the workpiece frame.
#[derive(Debug, Clone, PartialEq)]
pub struct PointLeanForces {
    /// Values of lead, ascending. rad
    pub leads: Vec<f64>,
    /// Values of tilt, ascending. rad
    pub tilts: Vec<f64>,
    /// Lead by lead, and tilt by tilt in each.
    pub wrenches: Vec<Wrench>,
    /// The part of each that does not grow with the feed, where that is known.
    pub edges: Option<Vec<Wrench>>,
}

impl PointLeanForces {
    /// Between the values of the grid in proportion to lead and to tilt; outside of them as at the nearest.
    fn at(&self, of: &[Wrench], lean: &Lean) -> Wrench {
        let (lead, tilt) = (share(&self.leads, lean.lead), share(&self.tilts, lean.tilt));
        let mut sum = Wrench::default();
        for (row, of_lead) in [(lead.0, 1.0 - lead.1), (lead.0 + 1, lead.1)] {
            for (column, of_tilt) in [(tilt.0, 1.0 - tilt.1), (tilt.0 + 1, tilt.1)] {
                let share = of_lead * of_tilt;
                if share != 0.0 {
                    let wrench = &of[row * self.tilts.len() + column];
                    sum.force += wrench.force * share;
                    sum.moment += wrench.moment * share;
                }
            }
        }
        sum
    }

    fn all(&self) -> impl Iterator<Item = &Wrench> {
        self.wrenches.iter().chain(self.edges.iter().flatten())
    }
}

/// Number of the last value that is not above another, but the last of all, and the share of the way to the next.
fn share(values: &[f64], at: f64) -> (usize, f64) {
    let number = values.partition_point(|value| *value <= at).saturating_sub(1);
    let Some(next) = values.get(number + 1) else { return (number, 0.0) };
    let way = next - values[number];
    (number, if way > 0.0 { ((at - values[number]) / way).max(0.0) } else { 0.0 })
}

impl LeanForces {
    /// From those of every point.
    ///
    /// # Errors
    /// [`TaskError`] at the first point with another number of wrenches than leans, or with NaN or infinity.
    pub fn new(points: Vec<PointLeanForces>) -> Result<Self, TaskError> {
        for (point, own) in points.iter().enumerate() {
            let leans = own.leads.len() * own.tilts.len();
            let counts = [own.wrenches.len(), own.edges.as_ref().map_or(leans, Vec::len)];
            if let Some(wrenches) = counts.into_iter().find(|count| *count != leans || leans == 0) {
                return Err(TaskError::Wrenches { wrenches, points: leans });
            }
            let is_finite = |wrench: &Wrench| wrench.force.iter().chain(&wrench.moment).all(|v| v.is_finite());
            if !own.all().all(is_finite) {
                return Err(TaskError::NotFinite { point, field: "force of a leaning tool" });
            }
        }
        Ok(Self { points })
    }

    /// The wrench of a lean at a point.
    pub(super) fn wrench(&self, point: usize, lean: &Lean) -> Wrench {
        let own = &self.points[point];
        own.at(&own.wrenches, lean)
    }

    /// The part of it that does not grow with the feed.
    pub(super) fn edge(&self, point: usize, lean: &Lean) -> Option<Wrench> {
        let own = &self.points[point];
        own.edges.as_ref().map(|edges| own.at(edges, lean))
    }

    pub(super) fn thinned(&self, kept: &[KeptPoint]) -> Self {
        Self { points: kept.iter().map(|kept| self.points[kept.point].clone()).collect() }
    }

    pub(super) fn turned(&self, rotation: &Matrix3<f64>) -> Self {
        let mut all = self.clone();
        for point in &mut all.points {
            for wrench in point.wrenches.iter_mut().chain(point.edges.iter_mut().flatten()) {
                *wrench = wrench.turned(rotation);
            }
        }
        all
    }
}

impl Task {
    /// States the wrenches of the tool where it leans, which are then not those of the task carried to its tip.
    ///
    /// # Errors
    /// [`TaskError::Wrenches`] for those of another number of points.
    pub fn with_lean_forces(mut self, forces: Arc<LeanForces>) -> Result<Self, TaskError> {
        if forces.points.len() != self.points().len() {
            return Err(TaskError::Wrenches { wrenches: forces.points.len(), points: self.points().len() });
        }
        self.lean_forces = Some(forces);
        Ok(self)
    }

    /// Whether wrenches are known for every lean of the tool.
    pub fn has_lean_forces(&self) -> bool {
        self.lean_forces.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{BALL, five_segments};
    use super::*;
    use nalgebra::Vector3;
    use stead_numerics::rotation::rotation_from_zyx;

    /// A wrench that is affine in lead and in tilt.
    fn affine(point: usize, lead: f64, tilt: f64) -> Wrench {
        let force = Vector3::new(10.0 + point as f64, 300.0 * lead, -200.0 * tilt + 50.0 * lead * tilt);
        Wrench { force, moment: force * 0.01 }
    }

    fn task() -> Task {
        let task = five_segments();
        let edges = vec![Wrench::default(); task.points().len()];
        let point = |point: usize| {
            let leads = vec![0.0, 0.0, 0.0, 0.1, 0.25];
            let tilts = vec![-0.2, -0.1, 0.0];
            let all = |scale: f64| {
                let at = move |lead: &f64, tilt: &f64| {
                    let Wrench { force, moment } = affine(point, *lead, *tilt);
                    Wrench { force: force * scale, moment: moment * scale }
                };
                leads.iter().flat_map(|lead| tilts.iter().map(move |tilt| at(lead, tilt))).collect::<Vec<_>>()
            };
            PointLeanForces { wrenches: all(1.0), edges: Some(all(0.3)), leads: leads.clone(), tilts: tilts.clone() }
        };
        let forces = LeanForces::new((0..105).map(point).collect()).unwrap();
        task.with_edge_parts(edges).unwrap().with_lean_forces(Arc::new(forces)).unwrap()
    }

    fn apart(a: &Wrench, b: &Wrench) -> f64 {
        (a.force - b.force).norm() + (a.moment - b.moment).norm()
    }

    #[test]
    fn a_leaning_tool_has_the_wrench_of_its_lean() {
        let task = task();
        let lean = |point: usize| Lean { lead: 0.0025 * (point % 100) as f64, tilt: -0.002 * (point % 90) as f64 };
        let leans: Vec<Lean> = (0..105).map(lean).collect();
        let leaned = task.leaned(&BALL, &leans);
        for (point, lean) in leans.iter().enumerate() {
            let expected = match *lean {
                Lean::NONE => task.loads()[point].wrench,
                Lean { lead, tilt } => affine(point, lead, tilt),
            };
            assert!(apart(&leaned.loads()[point].wrench, &expected) < 1e-9, "{point}");
        }
        // Outside of the grid it is that of the nearest lean.
        let beyond = task.leaned(&BALL, &[Lean { lead: -0.1, tilt: 0.3 }; 105]);
        assert!(apart(&beyond.loads()[7].wrench, &affine(7, 0.0, 0.0)) < 1e-12);
        // At half the feed the edges keep their part.
        let slow = leaned.at_feed(|_| 0.5).unwrap();
        let expected = affine(50, leans[50].lead, leans[50].tilt).force * (0.3 + 0.7 * 0.5);
        assert!((slow.loads()[50].wrench.force - expected).norm() < 1e-9);
    }

    #[test]
    fn thinned_and_turned_the_wrenches_stay_those_of_the_leans() {
        let task = task();
        let leans: Vec<Lean> = (0..105).map(|k| Lean { lead: 0.002 * k as f64, tilt: -0.001 * k as f64 }).collect();
        let rotation = rotation_from_zyx([0.3, -0.7, 1.2]);
        let [a, b] = [task.turned(&rotation).leaned(&BALL, &leans), task.leaned(&BALL, &leans).turned(&rotation)];
        for point in 0..105 {
            assert!(apart(&a.loads()[point].wrench, &b.loads()[point].wrench) < 1e-9);
        }
        let kept = [3, 40, 60, 80, 100].map(|point| KeptPoint { point, weight: 21.0 });
        let few: Vec<Lean> = kept.iter().map(|kept| leans[kept.point]).collect();
        let [a, b] = [task.thinned(&kept).leaned(&BALL, &few), task.leaned(&BALL, &leans).thinned(&kept)];
        for place in 0..5 {
            assert!(apart(&a.loads()[place].wrench, &b.loads()[place].wrench) < 1e-12);
        }
    }

    #[test]
    fn forces_that_do_not_fit_are_refused() {
        let wrong = PointLeanForces { leads: vec![0.0], tilts: vec![0.0, 0.1], wrenches: Vec::new(), edges: None };
        assert!(LeanForces::new(vec![wrong.clone()]).is_err());
        let nan = Wrench { force: Vector3::repeat(f64::NAN), ..Wrench::default() };
        let point = PointLeanForces { wrenches: vec![nan, nan], ..wrong };
        assert!(matches!(LeanForces::new(vec![point.clone()]), Err(TaskError::NotFinite { .. })));
        let point = PointLeanForces { wrenches: vec![Wrench::default(); 2], ..point };
        let one = LeanForces::new(vec![point]).unwrap();
        assert!(five_segments().with_lean_forces(Arc::new(one)).is_err());
    }
}
