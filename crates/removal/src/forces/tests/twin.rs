//! Forces from what is removed against those of one engagement, which know of no path and of no stock: for flat cutters
//! each is the plain twin of the other.

use super::oracles::OF_CASES;
use super::*;
use stead_model::cutting::{CuttingForce, Engagement};
use stead_model::task::Wrench;

/// The mean of one engagement along feed, left and axis, with and without the lever of the height.
fn of_engagement(depth_mm: f64, engagement: &Engagement) -> [Wrench; 2] {
    let mill = mill(16.0, 0.0, 0.0);
    let force = CuttingForce { cutter: &mill.cutter, axial_depth: depth_mm / 1e3, feed_per_tooth: 5e-5 };
    let low = force.mean_wrench(engagement);
    [low, Wrench { moment: low.moment + force.lever(&low.force), ..low }]
}

/// The closed forms that removal is held against were reckoned by themselves: they are those of one engagement with the
/// lever of the height, to their last figure.
#[test]
fn closed_forms_of_shoulders_are_those_of_one_engagement_with_its_lever() {
    let up = |width: f64| Engagement::up(width / 1e3, 0.016).unwrap();
    let down = |width: f64| Engagement::down(width / 1e3, 0.016).unwrap();
    let cuts = [(5.0, Engagement::slot()), (5.0, up(4.0)), (5.0, down(4.0)), (10.0, down(1.0)), (10.0, up(0.2))];
    for ((depth, engagement), (force, moment, ..)) in cuts.iter().zip(OF_CASES) {
        let [_, wrench] = of_engagement(*depth, engagement);
        assert!((wrench.force - Vector3::from(force)).amax() < 0.6e-4, "{engagement:?} {}", wrench.force);
        assert!((wrench.moment * 1e3 - Vector3::from(moment)).amax() < 0.6e-3, "{engagement:?} {}", wrench.moment);
    }
}

/// Any width, depth and side: forces are equal, and the moments differ by the lever.
#[test]
fn a_flat_cutter_has_the_force_of_one_engagement_and_its_moment_with_the_lever() {
    let mut squares = Vec::new();
    for (number, (width, depth)) in [(2.3, 7.0), (6.5, 3.2), (9.0, 12.0), (13.0, 4.4)].into_iter().enumerate() {
        for is_up in [true, false] {
            let y = if is_up { [8.0 - width, 30.0] } else { [-30.0, width - 8.0] };
            let made = if is_up { Engagement::up(width / 1e3, 0.016) } else { Engagement::down(width / 1e3, 0.016) };
            let [low, high] = of_engagement(depth, &made.unwrap());
            let found = found(&shoulder(y, &along_x(depth)));
            let lever = (high.moment - low.moment).norm();
            // The floors of flat cutters: 1.5 % rms and 4 % at most of the force, 4 % of the moment.
            for load in &found.points[8..22] {
                let all = load.at_feed(1.0);
                let off = (all.force - low.force).norm() / low.force.norm();
                squares.push(off * off);
                assert!(off < 0.04, "{number} {is_up}: {off}");
                let off = (all.moment - high.moment).norm() / high.moment.norm();
                assert!(off < 0.04, "{number} {is_up}: moment {off}");
                // Without the lever it is another moment.
                assert!((all.moment - low.moment).norm() > 0.9 * lever, "{number} {is_up}");
            }
        }
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!(rms < 0.015, "{rms} rms");
}
