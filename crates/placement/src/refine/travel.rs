//! The joint travel in the objective of the subproblem.

use super::variables::Build;

impl Build<'_> {
    /// Counts the size of a joint's step (rad), where joint travel counts.
    pub(super) fn step_size(&mut self, step: f64, row: &[(usize, f64)]) {
        if self.travel.weight == 0.0 {
            return;
        }
        let swing = self.request.trust * row.iter().map(|(_, v)| v.abs()).sum::<f64>();
        if step.abs() > swing {
            let weight = self.travel.weight * step.signum();
            self.travel.here += weight * step;
            self.travel.slopes.extend(row.iter().map(|(column, slope)| (*column, weight * slope)));
            return;
        }
        let size = self.sizes() + self.travel.sizes;
        self.travel.sizes += 1;
        self.travel.slopes.push((size, self.travel.weight));
        for sign in [1.0, -1.0] {
            let terms = row.iter().map(|(column, slope)| (*column, sign * slope)).chain([(size, -1.0)]);
            self.rows.add(terms, -sign * step);
        }
    }
}
