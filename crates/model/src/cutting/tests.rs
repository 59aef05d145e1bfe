//! Force and moment of a [`RakeFace`] against limits, sums over tooth positions, energy, and coefficients with edge
//! forces.

use super::*;
use crate::task::Wrench;
use nalgebra::{Matrix3, Vector3, vector};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A cutter by its rake face, with its cut.
#[derive(Debug, Clone)]
pub(super) struct Tool {
    radius: f64,
    teeth: u32,
    rotation: Rotation,
    entering_angle: f64,
    helix: f64,
    rake: f64,
    friction: f64,
    normal_pressure: f64,
    feed_per_tooth: f64,
    axial_depth: f64,
}

impl Tool {
    fn face(&self) -> RakeFace {
        let Self { entering_angle, rake, friction, normal_pressure, .. } = *self;
        RakeFace { entering_angle, rake, friction, normal_pressure }
    }

    pub(super) fn cutter(&self) -> Cutter {
        let coefficients = self.face().coefficients(self.helix);
        Cutter::even(self.teeth as usize, self.radius, self.helix, self.rotation, coefficients).unwrap()
    }

    pub(super) fn force<'a>(&self, cutter: &'a Cutter) -> CuttingForce<'a> {
        CuttingForce { cutter, axial_depth: self.axial_depth, feed_per_tooth: self.feed_per_tooth }
    }

    fn force_ratios(&self) -> Vector3<f64> {
        self.face().force_ratios(self.helix)
    }

    fn tooth_wrench(&self, phi: f64) -> Wrench {
        self.force(&self.cutter()).tooth_wrench(phi)
    }

    fn instantaneous_wrench(&self, engagement: &Engagement, phi: f64) -> Wrench {
        self.force(&self.cutter()).instantaneous_wrench(engagement, phi)
    }

    pub(super) fn mean_wrench(&self, engagement: &Engagement) -> Wrench {
        self.force(&self.cutter()).mean_wrench(engagement)
    }
}

/// The case of Klimchik 2017, section 2.2, with a friction of our own.
pub(super) fn published() -> Tool {
    Tool {
        radius: 0.005,
        teeth: 3,
        rotation: Rotation::Clockwise,
        entering_angle: FRAC_PI_2,
        helix: 45_f64.to_radians(),
        rake: 7_f64.to_radians(),
        friction: 0.4,
        normal_pressure: 750e6,
        feed_per_tooth: 8e-5,
        axial_depth: 5e-3,
    }
}

/// Upright edge, no rake, no friction.
fn plain() -> Tool {
    Tool { helix: 0.0, rake: 0.0, friction: 0.0, ..published() }
}

fn rotations() -> impl Strategy<Value = Rotation> {
    any::<bool>().prop_map(|clockwise| if clockwise { Rotation::Clockwise } else { Rotation::Counterclockwise })
}

fn tools() -> impl Strategy<Value = Tool> {
    let angles = (0.1..3.0_f64, -1.5..1.5_f64, -1.5..1.5_f64, 0.0..2.0_f64);
    let cut = (0.001..0.1_f64, 1..12_u32, 1e8..5e9_f64, 1e-5..5e-4_f64, 1e-4..2e-2_f64);
    (rotations(), angles, cut).prop_map(
        |(
            rotation,
            (entering_angle, helix, rake, friction),
            (radius, teeth, normal_pressure, feed_per_tooth, axial_depth),
        )| {
            Tool {
                radius,
                teeth,
                rotation,
                entering_angle,
                helix,
                rake,
                friction,
                normal_pressure,
                feed_per_tooth,
                axial_depth,
            }
        },
    )
}

/// Engagements of all kinds, on a cutter of unit diameter.
fn engagements() -> impl Strategy<Value = Engagement> {
    prop_oneof![
        Just(Engagement::slot()),
        (0.01..=1.0_f64).prop_map(|width| Engagement::up(width, 1.0).unwrap()),
        (0.01..=1.0_f64).prop_map(|width| Engagement::down(width, 1.0).unwrap()),
        (0.01..=1.0_f64).prop_map(|width| Engagement::centred(width, 1.0).unwrap()),
        (0.01..0.99_f64).prop_map(|width| Engagement::open_slot(width, 1.0).unwrap()),
        (0.0..0.5_f64, 0.51..1.0_f64).prop_map(|(entry, exit)| Engagement::between(entry * PI, exit * PI)),
    ]
}

/// The largest difference of two wrenches, over the normal force of all teeth in front, moments with the radius as
/// lever.
fn apart(tool: &Tool, a: &Wrench, b: &Wrench) -> f64 {
    let force = tool.normal_pressure * tool.feed_per_tooth * tool.axial_depth * f64::from(tool.teeth);
    let moments = (a.moment - b.moment).abs().max() / tool.radius;
    (a.force - b.force).abs().max().max(moments) / force
}

fn near(found: Vector3<f64>, expected: Vector3<f64>) {
    assert!((found - expected).abs().max() < 1e-15, "{found} {expected}");
}

#[test]
fn a_plain_tooth_is_pushed_against_its_motion_alone() {
    near(plain().force_ratios(), vector![0.0, -1.0, 0.0]);
    // In front of the tool, a tooth that turns clockwise moves to the right.
    let force = plain().tooth_wrench(FRAC_PI_2);
    assert!((force.force - vector![0.0, 300.0, 0.0]).norm() < 1e-12, "{force:?}");
    assert!((force.moment - vector![0.0, 0.0, 1.5]).norm() < 1e-14, "{force:?}");
    let left_hand = Tool { rotation: Rotation::Counterclockwise, ..plain() }.tooth_wrench(FRAC_PI_2);
    assert!((left_hand.force - vector![0.0, -300.0, 0.0]).norm() < 1e-12, "{left_hand:?}");
    assert!((left_hand.moment - vector![0.0, 0.0, -1.5]).norm() < 1e-14, "{left_hand:?}");
}

#[test]
fn each_angle_and_the_friction_turn_the_force_their_way() {
    let (s, c) = libm::sincos(0.3);
    // Friction pushes the tool away from the work; with an edge that lies over on the work, towards the spindle too.
    near(Tool { friction: 0.3, ..plain() }.force_ratios(), vector![-0.3, -1.0, 0.0]);
    let lying = Tool { entering_angle: 0.3, friction: 0.3, ..plain() };
    near(lying.force_ratios(), vector![-0.3 * s, -1.0, 0.3 * c]);
    // A positive rake draws the tool into the work, a helix of the hand of the cut out of the spindle.
    near(Tool { rake: 0.3, ..plain() }.force_ratios(), vector![s, -c, 0.0]);
    near(Tool { helix: 0.3, ..plain() }.force_ratios(), vector![0.0, -c, -s]);
    near(Tool { helix: -0.3, ..plain() }.force_ratios(), vector![0.0, -c, s]);
    // Merchant's circle: cutting force N cos + F sin, thrust F cos - N sin.
    let sharp = Tool { rake: 0.3, friction: 0.7, ..plain() };
    near(sharp.force_ratios(), vector![-(0.7 * c - s), -(c + 0.7 * s), 0.0]);
}

#[test]
fn a_slot_has_its_closed_form() {
    let tool = published();
    let mean = tool.mean_wrench(&Engagement::slot());
    let [radial, tangential, axial] = (tool.force_ratios() * 300.0 * 3.0).into();
    let force = vector![radial / 4.0, -tangential / 4.0, axial / PI];
    let moment = vector![0.0, -axial / 4.0, -tangential / PI] * 0.005;
    assert!((mean.force - force).norm() < 1e-12 && (mean.moment - moment).norm() < 1e-14, "{mean:?}");
    assert!((mean.force - vector![-61.91, 165.67, -210.94]).abs().max() < 5e-3, "{}", mean.force);
    assert!((mean.moment - vector![0.0, 0.828, 1.055]).abs().max() < 5e-4, "{}", mean.moment);
}

/// Three angles and ratios fitted to three forces, a factor of 2 pi, and one radius for two moments; see the module.
#[test]
fn another_cutter_without_the_mean_gives_the_published_digits() {
    let (helix, rake) = (20_f64.to_radians(), 5_f64.to_radians());
    let tool = Tool { radius: 0.006, helix, rake, ..published() };
    let mean = tool.mean_wrench(&Engagement::slot());
    assert!((mean.force * TAU - vector![-440.0, 1370.0, -635.0]).abs().max() < 0.5, "{}", mean.force * TAU);
    assert!((mean.moment * TAU - vector![0.0, 3.0, 10.5]).abs().max() < 0.05, "{}", mean.moment * TAU);
}

/// Coefficients without edge forces, with `K_t = K_n (cos + k_f sin)` and `K_r = K_n (k_f cos - sin)` of the rake.
#[test]
fn both_models_agree_where_they_say_the_same() {
    let (s, c) = libm::sincos(0.1);
    for rotation in [Rotation::Clockwise, Rotation::Counterclockwise] {
        let tool = Tool { rotation, rake: 0.1, friction: 0.5, ..plain() };
        for (direction, engagement) in [
            (MillingDirection::Conventional, Engagement::up as fn(f64, f64) -> Result<Engagement, EngagementError>),
            (MillingDirection::Climb, Engagement::down),
        ] {
            let coefficients = Coefficients::new(750e6 * (c + 0.5 * s), 750e6 * (0.5 * c - s), 0.0);
            let model = PathForces {
                cutter: Cutter::even(3, 0.005, 0.0, rotation, coefficients).unwrap(),
                cut: Cut { direction, radial_depth: 0.002, axial_depth: 5e-3 },
                feed_per_tooth: 8e-5,
                concave_corners: None,
            };
            for depth in [0.001, 0.005, 0.008, 0.01] {
                let mean = tool.mean_wrench(&engagement(depth, 0.01).unwrap());
                let theirs = model.mean_force(depth);
                assert!((mean.force - theirs).norm() < 1e-12, "{direction:?} {depth} {} {theirs}", mean.force);
            }
        }
    }
}

proptest! {
    #[test]
    fn the_rake_face_is_a_rotation(tool in tools()) {
        let face = tool.face().axes(tool.helix);
        prop_assert!((face.transpose() * face - Matrix3::identity()).abs().max() < 1e-15);
        prop_assert!((face.determinant() - 1.0).abs() < 1e-15);
    }

    /// Midpoint sums over each arc, and over the turn by where the tool says that a tooth cuts.
    #[test]
    fn the_closed_form_agrees_with_summing_over_tooth_positions(tool in tools(), engagement in engagements()) {
        let mean = tool.mean_wrench(&engagement);
        let mut sum = Wrench::default();
        let steps = 500;
        for arc in engagement.arcs() {
            let step = (arc.exit - arc.entry) / f64::from(steps);
            for k in 0..steps {
                let wrench = tool.tooth_wrench(arc.entry + (f64::from(k) + 0.5) * step);
                let share = step / TAU * f64::from(tool.teeth);
                sum.force += wrench.force * share;
                sum.moment += wrench.moment * share;
            }
        }
        prop_assert!(apart(&tool, &mean, &sum) < 3e-6, "{mean:?} {sum:?}");

        let mut turned = Wrench::default();
        let steps = 5000;
        for k in 0..steps {
            // From any start: the teeth follow each other.
            let phi = (f64::from(k) + 0.5) / f64::from(steps) * TAU - 1.0;
            let wrench = tool.instantaneous_wrench(&engagement, phi);
            turned.force += wrench.force / f64::from(steps);
            turned.moment += wrench.moment / f64::from(steps);
        }
        prop_assert!(apart(&tool, &mean, &turned) < 2e-3, "{mean:?} {turned:?}");
    }

    #[test]
    fn arcs_add_up(tool in tools(), width in 0.01..0.99_f64) {
        let mean = |engagement: Engagement| tool.mean_wrench(&engagement);
        let plus = |a: Wrench, b: Wrench| Wrench { force: a.force + b.force, moment: a.moment + b.moment };
        let side = (1.0 - width) / 2.0;
        let (slot, open) = (mean(Engagement::slot()), mean(Engagement::open_slot(width, 1.0).unwrap()));
        let sides = plus(mean(Engagement::up(side, 1.0).unwrap()), mean(Engagement::down(side, 1.0).unwrap()));
        prop_assert!(apart(&tool, &open, &sides) < 1e-15);
        let middle = mean(Engagement::centred(width, 1.0).unwrap());
        prop_assert!(apart(&tool, &slot, &plus(open, middle)) < 1e-15);
        let (up, down) = (Engagement::up(width, 1.0).unwrap(), Engagement::down(1.0 - width, 1.0).unwrap());
        prop_assert!(apart(&tool, &slot, &plus(mean(up), mean(down))) < 1e-14);
    }

    /// The mirror of a cutter in the plane of feed and axis turns the other way; of a moment, the other parts change
    /// sign.
    #[test]
    fn the_other_hand_is_the_mirror_image(tool in tools(), engagement in engagements()) {
        let other = match tool.rotation {
            Rotation::Clockwise => Rotation::Counterclockwise,
            Rotation::Counterclockwise => Rotation::Clockwise,
        };
        let mean = tool.mean_wrench(&engagement);
        let mirrored = Tool { rotation: other, ..tool.clone() }.mean_wrench(&engagement);
        prop_assert_eq!(mirrored.force, mean.force.component_mul(&vector![1.0, -1.0, 1.0]));
        prop_assert_eq!(mirrored.moment, mean.moment.component_mul(&vector![-1.0, 1.0, -1.0]));
    }

    /// The mirror that takes phi to pi - phi takes up milling to down milling, and turns round a force along the
    /// motion.
    #[test]
    fn up_and_down_milling_mirror_each_other(tool in tools(), width in 0.01..=1.0_f64) {
        let balanced = Tool { entering_angle: FRAC_PI_2, friction: libm::tan(tool.rake), ..tool };
        prop_assert!(balanced.force_ratios().x.abs() < 1e-14);
        let up = balanced.mean_wrench(&Engagement::up(width, 1.0).unwrap());
        let down = balanced.mean_wrench(&Engagement::down(width, 1.0).unwrap());
        let turned = |vector: Vector3<f64>| vector.component_mul(&vector![-1.0, 1.0, 1.0]);
        let turned = Wrench { force: turned(up.force), moment: turned(up.moment) };
        prop_assert!(apart(&balanced, &turned, &down) < 1e-14, "{turned:?} {down:?}");
    }

    #[test]
    fn teeth_and_cut_scale_the_wrench(tool in tools(), engagement in engagements()) {
        let one = Tool { teeth: 1, ..tool.clone() }.mean_wrench(&engagement);
        let scaled = Wrench { force: one.force * f64::from(tool.teeth), moment: one.moment * f64::from(tool.teeth) };
        prop_assert!(apart(&tool, &tool.mean_wrench(&engagement), &scaled) < 1e-15);
        let deeper = Tool { axial_depth: tool.axial_depth * 2.0, ..tool.clone() }.mean_wrench(&engagement);
        prop_assert_eq!(deeper.force, tool.mean_wrench(&engagement).force * 2.0);
    }

    /// What spindle and feed give is what the teeth take: the sum over teeth of force times velocity, reckoned tooth by
    /// tooth. Without friction the spindle gives K_n for every volume of chip, but for what the angles turn away from
    /// the motion.
    #[test]
    fn energy_is_conserved(tool in tools(), width in 0.01..=1.0_f64, speed in 1.0..1000.0_f64) {
        let engagement = Engagement::up(width, 1.0).unwrap();
        let mean = tool.mean_wrench(&engagement);
        let feed = tool.feed_per_tooth * f64::from(tool.teeth) * speed / TAU;
        let given = -(mean.moment.z * tool.rotation.sign() * speed + mean.force.x * feed);
        let mut taken = 0.0;
        let steps = 2000;
        let arc = engagement.arcs()[0];
        let step = (arc.exit - arc.entry) / f64::from(steps);
        for k in 0..steps {
            let phi = arc.entry + (f64::from(k) + 0.5) * step;
            let [_, motion] = tool.rotation.tooth(phi);
            let velocity = motion * (tool.radius * speed) + Vector3::x() * feed;
            taken -= tool.tooth_wrench(phi).force.dot(&velocity) * step / TAU * f64::from(tool.teeth);
        }
        let scale = tool.normal_pressure * tool.axial_depth * feed * (tool.radius + tool.feed_per_tooth);
        prop_assert!((given - taken).abs() < 1e-5 * scale, "{given} {taken}");

        let spindle = -mean.moment.z * tool.rotation.sign() * speed;
        let chips = tool.axial_depth * (2.0 * tool.radius * width) * feed;
        let specific = -tool.force_ratios().y * tool.normal_pressure;
        prop_assert!((spindle - specific * chips).abs() < 1e-12 * scale, "{spindle} {}", specific * chips);
    }
}
