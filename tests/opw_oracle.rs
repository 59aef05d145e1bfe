//! The closed-form inverse kinematics against rs-opw-kinematics, on the shipped arm.
//!
//! That crate counts joint angles 2 and 3 from the arm pointing straight up, and tilting forward; the flange frame is
//! the same.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rs_opw_kinematics::glam::DVec3;
use rs_opw_kinematics::kinematic_traits::Kinematics;
use rs_opw_kinematics::kinematics_impl::OPWKinematics;
use rs_opw_kinematics::parameters::opw_kinematics::Parameters;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use stead_format::read_robot;
use stead_model::robot::angles::wrap;
use stead_model::robot::{Posture, Robot};

fn arm() -> Robot {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/robots/kuka-kr270-2.toml");
    read_robot(&file).unwrap()
}

fn oracle() -> OPWKinematics {
    OPWKinematics::new(Parameters {
        a1: 0.35,
        a2: 0.055,
        b: 0.0,
        c1: 0.0,
        c2: 1.25,
        c3: 1.1,
        c4: 0.0,
        offsets: [0.0; 6],
        sign_corrections: [1; 6],
        dof: 6,
    })
}

/// Our joint angles as the oracle counts them, and back: the map is its own inverse.
fn counted_otherwise(theta: &[f64; 6]) -> [f64; 6] {
    [theta[0], FRAC_PI_2 - theta[1], -FRAC_PI_2 - theta[2], theta[3], -theta[4], theta[5]]
}

#[test]
fn agrees_on_poses_and_on_the_set_of_solutions() {
    let (robot, oracle) = (arm(), oracle());
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut solutions = 0;
    for _ in 0..20_000 {
        let theta: [f64; 6] = std::array::from_fn(|_| random.random_range(-3.1..3.1));
        let ours = robot.forward(&theta);
        let theirs = oracle.forward(&counted_otherwise(&theta));
        for k in 0..3 {
            assert!((ours.translation[k] - theirs.translation[k]).abs() < 1e-12);
            for j in 0..3 {
                let axis = theirs.rotation * [DVec3::X, DVec3::Y, DVec3::Z][j];
                assert!((ours.rotation[(k, j)] - axis[k]).abs() < 1e-12);
            }
        }
        let inverse: Vec<[f64; 6]> =
            Posture::ALL.into_iter().filter_map(|posture| robot.inverse(&ours, posture).ok()).collect();
        // Near a singularity the angles are badly determined, here and there.
        if inverse.iter().any(|q| libm::sin(q[4]).abs() < 1e-2 || libm::sin(q[2] + 1.5208).abs() < 1e-2) {
            continue;
        }
        let found = oracle.inverse(&theirs);
        assert_eq!(found.len(), inverse.len(), "{theta:?}");
        for solution in &found {
            let solution = counted_otherwise(solution);
            let distance = |q: &[f64; 6]| (0..6).map(|j| wrap(q[j] - solution[j]).abs()).fold(0.0, f64::max);
            let nearest = inverse.iter().map(distance).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-7, "{nearest} {solution:?}");
        }
        solutions += found.len();
    }
    assert!(solutions > 60_000, "{solutions}");
}
