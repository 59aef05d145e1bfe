//! Tests of what is written for a placement job.

use super::{place_json, placement_text, summary_json, tables, write_placement};
use crate::document::Timing;
use crate::output::Folder;
use crate::picture;
use crate::testing::{assert_well_formed, context, outcome, problem};
use stead_placement::outcome::{Case, Cases};

fn rows(bytes: &[u8]) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes);
    reader.records().map(|record| record.unwrap().iter().map(str::to_owned).collect()).collect()
}

fn column(rows: &[Vec<String>], name: &str) -> Vec<String> {
    let index = rows[0].iter().position(|field| field == name).unwrap_or_else(|| panic!("no column {name}"));
    rows[1..].iter().map(|row| row[index].clone()).collect()
}

#[test]
fn a_plan_has_one_row_per_path_point() {
    let rows = rows(&tables::plan(&outcome().cases.optima()[1].plan, None).unwrap());
    assert_eq!(rows.len(), 1 + 105);
    assert_eq!(
        rows[0].join(","),
        "point,segment,x_mm,y_mm,z_mm,beta_deg,posture,posture_words,turn_1,turn_4,turn_6,theta1_deg,theta2_deg,theta3_deg,theta4_deg,theta5_deg,theta6_deg,inverse_condition,force_x_n,force_y_n,force_z_n,deflection_x_mm,deflection_y_mm,deflection_z_mm,normal_mm,feed_mm,axial_mm,score_mm,total_mm"
    );
    assert_eq!(column(&rows, "segment")[104], "5");
}

#[test]
fn lengths_are_in_mm_angles_in_degrees_and_turns_are_whole() {
    let mut case = outcome().cases.best.clone();
    let point = &mut case.plan.points[0];
    point.position.x = 1e-3;
    point.normal_part = -8.3e-5;
    point.score = -0.0;
    point.joints[5] = 200.0_f64.to_radians();
    let rows = rows(&tables::plan(&case.plan, None).unwrap());
    assert_eq!(column(&rows, "x_mm")[0], "1.0000");
    assert_eq!(column(&rows, "normal_mm")[0], "-0.0830000");
    assert_eq!(column(&rows, "score_mm")[0], "0.0000000");
    assert_eq!(column(&rows, "theta6_deg")[0], "200.0000");
    assert_eq!(column(&rows, "turn_6")[0], "1");
}

#[test]
fn placements_state_ratios_references_and_times() {
    let table = rows(&tables::placements(&outcome().cases, context().reference.as_ref()).unwrap());
    assert_eq!(
        table[0].join(","),
        "case,x_mm,y_mm,z_mm,yaw_deg,q4,postures,posture_words,mean_mm,max_mm,ratio_to_case_1,reference_mm,cutting_s,transfer_s,cycle_s,objective_mm,mean_wall_mm,max_wall_mm,mean_axis_mm,max_axis_mm,mean_total_mm,max_total_mm,max_feed_mm_per_s,joint_travel_deg,max_joint_step_deg"
    );
    assert_eq!(column(&table, "reference_mm"), ["0.083", "0.35", "0.82", "1.2"]);
    assert_eq!(column(&table, "ratio_to_case_1")[0], "1.000000");
    assert_eq!(column(&table, "q4")[0], "0.925800");
    assert_eq!(column(&table, "postures")[0].split(' ').count(), 5);
    assert_eq!(column(&table, "transfer_s"), ["4.0000", "4.0000", "4.0000", ""]);
    assert_eq!(column(&table, "cycle_s")[3], "");
    assert_eq!(column(&table, "max_feed_mm_per_s"), ["60.0000", "60.0000", "", ""]);
    assert_eq!(column(&table, "objective_mm"), column(&table, "mean_mm"));
    let steps = outcome().cases.best.plan.points.windows(2).filter(|pair| pair[0].segment == pair[1].segment);
    let steps = steps.flat_map(|pair| (0..6).map(|j| (pair[1].joints[j] - pair[0].joints[j]).abs().to_degrees()));
    let (sum, most) = steps.fold((0.0, 0.0_f64), |(sum, most), step| (sum + step, most.max(step)));
    assert_eq!(column(&table, "joint_travel_deg")[0], format!("{sum:.4}"));
    assert_eq!(column(&table, "max_joint_step_deg")[0], format!("{most:.4}"));
    let total = outcome().cases.best.plan.points.iter().map(|point| point.deflection.norm()).sum::<f64>() / 105.0;
    assert_eq!(column(&table, "mean_total_mm")[0], format!("{:.7}", total * 1e3));
    let without = rows(&tables::placements(&outcome().cases, None).unwrap());
    assert_eq!(column(&without, "reference_mm"), ["", "", "", ""]);
}

#[test]
fn what_is_known_of_errors_is_stated_and_nothing_else_changes() {
    let mut known = outcome().clone();
    let Cases { best, best_worst_plan, worst } = &mut known.cases;
    for (k, case) in [best, best_worst_plan]
        .into_iter()
        .chain(worst.iter_mut().flat_map(|worst| [&mut worst.best, &mut worst.worst]))
        .enumerate()
    {
        case.plan.mean_deviation = Some(1e-6 * (k + 1) as f64);
        case.plan.points.iter_mut().for_each(|point| point.deviation = Some(2e-6 * (point.point + 1) as f64));
    }
    let pairs = [
        (
            tables::plan(&known.cases.best_worst_plan.plan, None),
            tables::plan(&outcome().cases.best_worst_plan.plan, None),
            "std_mm",
            "0.0040000",
        ),
        (
            tables::placements(&known.cases, None),
            tables::placements(&outcome().cases, None),
            "mean_std_mm",
            "0.0020000",
        ),
    ];
    for (with, without, name, second) in pairs {
        let (with, without) = (rows(&with.unwrap()), rows(&without.unwrap()));
        assert_eq!(column(&with, name)[1], second);
        let cut: Vec<Vec<String>> = with.iter().map(|row| row[..row.len() - 1].to_vec()).collect();
        assert_eq!(cut, without);
    }
    let timing = Timing { wall: 2.0, threads: 8 };
    let document = place_json(problem(), &known, &context(), &timing);
    assert_eq!(document["cases"][3]["mean_std_mm"], 0.004);
    assert_eq!(document["cases"][0]["plan"][9]["std_mm"], 0.02);
    let bare = place_json(problem(), outcome(), &context(), &timing);
    assert!(bare["cases"][3].get("mean_std_mm").is_none() && bare["cases"][0]["plan"][9].get("std_mm").is_none());
    assert!(summary_json(problem(), outcome(), &context())["criterion"].get("confidence").is_none());
    let text = placement_text(problem(), &known, &context());
    assert!(text.contains("std mm") && text.lines().all(|line| line.chars().count() <= 110), "{text}");
}

#[test]
fn maps_have_a_row_per_state_with_a_score_or_a_reason() {
    let map = &outcome().maps.as_ref().unwrap()[0];
    let table = rows(&tables::deflection_map((problem(), &outcome().cases.best.placement), map).unwrap());
    assert_eq!(table[0].join(","), "point,segment,beta_deg,score_mm,posture,reason");
    assert_eq!(table.len(), 1 + 105 * 120);
    assert_eq!(column(&table, "beta_deg")[..2], ["-180.0000", "-177.0000"]);
    let known =
        ["reach", "joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6", "conditioning", "deflection"];
    for row in &table[1..] {
        let blocked = row[3].is_empty() && row[4].is_empty() && known.contains(&row[5].as_str());
        assert!(blocked || row[5].is_empty() && !row[3].is_empty() && !row[4].is_empty(), "{row:?}");
    }
}

#[test]
fn the_other_tables_have_their_columns() {
    let table = rows(&tables::convergence(&outcome().convergence).unwrap());
    assert_eq!(table[0].join(","), "search,generation,best_mm,average_mm,feasible,population,evaluations");
    assert_eq!((table.len(), table[1][2].as_str()), (1 + 2 * 52, ""));
    assert_eq!(table[1 + 52][0], "worst");
    let table = rows(&tables::transfers(&outcome().cases, None).unwrap());
    assert_eq!(table[0].join(","), "case,after_segment,duration_s,travel_deg");
    assert_eq!(table.len(), 1 + 4 * 4);
    let table = rows(&tables::refinements(&outcome().refinements).unwrap());
    assert_eq!(column(&table, "status")[0], "converged: no more gain; converged: no first-order gain");
    assert_eq!(column(&table, "kkt_residual_mm")[0], "0.0000003200");
}

#[test]
fn json_has_the_keys_of_the_contract() {
    let timing = Timing { wall: 2.0, threads: 8 };
    let document = place_json(problem(), outcome(), &context(), &timing);
    for key in [
        "evaluations",
        "states",
        "states_per_second",
        "wall_s",
        "threads",
        "interrupted",
        "refinements",
        "reference",
        "table",
    ] {
        assert!(document.get(key).is_some(), "{key}");
    }
    assert_eq!(document["states_per_second"], 78_624_000.0);
    assert_eq!(document["reference"]["case_mm"][3], 1.2);
    let cases = document["cases"].as_array().unwrap();
    assert_eq!(
        cases.iter().map(|case| case["case"].as_u64()).collect::<Vec<_>>(),
        [Some(1), Some(2), Some(3), Some(4)]
    );
    for key in ["x_mm", "y_mm", "z_mm", "q4", "yaw_deg"] {
        assert!(cases[0]["placement"][key].is_number(), "{key}");
    }
    assert_eq!(cases[0]["placement"]["x_mm"], 2.2);
    assert!(cases[3]["cycle_s"].is_null() && cases[3]["cutting_s"] == 29.52);
    assert_eq!(cases[0]["postures"].as_array().unwrap().len(), 5);
    let plan = cases[0]["plan"].as_array().unwrap();
    assert_eq!(plan.len(), 105);
    for key in ["point", "segment", "beta_deg", "posture", "joints_deg", "inverse_condition", "normal_mm", "score_mm"] {
        assert!(!plan[0][key].is_null(), "{key}");
    }
    assert_eq!(plan[0]["joints_deg"].as_array().unwrap().len(), 6);
}

#[test]
fn summary_states_inputs_and_settings_but_neither_plans_nor_timing() {
    let document = summary_json(problem(), outcome(), &context());
    for key in ["version", "seed", "inputs", "search", "cell", "constraints", "cases", "refinements", "evaluations"] {
        assert!(document.get(key).is_some(), "{key}");
    }
    for key in ["wall_s", "threads", "states_per_second"] {
        assert!(document.get(key).is_none(), "{key}");
    }
    assert!(document["cases"][0].get("plan").is_none());
    assert_eq!(document["inputs"][1]["name"], "kuka-kr270-2.toml");
    assert_eq!(document["redundancy"]["max_beta_rate_deg_per_mm"], 0.9);
    assert_eq!(document["constraints"]["max_deflection_mm"], 4.5);
    let mut free = problem().clone();
    free.constraints.max_deflection = None;
    assert!(summary_json(&free, outcome(), &context())["constraints"]["max_deflection_mm"].is_null());
}

#[test]
fn pictures_are_well_formed_small_the_same_each_time_and_labelled() {
    let Cases { best, best_worst_plan, .. } = &outcome().cases;
    let make = || {
        [
            picture::convergence(outcome()),
            picture::deflection_map(
                problem(),
                &outcome().maps.as_ref().unwrap()[0],
                [best, best_worst_plan],
                "the best placement",
            ),
            picture::cell(problem(), outcome()),
        ]
    };
    let pictures = make();
    assert_eq!(pictures, make());
    let labels: [&[&str]; 3] = [
        &["generation", "mean deflection (mm)", "best so far", "after refinement"],
        &[
            "path point",
            "segment 5",
            "best plan",
            "worst plan",
            "limit of joint 5",
            "deflection normal to the feed (mm)",
        ],
        &["x (mm)", "y (mm)", "robot base", "Best placement", "Worst placement", "2701 mm"],
    ];
    for (svg, labels) in pictures.iter().zip(labels) {
        assert_well_formed(svg);
        assert!(svg.len() < 400_000, "{}", svg.len());
        for label in labels {
            assert!(svg.contains(label), "{label}");
        }
    }
}

#[test]
fn cases_are_those_of_table_iii() {
    let words = |case: &&Case| [case.placement_sense, case.plan_sense].map(crate::names::sense);
    let told: Vec<_> = outcome().cases.all().iter().map(words).collect();
    assert_eq!(told, [["best", "best"], ["best", "worst"], ["worst", "best"], ["worst", "worst"]]);
    assert_eq!(outcome().cases.all().iter().map(|case| case.number()).collect::<Vec<_>>(), [1, 2, 3, 4]);
}

#[test]
fn text_fits_into_110_columns_and_states_the_published_ratios() {
    let text = placement_text(problem(), outcome(), &context());
    assert!(text.lines().all(|line| line.chars().count() <= 110), "{text}");
    assert!(text.contains("14.46") && text.contains("Table III") && text.contains("-1643.5"), "{text}");
    let mut stopped = outcome().clone();
    stopped.interrupted = true;
    assert!(placement_text(problem(), &stopped, &context()).contains("stopped before its end"));
}

#[test]
fn a_placement_job_leaves_nineteen_files_and_the_same_ones_again() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::create(&place.path().join("out")).unwrap();
    let contents = || {
        let paths = write_placement(&folder, problem(), outcome(), &context()).unwrap();
        paths.iter().map(|path| std::fs::read(path).unwrap()).collect::<Vec<_>>()
    };
    let first = contents();
    assert_eq!(first.len(), 19);
    assert!(first.iter().all(|bytes| !bytes.is_empty()));
    assert_eq!(first, contents());
    // With the manifest, and the lock as long as the folder is held.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 21);
}
