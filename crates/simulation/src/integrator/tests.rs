use super::*;
use crate::arm::testing::{spindle, start, tx200};
use crate::arm::{Arm, Compensation, Variant};
use stead_model::robot::{Frames, JointDynamics, NormalSprings, Orthogonal, Robot, SpringModel};
use stead_model::stiffness::elastic::ElasticArm;
use stead_model::stiffness::whole::WholeArm;
use stead_model::task::Wrench;

/// The arm by itself with motors at rest, and a force on its tip that swings.
struct Free<const N: usize> {
    arm: Arm<N>,
    reference: SVector<f64, N>,
    force: f64,
    /// A force that stays. N
    constant: nalgebra::Vector3<f64>,
    kept: Vec<f64>,
    evaluations: usize,
}

impl<const N: usize> Free<N> {
    fn new(arm: Arm<N>, reference: SVector<f64, N>) -> Self {
        Self { arm, reference, force: 0.0, constant: nalgebra::Vector3::zeros(), kept: vec![], evaluations: 0 }
    }

    fn energy(&self, state: &MotionState<N>) -> f64 {
        let posed = self.arm.chain.at(&state.q);
        let kinetic = (state.speed.transpose() * posed.mass_matrix(&self.arm.chain) * state.speed)[0] / 2.0;
        let height = if self.arm.feels_gravity() { posed.potential(&self.arm.chain) } else { 0.0 };
        kinetic + height + self.arm.drive.energy(&state.q, &self.reference)
    }
}

impl<const N: usize> System<N> for Free<N> {
    fn unbalanced(&mut self, time: f64, state: &MotionState<N>) -> SVector<f64, N> {
        self.evaluations += 1;
        let posed = self.arm.chain.at(&state.q);
        let push = self.constant + nalgebra::Vector3::new(0.0, self.force * libm::sin(400.0 * time), 0.0);
        let motion = [&state.q, &state.speed, &state.acceleration];
        let mut compensation = Compensation::about(&self.arm, &state.q);
        let reference = [&self.reference, &SVector::zeros()];
        self.arm.unbalanced(&posed, motion, reference, &mut compensation) - posed.tip_torques(&push)
    }

    fn tangent(&mut self, _: f64, state: &MotionState<N>) -> Tangent<N> {
        let posed = self.arm.chain.at(&state.q);
        let springs = self.arm.drive.stiffness_at(&state.q, &self.reference);
        Tangent {
            mass: posed.mass_matrix(&self.arm.chain),
            damping: SMatrix::from_diagonal(&self.arm.drive.damping),
            stiffness: SMatrix::from_diagonal(&springs),
        }
    }

    fn accept(&mut self, time: f64, _: &MotionState<N>) {
        self.kept.push(time);
    }
}

fn at_rest<const N: usize>(q: SVector<f64, N>) -> MotionState<N> {
    MotionState { q, speed: SVector::zeros(), acceleration: SVector::zeros() }
}

const EXACT: Settings = Settings { beta: 0.25, gamma: 0.5, tolerance: 1e-16, max_corrections: 30, max_halvings: 0 };

/// The state after `time` s in steps of `step` s, and the largest change of energy on the way.
fn run<const N: usize>(system: &mut Free<N>, from: &MotionState<N>, step: f64, time: f64) -> (MotionState<N>, f64) {
    let mut state = Newmark::started(system, 0.0, from).unwrap();
    let mut newmark = Newmark::new(EXACT);
    let energy = system.energy(&state);
    let mut off = 0.0_f64;
    for k in 0..(time / step).round() as usize {
        newmark.step(system, step * k as f64, step, &mut state).unwrap();
        off = off.max((system.energy(&state) - energy).abs());
    }
    (state, off)
}

/// Without damping and cutting, the energy of large swings under gravity comes out of balance with the square of the
/// step alone; what goes to and fro is some 50 J.
#[test]
fn energy_is_conserved() {
    let mut arm = Arm::six(&tx200(), &spindle(), Variant::Gravity, &start()).unwrap();
    arm.drive.damping.fill(0.0);
    arm.drive.felt_gravity.fill(1.0);
    let reference = SVector::from(start());
    let mut system = Free::new(arm, reference);
    let mut from = at_rest(reference);
    from.q[1] += 2e-3;
    from.q[3] -= 1e-2;
    from.speed[0] = 0.3;
    from.speed[4] = -0.5;
    let exchanged = system.energy(&from) - system.energy(&at_rest(system.arm.at_rest(&reference)));
    assert!(exchanged > 20.0, "{exchanged}");
    let off = [4e-4, 2e-4, 1e-4, 5e-5].map(|step| run(&mut system, &from, step, 0.2).1 / exchanged);
    assert!(off[3] < 1e-4, "{off:?}");
    for pair in off.windows(2) {
        assert!((pair[0] / pair[1] - 4.0).abs() < 0.4, "{off:?}");
    }
}

/// Springs and a mass that does not change: nothing is lost at any step.
#[test]
fn energy_of_a_linear_system_is_kept_at_any_step() {
    struct LinearArm;
    impl System<2> for LinearArm {
        fn unbalanced(&mut self, _: f64, state: &MotionState<2>) -> SVector<f64, 2> {
            mass() * state.acceleration + stiffness() * state.q
        }
        fn tangent(&mut self, _: f64, _: &MotionState<2>) -> Tangent<2> {
            Tangent { mass: mass(), damping: SMatrix::zeros(), stiffness: stiffness() }
        }
    }
    fn mass() -> SMatrix<f64, 2, 2> {
        SMatrix::from([[2.0, 0.5], [0.5, 1.0]])
    }
    fn stiffness() -> SMatrix<f64, 2, 2> {
        SMatrix::from([[300.0, -100.0], [-100.0, 200.0]])
    }
    let energy = |s: &MotionState<2>| {
        ((s.speed.transpose() * mass() * s.speed)[0] + (s.q.transpose() * stiffness() * s.q)[0]) / 2.0
    };
    for step in [1e-3, 0.1, 2.0] {
        let mut state = Newmark::started(&mut LinearArm, 0.0, &at_rest(SVector::from([0.1, -0.2]))).unwrap();
        let (mut newmark, before) = (Newmark::new(EXACT), energy(&state));
        for k in 0..1000 {
            newmark.step(&mut LinearArm, step * f64::from(k), step, &mut state).unwrap();
        }
        assert!((energy(&state) / before - 1.0).abs() < 1e-10, "{step}: {}", energy(&state) / before);
    }
}

/// The published damped arm with a swinging force: half the step, a quarter of the error.
#[test]
fn the_method_is_of_second_order() {
    fn order<const N: usize>(arm: Arm<N>, reference: SVector<f64, N>) {
        let from = at_rest(arm.at_rest(&reference));
        let mut system = Free::new(arm, reference);
        system.force = 200.0;
        let ends = [8e-4, 4e-4, 2e-4, 1e-4, 2.5e-5].map(|step| run(&mut system, &from, step, 0.04).0.q);
        let errors: Vec<f64> = ends[..4].iter().map(|q| (q - ends[4]).amax()).collect();
        assert!(errors[0] > 1e-9);
        for pair in errors[1..].windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((order - 2.0).abs() < 0.15, "{order} {errors:?}");
        }
    }
    order(Arm::six(&tx200(), &spindle(), Variant::Springs, &start()).unwrap(), SVector::from(start()));
    let many = Arm::eighteen(&tx200(), &spindle(), Variant::Orthogonal, &start()).unwrap();
    order(many, Arm::<18>::spread(&start()));
}

/// A step response settles where the static equilibrium is, play and gravity included.
#[test]
fn swings_die_down_to_the_equilibrium() {
    let mut arm = Arm::six(&tx200(), &spindle(), Variant::Backlash, &start()).unwrap();
    arm.drive.damping *= 10.0;
    arm.drive.felt_gravity.fill(1.0);
    let reference = SVector::from(start());
    let rest = arm.at_rest(&reference);
    let mut system = Free::new(arm, reference);
    let mut state = Newmark::started(&mut system, 0.0, &at_rest(rest.add_scalar(1e-4))).unwrap();
    let mut newmark = Newmark::new(Settings::default());
    for k in 0..20_000 {
        newmark.step(&mut system, 2e-4 * f64::from(k), 2e-4, &mut state).unwrap();
    }
    // Joint 1 carries nothing and may stop anywhere within its play.
    let gap = system.arm.drive.backlash[0];
    assert!((state.q[0] - reference[0]).abs() < gap * 1.01);
    assert!((state.q - rest).rows(1, 5).amax() < 1e-6, "{}", state.q - rest);
}

/// A force that is not smooth: steps are halved where needed, kept in order, and end on time.
struct Wall {
    stiffness: f64,
    kept: Vec<f64>,
}

impl System<1> for Wall {
    fn unbalanced(&mut self, _: f64, state: &MotionState<1>) -> SVector<f64, 1> {
        // Not in the tangent: corrections grow as soon as beta h^2 k is above the mass.
        state.acceleration + state.q * self.stiffness
    }
    fn tangent(&mut self, _: f64, _: &MotionState<1>) -> Tangent<1> {
        Tangent { mass: SMatrix::identity(), damping: SMatrix::zeros(), stiffness: SMatrix::zeros() }
    }
    fn accept(&mut self, time: f64, _: &MotionState<1>) {
        self.kept.push(time);
    }
}

#[test]
fn a_step_that_does_not_converge_is_halved_and_then_reported() {
    let start = |wall: &mut Wall| Newmark::started(wall, 0.0, &at_rest(SVector::from([1.0]))).unwrap();
    let settings = Settings { max_corrections: 40, ..Settings::default() };
    let mut wall = Wall { stiffness: 6.0, kept: vec![] };
    let mut state = start(&mut wall);
    Newmark::new(settings).step(&mut wall, 10.0, 1.0, &mut state).unwrap();
    assert_eq!(wall.kept, [10.5, 11.0]);
    let mut wall = Wall { stiffness: 1e7, kept: vec![] };
    let mut state = start(&mut wall);
    let before = state;
    let error = Newmark::new(settings).step(&mut wall, 10.0, 1.0, &mut state);
    assert_eq!(error, Err(StepError::NotConverged { time: 10.0, step: 1.0 / 64.0 }));
    assert_eq!((state, wall.kept.len()), (before, 0));
}

/// What makes it fast: one evaluation for most steps, and one matrix.
#[test]
fn a_step_takes_about_one_evaluation() {
    let arm = Arm::six(&tx200(), &spindle(), Variant::Springs, &start()).unwrap();
    let mut system = Free::new(arm, SVector::from(start()));
    system.force = 50.0;
    let mut state = at_rest(SVector::from(start()));
    let mut newmark = Newmark::new(Settings::default());
    for k in 0..1000 {
        newmark.step(&mut system, 3.6e-5 * f64::from(k), 3.6e-5, &mut state).unwrap();
    }
    assert!(system.evaluations < 1100, "{}", system.evaluations);
}

/// What shakes out of the motion under a force that stays is what the static sum over all springs has, and with the
/// exact equilibrium under weight and force to more digits.
#[test]
fn an_arm_of_eighteen_springs_comes_to_rest_where_the_static_sum_has_it() {
    let (robot, spindle, theta) = (full(), spindle(), start());
    let force = nalgebra::Vector3::new(60.0, -80.0, 50.0);
    let reference = Arm::<18>::spread(&theta);
    let mut arm = Arm::eighteen(&robot, &spindle, Variant::Springs, &theta).unwrap();
    // Static: damping only ends the swinging sooner.
    arm.drive.damping *= 8.0;
    let tip = |q: &SVector<f64, 18>| arm.chain.at(q).tip();
    let mut system = Free::new(arm.clone(), reference);
    system.constant = force;
    let settled = run(&mut system, &at_rest(reference), 1e-3, 4.0).0;
    assert!(settled.speed.amax() < 1e-9, "{}", settled.speed.amax());
    let found = tip(&settled.q) - tip(&reference);
    let frames = Frames::new(&robot, &theta);
    let whole = WholeArm::new(&robot, &spindle, &frames, robot.compliances_at(&theta), tip(&reference));
    let sum = whole.displacement(&force, &nalgebra::Vector3::zeros()).linear;
    assert!((found - sum).norm() < 5e-4 * sum.norm() && sum.norm() > 5e-5, "{found} {sum}");
    let load = Wrench { force, moment: nalgebra::Vector3::zeros() };
    let exact = ElasticArm::new(&robot, &spindle).at_rest(&theta, &load).unwrap().translation;
    assert!((tip(&settled.q) - exact).norm() < 1e-10, "{} {exact}", tip(&settled.q));
}

#[test]
fn weight_and_compensators_bend_the_arm_as_the_static_chain_has_it() {
    let (robot, spindle, theta) = (full(), spindle(), start());
    let arm = Arm::eighteen(&robot, &spindle, Variant::Orthogonal, &theta).unwrap();
    let reference = Arm::<18>::spread(&theta);
    let tip = |q: &SVector<f64, 18>| arm.chain.at(q).tip();
    let found = tip(&arm.at_rest(&reference)) - tip(&reference);
    let elastic = ElasticArm::new(&robot, &spindle).in_gravity(*arm.chain.free_fall());
    let load = Wrench::default();
    let exact = elastic.at_rest(&theta, &load).unwrap().translation - tip(&reference);
    // Compensators are taken at the commanded angles there and at the deflected ones here.
    assert!((found - exact).norm() < 2e-3 * exact.norm() && exact.norm() > 1e-4, "{found} {exact}");
    assert!((elastic.sag(&theta).linear - exact).norm() < 5e-3 * exact.norm());
    // Without compensators the two are one.
    let links = robot.dynamics().unwrap().map(|joint| JointDynamics { gravity_compensated: false, ..joint });
    let robot = robot.clone().with_dynamics(links);
    let arm = Arm::eighteen(&robot, &spindle, Variant::Orthogonal, &theta).unwrap();
    let elastic = ElasticArm::new(&robot, &spindle).in_gravity(*arm.chain.free_fall());
    let exact = elastic.at_rest(&theta, &load).unwrap().translation;
    assert!((tip(&arm.at_rest(&reference)) - exact).norm() < 1e-10);
}

/// The arm with springs normal to its axes, unlike each other.
fn full() -> Robot {
    let robot = tx200();
    let dynamics = robot.dynamics().unwrap();
    let stiffness = |j: usize| [13.1e6 - 2e6 * j as f64, 2.1e6 + 1.1e6 * j as f64];
    let normal = std::array::from_fn(|j| NormalSprings {
        compliance: stiffness(j).map(|stiffness| 1.0 / stiffness),
        bearing: dynamics[j].bearing,
    });
    let damping = [1000.0; 2];
    let links = std::array::from_fn(|j| JointDynamics {
        orthogonal: Some(Orthogonal { stiffness: stiffness(j), damping }),
        ..dynamics[j]
    });
    let robot = robot.clone().with_dynamics(links).with_normal_springs(Some(normal)).unwrap();
    robot.with_spring_model(Some(SpringModel::Full))
}
