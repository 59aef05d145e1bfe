use super::*;
use proptest::prelude::*;

/// Cases with their results, computed apart from this code: lengths in mm.
const ORACLE: &str = include_str!("../../../data/lean-oracle.csv");

struct Case {
    name: String,
    rule: LeanRule,
    point: PathPoint,
    normal: Option<Vector3<f64>>,
    lean: Lean,
    verdict: String,
    axis: Option<Vector3<f64>>,
    tip: Option<Vector3<f64>>,
    contact: Option<Vector3<f64>>,
    tool_x: Option<Vector3<f64>>,
}

fn cases() -> Vec<Case> {
    let mut reader = csv::Reader::from_reader(ORACLE.as_bytes());
    let rows = reader.records().map(|row| {
        let row = row.unwrap();
        let number = |k: usize| row[k].parse::<f64>().ok();
        let vector = |k: usize| Some(Vector3::new(number(k)?, number(k + 1)?, number(k + 2)?));
        let contact = match &row[3] {
            "centre" => ContactRule::Centre,
            "contact" => ContactRule::Contact,
            _ => ContactRule::Plane,
        };
        let end = CutterEnd { radius: number(1).unwrap() * 1e-3, corner: number(2).unwrap() * 1e-3 };
        Case {
            name: row[0].to_owned(),
            rule: LeanRule { end, contact, force: LeanForce::Feed },
            point: PathPoint {
                position: vector(4).unwrap() * 1e-3,
                axis: vector(7).unwrap().normalize(),
                feed: vector(10).unwrap().normalize(),
            },
            normal: vector(13).map(|normal| normal.normalize()),
            lean: Lean { lead: number(16).unwrap().to_radians(), tilt: number(17).unwrap().to_radians() },
            axis: vector(18),
            tip: vector(21).map(|tip| tip * 1e-3),
            contact: vector(24).map(|contact| contact * 1e-3),
            tool_x: vector(27),
            verdict: row[30].to_owned(),
        }
    });
    rows.collect()
}

#[test]
fn tools_lean_as_computed_apart() {
    let cases = cases();
    assert_eq!(cases.len(), 13);
    for case in cases {
        let checked = case.rule.check(&case.point, case.normal.as_ref(), &case.lean);
        if let Some(reason) = case.verdict.strip_prefix("refused: ") {
            assert_eq!(checked.unwrap_err().to_string(), reason, "{}", case.name);
            continue;
        }
        assert_eq!(checked, Ok(()), "{}", case.name);
        let leaned = case.rule.leaned(&case.point, case.normal.as_ref(), &case.lean);
        let off = |a: &Vector3<f64>, b: Option<Vector3<f64>>| (a - b.unwrap()).amax();
        assert!(off(&leaned.axis, case.axis) < 1e-9, "{}: axis {}", case.name, leaned.axis);
        assert!(off(&leaned.position, case.tip) < 1e-12, "{}: tip {}", case.name, leaned.position);
        let x = leaned.workpiece_from_point().column(0).into_owned();
        assert!(off(&x, case.tool_x) < 1e-9, "{}: x {x}", case.name);
        if let Some(normal) = case.normal {
            let contact = case.rule.end.contact(&leaned.position, &leaned.axis, &normal).unwrap();
            assert!(off(&contact, case.contact) < 1e-11, "{}: contact {contact}", case.name);
        }
    }
}

/// A point with an axis and a feed in any direction, and a normal within 60 deg of the axis.
fn point() -> impl Strategy<Value = (PathPoint, Vector3<f64>)> {
    let direction = prop::array::uniform3(-1.0..1.0_f64).prop_map(Vector3::from);
    (direction.clone(), direction.clone(), direction, 3.0..60.0_f64).prop_filter_map(
        "directions",
        |(a, f, n, angle)| {
            let (axis, feed) = (a.try_normalize(0.1)?, f.try_normalize(0.1)?);
            let aside = across(&n.try_normalize(0.1)?, &axis)?;
            let (sine, cosine) = libm::sincos(angle.to_radians());
            let point = PathPoint { position: Vector3::new(0.1, -0.2, 0.3), feed, axis };
            (axis.cross(&feed).norm() > 0.3).then_some((point, axis * cosine + aside * sine))
        },
    )
}

fn lean() -> impl Strategy<Value = Lean> {
    (-20.0..20.0_f64, -20.0..20.0_f64)
        .prop_map(|(lead, tilt)| Lean { lead: lead.to_radians(), tilt: tilt.to_radians() })
}

/// The lowest height of the end over the plane through the origin of heights, sampled over its torus.
fn lowest(end: &CutterEnd, tip: &Vector3<f64>, axis: &Vector3<f64>, normal: &Vector3<f64>) -> f64 {
    let aside = across(normal, axis).unwrap();
    let (inner, centre) = (end.radius - end.corner, tip + axis * end.corner);
    let mut least = f64::INFINITY;
    // All circles of the corner; by symmetry the lowest is towards -aside, which sampling has to find.
    let third = axis.cross(&aside);
    for k in 0..720 {
        let (sine, cosine) = libm::sincos(f64::from(k).to_radians() / 2.0);
        let spoke = aside * cosine + third * sine;
        least = least.min((centre + spoke * inner).dot(normal) - end.corner);
    }
    least
}

proptest! {
    #[test]
    fn the_angle_of_a_lean_is_that_between_the_axes((point, _) in point(), lean in lean()) {
        prop_assert!((lean.angle() - between(&point.axis, &lean.axis(&point))).abs() < 1e-9);
        let frame = point.workpiece_from_point();
        let axis = lean.axis(&point);
        prop_assert!((axis.dot(&frame.column(1)) - libm::sin(lean.tilt)).abs() < 1e-12);
    }

    /// However the tool leans, the plane that it touched is touched.
    #[test]
    fn a_cutter_keeps_its_plane((point, normal) in point(), lean in lean(), corner in 0.0..1.0_f64) {
        let end = CutterEnd { radius: 0.0125, corner: 0.0125 * corner };
        for contact in [ContactRule::Contact, ContactRule::Plane] {
            let rule = LeanRule { end, contact, force: LeanForce::Feed };
            if rule.check(&point, Some(&normal), &lean).is_err() {
                continue;
            }
            let leaned = rule.leaned(&point, Some(&normal), &lean);
            let heights = [point, leaned].map(|at| lowest(&end, &at.position, &at.axis, &normal));
            prop_assert!((heights[0] - heights[1]).abs() < 1e-12, "{heights:?}");
            if contact == ContactRule::Contact {
                let contacts = [point, leaned].map(|at| end.contact(&at.position, &at.axis, &normal).unwrap());
                prop_assert!((contacts[0] - contacts[1]).norm() < 1e-12);
            }
        }
    }

    /// Tip straight, axis evenly, by a degree at the most: the contact leaves its line by no more than is said.
    #[test]
    fn the_error_between_points_is_bounded(
        (point, normal) in point(), lean in lean(), to in lean(), corner in 0.0..1.0_f64
    ) {
        let end = CutterEnd { radius: 0.0125, corner: 0.0125 * corner };
        let rule = LeanRule { end, contact: ContactRule::Contact, force: LeanForce::Feed };
        // Steps of about a degree.
        let to = Lean { lead: lean.lead + 0.05 * to.lead, tilt: lean.tilt + 0.05 * to.tilt };
        prop_assume!([lean, to].iter().all(|lean| rule.check(&point, Some(&normal), lean).is_ok()));
        let [a, b] = [lean, to].map(|lean| rule.leaned(&point, Some(&normal), &lean));
        let turn = between(&a.axis, &b.axis);
        let nearest = nearest(&a.axis, &b.axis, &normal);
        prop_assume!(nearest > 9.0_f64.to_radians() && turn > 1e-3 && turn < 1.0_f64.to_radians());
        let fixed = end.contact(&a.position, &a.axis, &normal).unwrap();
        for k in 1..20 {
            let share = f64::from(k) / 20.0;
            let tip = a.position * (1.0 - share) + b.position * share;
            let weights = [libm::sin((1.0 - share) * turn), libm::sin(share * turn)];
            let axis = (a.axis * weights[0] + b.axis * weights[1]).normalize();
            let off = (end.contact(&tip, &axis, &normal).unwrap() - fixed).norm();
            prop_assert!(off <= end.path_error(turn, nearest), "{off} {}", end.path_error(turn, nearest));
        }
    }
}

/// Published beside the formula: a bull cutter of 25 mm with corners of 5 mm.
#[test]
fn effective_radii_are_known() {
    let end = CutterEnd { radius: 12.5, corner: 5.0 };
    let of = |lead: f64, tilt: f64| end.effective_radius(&Lean { lead: lead.to_radians(), tilt: tilt.to_radians() });
    for (lead, tilt, radius) in [(10.0, 0.0, 48.2), (10.0, 10.0, 20.2), (5.0, 20.0, 6.2)] {
        assert!((of(lead, tilt) - radius).abs() < 0.05, "{lead} {tilt} {}", of(lead, tilt));
    }
    // A flat cutter of 20 mm leaves 10 um up to its rim at 0.057 deg, in the middle of 4 mm at 2.8 deg.
    let flat = CutterEnd { radius: 10.0, corner: 0.0 };
    let scallop = |lead: f64, step| flat.scallop(&Lean { lead: lead.to_radians(), tilt: 0.0 }, step).unwrap();
    assert!((scallop(0.057, None) - 0.01).abs() < 1e-4 && (scallop(2.8, Some(4.0)) - 0.01).abs() < 2e-4);
}
