//! Norms in scores that have their kink near, as second-order cones of the subproblem.

use super::lean_slopes::LeanSlopes;
use super::variables::{Build, Kinked};
use clarabel::solver::{SecondOrderConeT, SupportedConeT};

impl Build<'_> {
    /// One second-order cone for each norm with a kink.
    pub(super) fn cones(&mut self) -> Vec<SupportedConeT<f64>> {
        let (norms, unit) = (self.norms(), self.unit);
        let mut cones = Vec::with_capacity(self.kinked.len());
        for (place, Kinked { place: (i, set), which, vector }) in self.kinked.iter().enumerate() {
            self.rows.add([(norms + place, -1.0)], 0.0);
            for (k, entry) in vector.iter().enumerate() {
                let slopes = entry.gradient.map(|slope| -slope / unit);
                let lean = |lean: &LeanSlopes| lean.sets[*set].kinked[*which][k].map(|slope| -slope / unit);
                self.rows.add(self.terms(*i, &slopes, lean), entry.value / unit);
            }
            cones.push(SecondOrderConeT(1 + vector.len()));
        }
        cones
    }
}
