use super::json::rounded;
use super::*;
use std::path::Path;
use stead_calibration::identification::identify;
use stead_run_files::read_identification;

fn example() -> (IdentifyRun, Identified) {
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/identify-example.toml");
    let run = read_identification(&config).unwrap();
    let found = identify(&run.problem, &stead_numerics::monitor::Monitor::silent()).unwrap();
    (run, found)
}

#[test]
fn a_robot_file_changes_in_its_compliances_alone_however_it_is_written() {
    let (_, found) = example();
    let row = |extra: &str| format!("{{ alpha_deg = 0.0, {extra}, max_deg = 9 }}");
    let rows: Vec<String> = (1..=6)
        .map(|k| row(if k == 2 { "compliance_urad_per_nm = [1, 2]" } else { "stiffness_mnm_per_rad = 1" }))
        .collect();
    let text = format!(
        "name = 'x' # kept\njoints = [\n  {}\n]\n[covariance]\nparameters = []\nmatrix = []\n",
        rows.join(",\n  ")
    );
    let new = robot_file(&text, &found).unwrap();
    let document: toml::Table = new.parse().unwrap();
    assert!(
        new.starts_with("name = 'x' # kept\njoints = [\n  { alpha_deg = 0.0, compliance_urad_per_nm = 0.5"),
        "{new}"
    );
    for (index, row) in document["joints"].as_array().unwrap().iter().enumerate() {
        let row = row.as_table().unwrap();
        let compliance = row["compliance_urad_per_nm"].as_float().unwrap();
        let estimate = found.arm.iter().find(|e| e.parameter.joint == index).unwrap();
        assert!((compliance / (estimate.value * 1e6) - 1.0).abs() < 1e-15);
        assert_eq!((row.contains_key("stiffness_mnm_per_rad"), row.contains_key("compensator")), (false, index == 1));
        assert_eq!(row["max_deg"].as_integer(), Some(9));
    }
    assert_eq!(new.matches("[covariance]").count(), 1);
    assert_eq!(document["covariance"]["parameters"].as_array().unwrap().len(), found.arm.len());
    // The covariance in the units of the names, entry by entry.
    let unit = |name: &str| match name.rsplit('_').collect::<Vec<_>>()[..2] {
        ["nm", "per"] => 1e6,
        ["mm", "per"] => 1e-3,
        _ => 1e3,
    };
    let table = &document["covariance"];
    let names: Vec<&str> = table["parameters"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    for (i, row) in table["matrix"].as_array().unwrap().iter().enumerate() {
        for (j, entry) in row.as_array().unwrap().iter().enumerate() {
            let expected = found.covariance[(i, j)] * unit(names[i]) * unit(names[j]);
            let scale = found.arm[i].deviation * found.arm[j].deviation * unit(names[i]) * unit(names[j]);
            assert!((entry.as_float().unwrap() - expected).abs() < 1e-9 * scale, "{i} {j}");
        }
    }
    assert!(matches!(robot_file("name = 1", &found), Err(ReportError::Format { .. })));
}

#[test]
fn results_can_be_serialised_in_si_units() {
    let (_, found) = example();
    let value = serde_json::to_value(&found).unwrap();
    assert_eq!((&value["robot"], &value["warnings"]), (&serde_json::json!("KUKA KR270-2"), &serde_json::json!([])));
    assert_eq!(value["arm"][1]["parameter"], serde_json::json!({ "joint": 1, "quantity": "Compliance" }));
    assert_eq!(value["arm"][1]["value"].as_f64(), Some(found.arm[1].value));
    assert_eq!(value["covariance"][2][3].as_f64(), Some(found.covariance[(2, 3)]));
}

#[test]
fn numbers_have_the_digits_asked_for() {
    assert_eq!([rounded(0.123_456_789, 3), rounded(-98_765.0, 2), rounded(0.0, 5)], [0.123, -99_000.0, 0.0]);
}

#[test]
fn tables_and_text_tell_every_estimate_and_every_reading() {
    let (run, found) = example();
    let text = identify_text(&run, &found);
    assert_eq!(text.lines().filter(|line| line.starts_with("joints[")).count(), 8);
    assert_eq!(text.lines().filter(|line| line.starts_with("2 ")).count(), 5);
    assert!(text.contains("60 readings of 3 points in 20 configurations") && !text.contains("outlier"), "{text}");
    let rows = String::from_utf8(tables::residuals(&run, &found).unwrap()).unwrap();
    assert!(rows.lines().all(|line| line.split(',').count() == 14) && rows.lines().count() == 61);
    let svg = crate::picture::charts(&[page::agreement(&run, &found), page::residuals_chart(&run, &found)]);
    assert!(svg.contains("\n0.04") && svg.contains(" mm rms\n") && !svg.contains("left out"));
}
