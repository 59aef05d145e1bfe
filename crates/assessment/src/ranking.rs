//! Which robot for which task: accuracy at a force, and the robots that reach a wanted accuracy (Klimchik 2017, Tables
//! 8 and 9).
//!
//! The rule of the tables: the circularity of the best place under the benchmark's force grows in proportion to the
//! force (Table 8); compensating errors leaves a share of it (Table 9: a fifth); and no robot takes a force above the
//! weight of its payload.

use serde::Serialize;

/// What is requested, and what is assumed.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// Wanted accuracies. m
    pub accuracies: Vec<f64>,
    /// Cutting forces in the plane of the circle. N
    pub forces: Vec<f64>,
    /// Share of the circularity that error compensation leaves: 1 without compensation.
    pub remaining_share: f64,
    /// Acceleration that turns a payload into a force. m/s^2
    pub gravity: f64,
}

/// What the selection needs to know of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Competitor {
    /// Its name.
    pub name: String,
    /// Circularity at its best place under the reference force, `None` where it can mill the circle nowhere. m
    pub min: Option<f64>,
    /// Payload, where known. kg
    pub payload: Option<f64>,
}

/// The robots that reach an accuracy under a force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Capable {
    /// The wanted accuracy. m
    pub accuracy: f64,
    /// The cutting force. N
    pub force: f64,
    /// Names of the robots that reach it with errors compensated, in the order they were given.
    pub robots: Vec<String>,
}

/// A robot at one force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Accuracy {
    /// Name of the robot.
    pub robot: String,
    /// The cutting force. N
    pub force: f64,
    /// Circularity without compensation, `None` where the force is more than the robot may take or the circle fits
    /// nowhere. m
    pub circularity: Option<f64>,
}

impl Selection {
    /// Circularity of a robot under a force, without compensation; `reference` is the force behind [`Competitor::min`].
    pub fn circularity(&self, robot: &Competitor, reference: f64, force: f64) -> Option<f64> {
        let too_much = robot.payload.is_some_and(|payload| force > payload * self.gravity * (1.0 + 1e-12));
        robot.min.filter(|_| !too_much).map(|min| min * force / reference)
    }

    /// Every robot at every force, robot by robot (Table 8).
    pub fn accuracies(&self, robots: &[Competitor], reference: f64) -> Vec<Accuracy> {
        let at = |robot: &Competitor, force: f64| Accuracy {
            robot: robot.name.clone(),
            force,
            circularity: self.circularity(robot, reference, force),
        };
        robots.iter().flat_map(|robot| self.forces.iter().map(move |force| at(robot, *force))).collect()
    }

    /// The robots that reach every accuracy under every force, accuracy by accuracy (Table 9).
    pub fn capable(&self, robots: &[Competitor], reference: f64) -> Vec<Capable> {
        let reaches = |robot: &Competitor, accuracy: f64, force: f64| {
            let left = self.circularity(robot, reference, force).map(|value| value * self.remaining_share);
            left.is_some_and(|left| left <= accuracy)
        };
        let cell = |accuracy: f64, force: f64| Capable {
            accuracy,
            force,
            robots: robots.iter().filter(|r| reaches(r, accuracy, force)).map(|r| r.name.clone()).collect(),
        };
        self.accuracies
            .iter()
            .flat_map(|accuracy| self.forces.iter().map(move |force| cell(*accuracy, *force)))
            .collect()
    }
}

/// The names of the robots that can mill the circle at all, the most accurate first; equal ones in the order given.
pub fn order(robots: &[Competitor]) -> Vec<String> {
    let mut able: Vec<(&str, f64)> = robots.iter().filter_map(|r| r.min.map(|min| (r.name.as_str(), min))).collect();
    able.sort_by(|a, b| a.1.total_cmp(&b.1));
    able.into_iter().map(|(name, _)| name.to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Klimchik 2017, Table 5, elbow-down minimum in mm, and Table 3, payload in kg.
    const PRINTED: [(&str, f64, f64); 5] = [
        ("KR 100", 1.03, 100.0),
        ("KR 120", 2.54, 120.0),
        ("KR 270", 0.84, 270.0),
        ("KR 360", 1.02, 360.0),
        ("KR 500", 0.41, 500.0),
    ];

    fn published() -> (Selection, Vec<Competitor>) {
        let selection = Selection {
            accuracies: vec![0.05e-3, 0.1e-3, 0.2e-3, 0.5e-3, 1e-3],
            forces: vec![100.0, 200.0, 500.0, 1000.0, 2000.0, 3000.0],
            remaining_share: 0.2,
            gravity: 10.0,
        };
        let robots = PRINTED.map(|(name, least_mm, payload)| Competitor {
            name: name.to_owned(),
            min: Some(least_mm / 1e3),
            payload: Some(payload),
        });
        (selection, robots.to_vec())
    }

    /// Klimchik 2017, Table 8, in mm.
    const TABLE_8: [[Option<f64>; 6]; 5] = [
        [Some(0.07), Some(0.14), Some(0.36), Some(0.72), None, None],
        [Some(0.18), Some(0.35), Some(0.88), Some(1.76), None, None],
        [Some(0.06), Some(0.12), Some(0.29), Some(0.58), Some(1.17), None],
        [Some(0.07), Some(0.14), Some(0.35), Some(0.71), Some(1.42), Some(2.13)],
        [Some(0.03), Some(0.06), Some(0.14), Some(0.28), Some(0.57), Some(0.85)],
    ];

    #[test]
    fn table_8_follows_from_table_5_cell_by_cell() {
        let (selection, robots) = published();
        let found = selection.accuracies(&robots, 1440.0);
        assert_eq!(found.len(), 30);
        let published = TABLE_8.iter().flatten();
        for (cell, expected) in found.iter().zip(published) {
            let rounded = cell.circularity.map(|value| (value * 1e5).round() / 100.0);
            assert_eq!(rounded, *expected, "{cell:?}");
        }
        assert_eq!(TABLE_8.iter().flatten().flatten().count(), 25);
    }

    /// Klimchik 2017, Table 9: the last three digits of the robots' names.
    const TABLE_9: [[&[u16]; 6]; 5] = {
        const FOUR: &[u16] = &[100, 270, 360, 500];
        const ALL: &[u16] = &[100, 120, 270, 360, 500];
        [
            [ALL, FOUR, &[500], &[], &[], &[]],
            [ALL, ALL, FOUR, &[500], &[], &[]],
            [ALL, ALL, ALL, FOUR, &[500], &[500]],
            [ALL, ALL, ALL, ALL, &[270, 360, 500], &[360, 500]],
            [ALL, ALL, ALL, ALL, &[270, 360, 500], &[360, 500]],
        ]
    };

    #[test]
    fn table_9_follows_from_table_5_cell_by_cell() {
        let (selection, robots) = published();
        let found = selection.capable(&robots, 1440.0);
        assert_eq!(found.len(), 30);
        for (cell, expected) in found.iter().zip(TABLE_9.iter().flatten()) {
            let expected: Vec<String> = expected.iter().map(|number| format!("KR {number}")).collect();
            assert_eq!(cell.robots, expected, "{} m at {} N", cell.accuracy, cell.force);
        }
    }

    #[test]
    fn robots_are_ordered_by_their_best_place() {
        let (_, mut robots) = published();
        assert_eq!(order(&robots), ["KR 500", "KR 270", "KR 360", "KR 100", "KR 120"]);
        robots[4].min = None;
        assert_eq!(order(&robots)[0], "KR 270");
    }
}
