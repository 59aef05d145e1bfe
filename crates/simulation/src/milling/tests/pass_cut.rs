//! What cannot be cut is refused.

use crate::milling::MaterialRemoval;
use std::f64::consts::{FRAC_PI_2, PI};
use stead_model::cutting::{
    Coefficients, Cut, CutError, Cutter, CutterError, MillingDirection, PassCut, Rotation, Tooth,
};

const RADIUS: f64 = 5e-3;
const K: Coefficients = Coefficients::new(6e8, 2e8, 0.0);

#[test]
fn what_cannot_be_cut_is_refused() {
    let teeth = [170.0_f64, 190.0].map(|pitch| Tooth { pitch: pitch.to_radians(), radius: RADIUS });
    let cutter = Cutter::new(teeth.to_vec(), 0.5, Some(0.02), Rotation::Clockwise, K).unwrap();
    let good = PassCut {
        section: Cut { direction: MillingDirection::Climb, radial_depth: 4e-3, axial_depth: 1.6e-3 },
        length: 0.09,
        spindle_speed: 2e3,
        slices: 32,
        steps_per_turn: 90,
    };
    assert_eq!(good.check(&cutter), Ok(()));
    let refused = |change: &dyn Fn(&mut PassCut)| {
        let mut cut = good;
        change(&mut cut);
        cut.check(&cutter).unwrap_err()
    };
    for value in [0.0, -1.0, 10.001e-3, f64::NAN] {
        assert!(matches!(refused(&|cut| cut.section.radial_depth = value), CutError::Width { .. }));
    }
    for value in [0.0, 20.001e-3, f64::NAN] {
        assert!(matches!(refused(&|cut| cut.section.axial_depth = value), CutError::Depth { .. }));
    }
    for value in [0.0, f64::INFINITY, f64::NAN] {
        assert!(matches!(refused(&|cut| cut.length = value), CutError::Positive(_)));
        assert!(matches!(refused(&|cut| cut.spindle_speed = value), CutError::Positive(_)));
    }
    assert_eq!(refused(&|cut| cut.slices = 0), CutError::Slices);
    assert!(matches!(refused(&|cut| cut.steps_per_turn = 12), CutError::Steps { min: 13, .. }));
    let make = |pitch: f64, radius: f64, helix, flute, coefficients| {
        let teeth = vec![Tooth { pitch, radius: RADIUS }, Tooth { pitch: PI, radius }];
        Cutter::new(teeth, helix, Some(flute), Rotation::Clockwise, coefficients)
    };
    assert!(make(PI, 1e-3, 0.5, 0.01, K).is_ok());
    assert!(matches!(Cutter::new(vec![], 0.0, None, Rotation::Clockwise, K), Err(CutterError::Toothless)));
    for pitch in [3.0, 0.0, f64::NAN] {
        assert!(matches!(make(pitch, 1e-3, 0.5, 0.01, K), Err(CutterError::Pitch(_))));
    }
    for radius in [0.0, f64::INFINITY, f64::NAN] {
        assert!(matches!(make(PI, radius, 0.5, 0.01, K), Err(CutterError::Radius(_))));
    }
    assert!(matches!(make(PI, 1e-3, FRAC_PI_2, 0.01, K), Err(CutterError::Helix(_))));
    assert!(matches!(make(PI, 1e-3, 0.0, 0.0, K), Err(CutterError::Flute(_))));
    for tangential in [f64::NAN, f64::INFINITY] {
        let coefficients = Coefficients { tangential, ..K };
        assert!(matches!(make(PI, 1e-3, 0.0, 0.01, coefficients), Err(CutterError::Coefficient(_))));
    }
    for tangential in [0.0, -1.0] {
        let pulled = make(PI, RADIUS, 0.5, 0.02, Coefficients { tangential, ..K }).unwrap();
        assert_eq!(good.check(&pulled), Err(CutError::Coefficient(tangential)));
    }
    let edged = make(PI, RADIUS, 0.5, 0.02, Coefficients { radial_edge: 1e3, ..K }).unwrap();
    assert_eq!(good.check(&edged), Ok(()));
    assert_eq!(MaterialRemoval::new(&edged, &good).unwrap_err(), CutError::EdgeForces);
}
