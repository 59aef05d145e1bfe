//! The times of moves between segments, held against the official ruckig.
//!
//! A member of its own, outside the default ones: the official library is the only thing that needs a C++20 compiler.
//! Run it with `cargo test --locked -p ruckig-oracle`.

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use stead_model::robot::Robot;
    use stead_planning::transfer::duration;
    use stead_problem::settings::TransferSettings;
    use stead_problem::testing::five_segments;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn agrees_with_the_official_ruckig(
            from in prop::array::uniform6(-3.0..3.0_f64), to in prop::array::uniform6(-3.0..3.0_f64)
        ) {
            let speeds = [105.0, 101.0, 107.0, 136.0, 129.0, 206.0_f64].map(f64::to_radians);
            let mut problem = five_segments();
            let mut joints = problem.robot.joints().clone();
            for (joint, speed) in joints.iter_mut().zip(speeds) {
                joint.max_speed = Some(speed);
            }
            problem.robot = Robot::new("fast", joints).unwrap();
            let settings = TransferSettings::default();
            let mut input = ruckig::InputParameter::new(6);
            input.current_position = from.to_vec();
            input.target_position = to.to_vec();
            input.max_velocity = speeds.to_vec();
            input.max_acceleration = input.max_velocity.iter().map(|v| v / settings.acceleration_time).collect();
            input.max_jerk = input.max_acceleration.iter().map(|a| a / settings.jerk_time).collect();
            let mut trajectory = ruckig::Trajectory::new_direct(6);
            ruckig::Ruckig::new_direct_and_offline(6).calculate(&mut input, &mut trajectory);
            let found = duration(&problem, &settings, &from, &to).unwrap();
            prop_assert!((found - trajectory.get_duration()).abs() < 1e-9, "{} {}", found, trajectory.get_duration());
        }
    }
}
