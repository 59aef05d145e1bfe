use super::super::testing::assert_well_formed;
use super::*;
use std::path::Path;
use std::sync::OnceLock;
use stead_numerics::monitor::Monitor;
use stead_run_files::{Overrides, read_simulation};
use stead_simulation::stability_analysis::analyse;

/// The shipped steel cut with few lobes.
fn found() -> &'static (SimulationRun, StabilityAnalysis) {
    static FOUND: OnceLock<(SimulationRun, StabilityAnalysis)> = OnceLock::new();
    FOUND.get_or_init(|| {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/umons-steel.toml");
        let mut run = read_simulation(&file, &Overrides::default()).unwrap();
        run.analysis.points = 3;
        let analysis = analyse(&run.setup, &run.cutter, &run.cut, &run.analysis, &Monitor::silent()).unwrap();
        (run, analysis)
    })
}

#[test]
fn the_document_has_the_keys_of_the_contract() {
    let (run, analysis) = found();
    let document = stability_json(run, analysis);
    assert_eq!((&document["stable"], &document["kind"]), (&false.into(), &"flip".into()));
    assert!(document["growth_rate_per_s"].as_f64().unwrap() > 0.0);
    assert_eq!(document["modes"].as_array().unwrap().len(), 6);
    assert!((document["modes"][0]["frequency_hz"].as_f64().unwrap() - 15.76).abs() < 0.01);
    assert!(document["modes"][0]["damping_ratio"].as_f64().unwrap() > 0.0);
    for method in ["semi_discretisation", "zero_order"] {
        assert!(document["critical_depth_mm"][method].as_f64().unwrap() > 0.1);
    }
    assert_eq!(document["lobes"].as_array().unwrap().len(), 3);
    assert!((document["lobes"][0]["spindle_rpm"].as_f64().unwrap() - 1033.33).abs() < 0.01);
    assert!(document["lobes"][0]["critical_depth_mm"].as_f64().unwrap() > 0.0);
    assert_eq!(document["spindle_rpm"], 3100.0);
}

#[test]
fn tables_have_their_columns() {
    let (_, analysis) = found();
    let text = |bytes: Result<Vec<u8>, ReportError>| String::from_utf8(bytes.unwrap()).unwrap();
    let modes = text(modes(analysis));
    let header = "mode,frequency_hz,damping_ratio,tip_x_mm_per_rad,tip_y_mm_per_rad,tip_z_mm_per_rad,joint1,joint2,";
    assert!(modes.starts_with(header) && modes.lines().count() == 7, "{modes}");
    let responses = text(responses(analysis));
    assert!(responses.starts_with("frequency_hz,feed_re_um_per_n,") && responses.lines().count() == 1001);
    let lobes = text(lobes(analysis));
    assert!(lobes.starts_with("spindle_rpm,critical_depth_mm,zero_order_mm\n1033.33,"), "{lobes}");
    assert_eq!(lobes.lines().count(), 4);
    let names: Vec<String> = (0..6).map(|k| tables::joint_name(k, 18)).collect();
    assert_eq!(names, ["joint1", "joint1_x", "joint1_y", "joint2", "joint2_x", "joint2_y"]);
}

#[test]
fn depths_without_a_limit_leave_no_number() {
    let (run, analysis) = found();
    let mut analysis = analysis.clone();
    analysis.lobes[1].semi_discretisation = None;
    analysis.cut_stability.semi_discretisation = None;
    let csv = String::from_utf8(lobes(&analysis).unwrap()).unwrap();
    assert!(csv.lines().nth(2).unwrap().contains(",,"), "{csv}");
    let document = stability_json(run, &analysis);
    assert!(document["lobes"][1]["critical_depth_mm"].is_null());
    assert!(document["critical_depth_mm"]["semi_discretisation"].is_null());
    assert!(stability_text(run, &analysis).contains("beyond 22.000 mm by semi-discretisation"));
    assert_well_formed(&picture::charts(&[page::lobes(run, &analysis)]));
}

#[test]
fn the_text_says_what_there_is() {
    let (run, analysis) = found();
    let text = stability_text(run, analysis);
    for part in
        ["Staubli TX200, springs", "15.76", "critical depth at 3100 rpm: 0.6", "chatters (flip", " ms (growth rate "]
    {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert!(text.contains("far more than a million times over the pass of 19.29 s"), "{text}");
    // Rates of our own: e^(ln 2 / 0.05 s) in 0.5 s is 2^10, and the other way round.
    let sentence = |rate: f64| {
        let mut analysis = analysis.clone();
        let multiplier = nalgebra::Complex::new(-libm::exp(rate * 0.02), 0.0);
        analysis.cut_stability.verdict = stead_simulation::stability::Verdict { multiplier, period: 0.02 };
        analysis.pass_time = 0.5;
        stability_text(run, &analysis)
    };
    let rate = std::f64::consts::LN_2 / 0.05;
    let grows = "vibrations double every 50.0 ms (growth rate 13.9 1/s), 1024 times over the pass of 0.50 s";
    assert!(sentence(rate).contains(grows), "{}", sentence(rate));
    let dies = "is stable: vibrations halve every 50.0 ms (decay rate 13.9 1/s)";
    assert!(sentence(-rate).contains(dies), "{}", sentence(-rate));
}

#[test]
fn pictures_are_well_formed_small_the_same_each_time_and_labelled() {
    let (run, analysis) = found();
    let draw = || [page::response(analysis), page::lobes(run, analysis)].map(|chart| picture::charts(&[chart]));
    let labels = [
        ["frequency (Hz)", "answer (um/N)", "along the feed", "15.8"],
        ["spindle speed (rpm)", "critical depth of cut (mm)", "zero-order solution", "1.60 mm: chatters"],
    ];
    for ((svg, again), labels) in draw().iter().zip(draw()).zip(labels) {
        assert_eq!(*svg, again);
        assert_well_formed(svg);
        assert!(svg.len() < 100_000, "{}", svg.len());
        for label in labels {
            assert!(svg.contains(label), "{label}");
        }
    }
}
