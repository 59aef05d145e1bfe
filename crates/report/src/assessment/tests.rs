use super::*;
use crate::document::Timing;
use serde_json::Value;
use std::path::Path;
use stead_assessment::comparison::assess;
use stead_numerics::monitor::Monitor;
use stead_run_files::read_assessment;

/// The published study, table-compatible, on a coarse map, with one piece of the file replaced.
fn comparison(from: &str, to: &str) -> (Comparison, AssessmentContext) {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs");
    let text = std::fs::read_to_string(configs.join("klimchik-2017-table-compatible.toml")).unwrap();
    assert!(text.contains(from), "{from}");
    let text =
        text.replace("step_mm = 25.0", "step_mm = 100.0").replace("points = 72", "points = 24").replace(from, to);
    let configs = std::path::absolute(configs).unwrap().display().to_string().replace('\\', "/");
    let text = text.replace("\"robots/", &format!("\"{configs}/robots/"));
    let text = text.replace("\"reference/", &format!("\"{configs}/reference/"));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("study.toml");
    std::fs::write(&file, text).unwrap();
    let run = read_assessment(&file).unwrap_or_else(|e| panic!("{e}"));
    let assessment = assess(&run.comparison, &Monitor::silent()).unwrap();
    let published = run.published.map(|published| {
        let agreement = published.figures.agreement(&assessment);
        (published, agreement)
    });
    (
        run.comparison,
        AssessmentContext {
            inputs: run.inputs,
            notes: run.notes,
            range_share: run.range_share,
            published,
            force_history: run.force_history,
        },
    )
}

fn rows(csv: &[u8]) -> Vec<csv::StringRecord> {
    csv::Reader::from_reader(csv).records().map(Result::unwrap).collect()
}

#[test]
fn tables_and_documents_tell_the_same() {
    let (comparison, context) = comparison("radius_mm", "radius_mm");
    let assessment = assess(&comparison, &Monitor::silent()).unwrap();
    let published = context.published.as_ref().map(|(published, _)| &published.figures);
    let document = assess_json(&assessment, &context, &Timing { wall: 1.5, threads: 2 });
    let table = rows(&tables::circularity(&assessment, published).unwrap());
    assert_eq!(table.len(), 20);
    let mut row = table.iter();
    for robot in document["robots"].as_array().unwrap() {
        for configuration in robot["configurations"].as_array().unwrap() {
            let row = row.next().unwrap();
            assert_eq!(row[0], *robot["name"].as_str().unwrap());
            assert_eq!(row[1], *configuration["elbow"].as_str().unwrap());
            assert_eq!(row[2], *configuration["load"].as_str().unwrap());
            for (column, key) in [(5, "min_mm"), (8, "max_mm"), (11, "middle_mm")] {
                assert_eq!(row[column].parse::<f64>().unwrap(), configuration[key].as_f64().unwrap());
            }
        }
    }
    // KR 100 HA, elbow up, test load: Table 5.
    assert_eq!([14, 15, 16].map(|column| &table[0][column]), ["1.5", "3.28", "2.1"]);
    let zones = rows(&tables::optimal_zones(&assessment, published).unwrap());
    assert_eq!((zones.len(), &zones[3][4], &zones[3][8]), (80, "1000.0000", "-"));
    // Table 6 is of the test load alone.
    assert_eq!(&zones[8][2], "rated");
    assert_eq!(&zones[8][8], "");
    assert_eq!(document["selection"].as_array().unwrap().len(), 30);
    let first = &document["selection"][0];
    assert_eq!((first["accuracy_mm"].as_f64(), first["force_n"].as_f64()), (Some(0.05), Some(100.0)));
    assert_eq!(first["robots"].as_array().unwrap().len(), 5);
    assert_eq!(document["reference"]["readings"], 55);
    assert_eq!(document["reference"]["same_best"], true);
    let text = assessment_text(&assessment, &context);
    for part in ["KUKA KR 120 R3900", "(4.00)", "most accurate first: KUKA KR 500", "rms difference"] {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert!(text.lines().all(|line| line.chars().count() < 150));
}

#[test]
fn a_robot_of_unknown_payload_has_no_rated_load_and_one_that_reaches_nothing_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/robots");
    let copy = |name: &str, to: &str, change: &dyn Fn(String) -> String| {
        let text = std::fs::read_to_string(robots.join(name)).unwrap();
        std::fs::write(folder.path().join(to), change(text)).unwrap();
    };
    copy("kuka-kr500.toml", "a.toml", &|text| text.replace("payload_kg = 500.0\n", ""));
    copy("kuka-kr270-r2700.toml", "b.toml", &|text| text.replace("KUKA KR 270 R2700", "kuka: KR 500"));
    let text = "robots = ['a.toml', 'b.toml']\n[benchmark]\nradius_mm = 100\nforce_n = [0, 100, 0]\n[map]\n\
                x_mm = [2600, 2700]\ny_mm = [1300, 1500]\nstep_mm = 100\n";
    std::fs::write(folder.path().join("study.toml"), text).unwrap();
    let run = read_assessment(&folder.path().join("study.toml")).unwrap();
    let assessment = assess(&run.comparison, &Monitor::silent()).unwrap();
    let context = AssessmentContext {
        inputs: run.inputs,
        notes: run.notes,
        range_share: run.range_share,
        published: None,
        force_history: None,
    };
    let document = assess_json(&assessment, &context, &Timing { wall: 0.0, threads: 1 });
    assert_eq!(document["robots"][0]["configurations"].as_array().unwrap().len(), 2);
    assert_eq!(document["robots"][1]["configurations"].as_array().unwrap().len(), 4);
    assert_eq!(document["robots"][1]["configurations"][0]["min_mm"], Value::Null);
    assert_eq!(document["order"].as_array().unwrap().len(), 1);
    assert_eq!(document["reference"], Value::Null);
    let text = assessment_text(&assessment, &context);
    assert!(text.contains("kuka: KR 500, elbow up: the circle fits nowhere (out of reach at 6 of 6 places)"), "{text}");
    // Both names make the same file name.
    assert_eq!([0, 1].map(|index| file_name(&assessment, index)), ["kuka-kr-500", "kuka-kr-500-2"]);
    let files = assessment_files(&run.comparison, &assessment, &context).unwrap();
    assert_eq!(files.len(), 12);
    let map = rows(&files.iter().find(|(name, _)| name == "map-kuka-kr-500.csv").unwrap().1);
    assert!(!map.is_empty() && map.iter().all(|row| row[4].is_empty() && row[3].parse::<f64>().unwrap() > 0.0));
}
