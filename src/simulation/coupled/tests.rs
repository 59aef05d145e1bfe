use super::*;
use crate::cutting::Milling as Way;
use crate::simulation::arm::{Variant, testing};
use crate::simulation::milling::{Coefficients, Tooth};
use crate::simulation::motion::{Pass, Ramp};
use std::f64::consts::TAU;

/// The arm on the published pass of a length (m) at a feed (m/s).
fn setup(variant: Variant, damping_scale: f64, feed: f64, length: f64) -> Setup {
    let (robot, spindle) = (testing::tx200(), testing::spindle());
    let pass = Pass { start: testing::start(), direction: Vector3::x(), length };
    let motion = Motion::new(&robot, &spindle, &pass, Ramp { feed, time: 0.2 }).unwrap();
    Setup { robot, spindle, variant, damping_scale, motion }
}

fn cutter(pitch_deg: f64, runout: f64, tangential: f64, radial: f64) -> Cutter {
    let tooth = |pitch: f64, runout| Tooth { pitch: pitch.to_radians(), radius: 5e-3 + runout };
    let teeth = vec![tooth(pitch_deg, runout), tooth(360.0 - pitch_deg, 0.0)];
    let coefficients = Coefficients { tangential, radial, axial: 0.0 };
    Cutter::new(teeth, 30_f64.to_radians(), 0.02, coefficients).unwrap()
}

fn cut(rpm: f64, steps_per_turn: usize) -> Cut {
    Cut {
        milling: Way::Climb,
        radial_depth: 4e-3,
        axial_depth: 1.6e-3,
        length: 0.09,
        spindle_speed: rpm * TAU / 60.0,
        slices: 32,
        steps_per_turn,
    }
}

fn statistics(run: &Run, window: [f64; 2]) -> [[f64; 4]; 2] {
    let mut found = [[0.0, 0.0, f64::MAX, f64::MIN]; 2];
    let mut count = 0.0;
    for (index, sample) in run.samples.iter().enumerate() {
        let time = index as f64 * run.step;
        if time < window[0] || time > window[1] {
            continue;
        }
        count += 1.0;
        for (axis, value) in [sample.force[0], -sample.force[1]].into_iter().enumerate() {
            let [mean, square, least, most] = &mut found[axis];
            *mean += value;
            *square += value * value;
            *least = least.min(value);
            *most = most.max(value);
        }
    }
    found.map(|[mean, square, least, most]| [mean / count, (square / count).sqrt(), least, most])
}

#[test]
fn steel_trial() {
    for damping in [1.0, 10.0] {
        for (steps, fast) in [(90, true), (180, true), (90, false)] {
            let setup = setup(Variant::Springs, damping, 0.28 / 60.0, 0.103);
            let (cutter, cut) = (cutter(180.0, 6.929e-6, 3333e6, 2289e6), cut(3100.0, steps));
            let job = Job { setup: &setup, cutter: &cutter, cut: &cut, gap: 0.5e-3 };
            let tic = std::time::Instant::now();
            let run = if fast { job.run_fast() } else { job.run() }.unwrap();
            eprintln!("damping {damping} {steps} fast={fast} {:.3} s, {} steps {:?} evals {}", tic.elapsed().as_secs_f64(), run.samples.len(), run.end, run.evaluations);
            for from in [2.0, 5.0, 10.0, 15.0] {
                let [x, y] = statistics(&run, [from, from + 3.0]);
                eprintln!("   x {x:.3?} y {y:.3?}");
            }
            let wall = crate::simulation::roughness::Profile::of_wall(&run.trail, &cutter, &cut, 0.8e-3, [0.0, 0.09], 10e-6);
            eprintln!("   wall {:?} {:?} {:.3}", wall.roughness(), wall.filtered(2.5e-3).roughness(), tic.elapsed().as_secs_f64());
        }
    }
    let setup = setup(Variant::Springs, 1.0, 3.7 / 60.0, 0.1079167);
    let (cutter, cut) = (cutter(170.0, 0.0, 661.553e6, 253.458e6), cut(18_700.0, 360));
    let job = Job { setup: &setup, cutter: &cutter, cut: &cut, gap: 0.5e-3 };
    let run = job.run_fast().unwrap();
    for height in [0.2e-3, 0.8e-3, 1.4e-3] {
    for span in [[0.0, 0.09], [0.001, 0.089], [0.005, 0.085], [0.0, 0.095]] {
        let wall = crate::simulation::roughness::Profile::of_wall(&run.trail, &cutter, &cut, height, span, 10e-6);
        let r = |p: &crate::simulation::roughness::Profile| { let r = p.roughness().unwrap(); [r.mean, r.root_mean_square, r.total].map(|v| (v * 1e9).round() / 1e3) };
        eprintln!("   alu wall {span:?} {:?} {:?} ends {:?} {:?}", r(&wall), r(&wall.filtered(2.5e-3)), wall.heights[0], wall.heights.last());
    }
    }
}
