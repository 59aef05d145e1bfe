//! What the criterion makes of a deflection.

use crate::arm::{Arm, Law};
use crate::cell::Cell;
use crate::path::Point;
use crate::values::{number, section, text};
use crate::yielding::Loading;
use nalgebra::{DVector, Matrix3, Vector3};

/// The criterion as the run states it.
pub(crate) struct Criterion {
    /// Feed, wall, axis, surface.
    weights: [f64; 4],
    pub aggregate: String,
    force_uncertainty: f64,
    confidence: f64,
    /// What a radian of joint travel counts in every 10 mm of the cut. m/rad
    travel_weight: f64,
    is_worst_of_sets: bool,
    /// Numbers and weights of segments.
    segments: Vec<(usize, f64)>,
}

/// An arm at a path point under the load there.
pub(crate) struct Loaded<'a> {
    pub loading: Loading<'a>,
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
    /// Axes of the point as columns, and the normal of the surface, in the cell.
    pub axes: Matrix3<f64>,
    pub normal: Option<Vector3<f64>>,
}

impl Criterion {
    pub(crate) fn read(cell: &Cell) -> Self {
        let table = section(&cell.run, "criterion");
        let of = |key: &str| table.and_then(|table| number(table, key)).unwrap_or(0.0);
        let word = |key: &str| table.and_then(|table| text(table, key));
        let weights = match table.and_then(|table| section(table, "weights")) {
            Some(weights) => ["feed", "wall", "axis", "surface"].map(|key| number(weights, key).unwrap_or(0.0)),
            None => match word("direction").unwrap_or("wall") {
                "surface" => [0.0, 0.0, 0.0, 1.0],
                "axis" => [0.0, 0.0, 1.0, 0.0],
                "total" => [1.0, 1.0, 1.0, 0.0],
                _ => [0.0, 1.0, 0.0, 0.0],
            },
        };
        let segments = crate::values::sections(&cell.run, "segment")
            .into_iter()
            .filter_map(|table| Some((number(table, "number")? as usize, number(table, "weight")?)))
            .collect();
        Self {
            weights,
            aggregate: word("aggregate").unwrap_or("mean").to_owned(),
            force_uncertainty: of("force_uncertainty"),
            confidence: of("confidence"),
            travel_weight: of("joint_travel_weight_mm_per_rad") * 1e-3,
            is_worst_of_sets: word("over") == Some("worst"),
            segments,
        }
    }

    pub(crate) fn weight(&self, point: &Point) -> f64 {
        if !point.is_scored {
            return 0.0;
        }
        self.segments.iter().find(|(number, _)| *number == point.segment).map_or(1.0, |(_, weight)| *weight)
    }

    /// Scored directions, each as long as the root of its weight.
    fn directions(&self, load: &Loaded<'_>) -> Vec<Vector3<f64>> {
        let known = [0, 1, 2].map(|k| Some(load.axes.column(k).into_owned())).into_iter().chain([load.normal]);
        known.zip(self.weights).filter_map(|(v, weight)| Some(v? * weight.sqrt())).filter(|v| v.norm() > 0.0).collect()
    }

    /// The score of a point under the arm itself, or all sets. m
    pub(crate) fn score(&self, cell: &Cell, load: &Loaded<'_>) -> f64 {
        let under = |arm: &Arm| self.score_of(cell, arm, load);
        match (&cell.sets[..], self.is_worst_of_sets) {
            ([], _) => under(&cell.arm),
            (sets, true) => sets.iter().map(under).fold(0.0, f64::max),
            (sets, false) => sets.iter().map(under).sum::<f64>() / sets.len() as f64,
        }
    }

    /// What each thing that yields adds to the size of the scored part, under the arm itself. m
    pub(crate) fn by_origin(&self, cell: &Cell, load: &Loaded<'_>) -> [f64; 6] {
        let directions = self.directions(load);
        let all = load.loading.by_origin(cell, &cell.arm, &load.force, &load.moment);
        let whole: Vector3<f64> = all.iter().sum();
        let parts: Vec<f64> = directions.iter().map(|v| v.dot(&whole)).collect();
        let size = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        let along = |v: &Vector3<f64>| directions.iter().zip(&parts).map(|(d, part)| d.dot(v) * part).sum::<f64>();
        all.map(|v| if size > 0.0 { along(&v) / size } else { 0.0 })
    }

    fn score_of(&self, cell: &Cell, arm: &Arm, load: &Loaded<'_>) -> f64 {
        let directions = self.directions(load);
        let parts = |arm: &Arm, force: &Vector3<f64>, moment: &Vector3<f64>| {
            let moved = load.loading.moved(cell, arm, force, moment);
            DVector::from_iterator(directions.len(), directions.iter().map(|v| v.dot(&moved)))
        };
        let own = parts(arm, &load.force, &load.moment);
        let mut score = own.norm();
        let size = self.force_uncertainty * load.force.norm();
        if size > 0.0 {
            // The largest norm over the ball lies on its surface; it rises with every step of this fixed point.
            let gain = [Vector3::x(), Vector3::y(), Vector3::z()].map(|unit| parts(arm, &unit, &Vector3::zeros()));
            let with = |error: &Vector3<f64>| &own + &gain[0] * error.x + &gain[1] * error.y + &gain[2] * error.z;
            let mut worst = score;
            for start in 0..26 {
                let k = start + usize::from(start >= 13);
                let mut error = Vector3::new((k % 3) as f64 - 1.0, (k / 3 % 3) as f64 - 1.0, (k / 9) as f64 - 1.0)
                    .normalize()
                    * size;
                for _ in 0..2000 {
                    let found = with(&error);
                    let slope = Vector3::from_fn(|k, _| gain[k].dot(&found));
                    if slope.norm() == 0.0 {
                        break;
                    }
                    let next = slope.normalize() * size;
                    let has_settled = (next - error).norm() < 1e-13 * size;
                    error = next;
                    if has_settled {
                        break;
                    }
                }
                worst = worst.max(with(&error).norm());
            }
            score = worst;
        }
        if self.confidence > 0.0
            && let Some((names, matrix)) = &arm.covariance
        {
            let slopes = DVector::from_iterator(
                names.len(),
                names.iter().map(|name| {
                    let value = |share: f64| {
                        let [changed, step] = [arm.with(name, share), arm.with(name, -share)];
                        let ((above, up), (below, down)) = (changed, step);
                        let found = |arm: &Arm| {
                            let found = parts(arm, &load.force, &load.moment);
                            if directions.len() == 1 { found[0] } else { found.norm() }
                        };
                        (found(&above) - found(&below)) / (up - down)
                    };
                    value(1e-4)
                }),
            );
            score += self.confidence * (slopes.dot(&(matrix * &slopes))).max(0.0).sqrt();
        }
        score
    }

    /// The figure that scores with their points make up. m
    pub(crate) fn objective(&self, points: &[Point], scores: &[f64]) -> f64 {
        let weights: Vec<f64> = points.iter().map(|point| self.weight(point)).collect();
        let sum = |of: &dyn Fn(f64) -> f64| weights.iter().zip(scores).map(|(w, s)| w * of(*s)).sum::<f64>();
        let total: f64 = weights.iter().sum();
        match self.aggregate.as_str() {
            "rms" => (sum(&|s| s * s) / total).sqrt(),
            "max" => weights.iter().zip(scores).map(|(w, s)| w * s).fold(0.0, f64::max),
            _ => sum(&|s| s) / total,
        }
    }
}

impl Criterion {
    /// What a radian of joint travel along these points adds to the objective. m/rad
    pub(crate) fn per_radian(&self, points: &[Point]) -> f64 {
        let pairs = points.windows(2).filter(|pair| pair[0].segment == pair[1].segment);
        let length: f64 = pairs.map(|pair| (pair[1].place - pair[0].place).norm()).sum();
        self.travel_weight / (length / 0.01).max(1.0)
    }
}

impl Arm {
    /// The arm with a parameter of its file larger by a share, and by how much in the unit of the file.
    fn with(&self, name: &str, share: f64) -> (Self, f64) {
        let mut arm = self.clone();
        let number: Option<usize> = name.strip_prefix("joints[").and_then(|rest| rest.split(']').next()?.parse().ok());
        let Some(row) = number.and_then(|number| arm.rows.get_mut(number.wrapping_sub(1))) else { return (arm, 1.0) };
        let scale = 1.0 + share;
        if let (Some((_, about)), Some(normal)) =
            (name.split_once("orthogonal_compliance_urad_per_nm"), &mut arm.normal)
        {
            let joint = number.unwrap_or(1) - 1;
            let step = grown(&mut normal[joint].about[usize::from(about == "[2]")], scale, 1e6);
            return (arm, step);
        }
        let step = match &mut row.law {
            Law::Spring { stiffness, .. } if name.ends_with("spring_stiffness_n_per_mm") => {
                grown(stiffness, scale, 1e-3)
            }
            Law::Spring { free, .. } if name.ends_with("free_length_mm") => grown(free, scale, 1e3),
            Law::Range(at_min, _) if name.ends_with("[1]") => grown(at_min, scale, 1e6),
            Law::Range(_, at_max) => grown(at_max, scale, 1e6),
            Law::Constant(value) | Law::Spring { alone: value, .. } if name.ends_with("stiffness_mnm_per_rad") => {
                let stiffness = 1e-6 / *value;
                *value /= scale;
                stiffness * share
            }
            Law::Constant(value) | Law::Spring { alone: value, .. } => grown(value, scale, 1e6),
        };
        (arm, step)
    }
}

fn grown(value: &mut f64, scale: f64, unit: f64) -> f64 {
    let old = *value;
    *value *= scale;
    (*value - old) * unit
}
