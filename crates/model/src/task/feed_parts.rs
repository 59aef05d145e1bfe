//! Forces that grow with the feed, and forces that do not.
//!
//! The mean force of a cut is affine in the feed: chips take a force in proportion to their thickness, edges one that
//! knows nothing of it,
//!
//! ```text
//! F(v) = F_edge + v / v_programmed F_chip
//! ```

use super::{Task, TaskError, Wrench};

impl Task {
    /// States which part of every wrench does not grow with the feed; none of a point that is not scored, whatever is
    /// given for it.
    ///
    /// # Errors
    /// [`TaskError::Wrenches`] when the numbers differ, [`TaskError::NotFinite`] for a wrench with NaN or infinity.
    pub fn with_edge_parts(mut self, edges: Vec<Wrench>) -> Result<Self, TaskError> {
        self.edges = Some(Self::new(self.path.clone(), edges)?.wrenches);
        Ok(self)
    }

    /// Whether it is known how the wrenches change with the feed.
    pub fn has_edge_parts(&self) -> bool {
        self.edges.is_some()
    }

    /// The same task cut with another feed at every point, over the programmed one; `None` where it is not known how
    /// the wrenches change with it.
    pub fn at_feed(&self, share: impl Fn(usize) -> f64) -> Option<Self> {
        let at = |(point, (wrench, edge)): (usize, (&Wrench, &Wrench))| match share(point) {
            // To the last digit.
            1.0 => *wrench,
            share => Wrench {
                force: edge.force + (wrench.force - edge.force) * share,
                moment: edge.moment + (wrench.moment - edge.moment) * share,
            },
        };
        let wrenches = self.wrenches.iter().zip(self.edges.as_ref()?).enumerate().map(at).collect();
        Some(Self { wrenches, ..self.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::five_segments;
    use super::super::{KeptPoint, Task, Wrench};
    use stead_numerics::rotation::rotation_from_zyx;

    #[test]
    fn the_part_of_the_edges_stays_when_the_feed_falls() {
        let task = five_segments();
        assert_eq!(task.at_feed(|_| 0.5), None);
        let edge = |wrench: &Wrench| Wrench { force: wrench.force * 0.25, moment: wrench.moment * 0.25 };
        let edges = task.wrenches().iter().map(edge).collect();
        let task = Task::new(task.path().clone(), task.wrenches().to_vec()).unwrap().with_edge_parts(edges).unwrap();
        assert_eq!(task.at_feed(|_| 1.0).as_ref(), Some(&task));
        // A turned and thinned task knows them too.
        let rotation = rotation_from_zyx([0.3, -0.7, 1.2]);
        let kept: Vec<KeptPoint> = (0..5).map(|segment| KeptPoint { point: 21 * segment + 3, weight: 21.0 }).collect();
        for (task, whole) in
            [(task.turned(&rotation), task.turned(&rotation)), (task.thinned(&kept), task.thinned(&kept))]
        {
            let slow = task.at_feed(|point| if point == 2 { 0.4 } else { 1.0 }).unwrap();
            for (point, (slow, whole)) in slow.wrenches().iter().zip(whole.wrenches()).enumerate() {
                let share = if point == 2 { 0.25 + 0.4 * 0.75 } else { 1.0 };
                assert!((slow.force - whole.force * share).norm() < 1e-12 && slow.force.norm() > 0.0);
            }
        }
    }
}
