use super::*;
use stead_planning::testing::five_segments;

#[test]
fn timing_of_tolerances() {
    let problem = five_segments();
    let placement = Placement::from([0.0, -1.64, -0.214, 1.3788]);
    let start = std::time::Instant::now();
    let found = tolerances(&problem, &placement, nalgebra::Matrix3::identity(), &Monitor::silent());
    panic!("{:?} {found:#?}", start.elapsed());
}
