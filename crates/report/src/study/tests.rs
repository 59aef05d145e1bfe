use super::testing::{analysis, table};
use super::*;
use stead_study::analysis::{AnalysisError, Question};
use stead_study::cases::{Table, TableCell};

fn lines(csv: Vec<u8>) -> Vec<String> {
    String::from_utf8(csv).unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn tables_have_what_was_found() {
    let analysis = analysis();
    let expected = [
        "rank,cases,robot,height,objective_mm,behind_best_percent,status,reason",
        "1,1,a.toml,100,1,0,placed,",
        "2,2,a.toml,200,2,100,placed,",
        "3,3,b.toml,100,4,300,placed,",
        ",4,b.toml,200,,,infeasible,joint 2 at 7.0 deg",
    ];
    assert_eq!(lines(ranking_table(&analysis).unwrap()), expected);
    let front = analysis.front.as_ref().unwrap();
    let expected = [
        "cases,robot,height,best_mean_total_mm,cycle_s,behind_within_noise",
        "1,a.toml,100,1,9,false",
        "2,a.toml,200,2,5,false",
    ];
    assert_eq!(lines(front_table(front, &analysis.layouts).unwrap()), expected);
    let effects = lines(effects_table(&analysis.effects).unwrap());
    assert_eq!(effects[0], "axis,method,share_percent,range,rank_correlation,slope,value,layouts,mean_of_objective_mm");
    assert!(effects[1].starts_with("robot,adjusted means,") && effects[1].contains(",3,,,a.toml,2,"), "{}", effects[1]);
}

#[test]
fn the_text_says_what_matters() {
    let text = study_text("cells", &analysis());
    for part in [
        "cells: 4 cases, 3 placed, 1 infeasible\n",
        "By objective_mm (smaller is better; within 0.2 % layouts tie",
        "best      1.0000  case 1 (robot = a.toml, height = 100)\n",
        "            mean deflection in all directions 1.00 mm\n",
        "next      2.0000  case 2 (robot = a.toml, height = 200), 100.0 % behind\n",
        "What matters most for objective_mm is robot: ",
        "On the front of best_mean_total_mm (smaller is better) and cycle_s (smaller is better): 2 of 3\n",
        "Without a placement: 1 of 4 cases\n  case 4: joint 2 at 7.0 deg\n",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}

#[test]
fn an_axis_alone_is_told_by_its_ends() {
    let mut table = table();
    table.rows.truncate(2);
    let text = study_text("cells", &Analysis::of(&table, &Question::default()).unwrap());
    let expected = "\nOnly height varies: objective_mm is from 1.0000 at 100 to 2.0000 at 200; along a straight line \
                    it changes by \
                    0.010000 per unit of height.\n";
    assert!(text.contains(expected), "{text}");
    assert!(!text.contains("of the variance"), "{text}");
}

#[test]
fn an_axis_that_the_best_layout_is_an_exception_of_is_named() {
    let mut table = table();
    let [case, height, objective] = ["case", "height", "objective_mm"].map(|name| table.column(name).unwrap());
    let mut last = table.rows[2].clone();
    (last[case], last[height], last[objective]) =
        (TableCell::Count(4), TableCell::Number(200.0), TableCell::Number(4.0));
    table.rows[3] = last;
    table.rows[2][objective] = TableCell::Number(9.0);
    let text = study_text("cells", &Analysis::of(&table, &Question::default()).unwrap());
    assert!(text.contains("\nheight: 200 is best on average, but the best layout has 100\n"), "{text}");
    assert!(!text.contains("\nrobot: "), "{text}");
}

#[test]
fn the_document_has_the_same() {
    let document = study_json("cells", &analysis(), &[]);
    assert_eq!(document["ranking"]["best"][0]["layout"]["axes"]["robot"], "a.toml");
    assert_eq!(document["ranking"]["next"]["behind_best_percent"], 100.0);
    assert_eq!(document["front"]["members"].as_array().unwrap().len(), 2);
    assert_eq!(document["failures"]["infeasible"], 1);
    assert_eq!(document["map"]["layouts"], serde_json::json!([1, 1, 1, 0]));
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let ask = |by: &str| Analysis::of(&table(), &Question { by: Some(by.to_owned()), ..Question::default() });
    let message = |by: &str| ask(by).unwrap_err().to_string();
    assert!(
        message("objectiv_mm")
            .starts_with("\"objectiv_mm\" is no column of study.csv (nearest one: objective_mm); allowed: ")
    );
    assert_eq!(ask("robot"), Err(AnalysisError::NoNumbers("robot".to_owned())));
    let front = |names: &[&str]| {
        let front = Some(names.iter().map(|name| (*name).to_owned()).collect());
        Analysis::of(&table(), &Question { front, ..Question::default() })
    };
    assert!(front(&["cycle_s"]).unwrap_err().to_string().contains("is no list of two to six columns"));
    assert!(front(&["cycle_s", "cycle_s:max"]).unwrap_err().to_string().contains("names a column twice"));
    let map = Some(["robot", "heigth"].map(str::to_owned));
    let error = Analysis::of(&table(), &Question { map, ..Question::default() }).unwrap_err().to_string();
    assert!(
        error.contains("\"heigth\" is no axis") && error.contains("(nearest one: height); allowed: robot, height"),
        "{error}"
    );
    let empty = Table { rows: vec![], ..table() };
    assert_eq!(Analysis::of(&empty, &Question::default()), Err(AnalysisError::Empty));
    let noise = Question { noise: 1.0, ..Question::default() };
    assert_eq!(
        Analysis::of(&table(), &noise).unwrap_err().to_string(),
        "a search noise of 100 % is out of range; allowed: 0 up to, but not including, 100"
    );
}

#[test]
fn a_study_without_any_placement_says_why() {
    let mut table = table();
    for row in &mut table.rows {
        *row = [
            &row[..6],
            &[TableCell::Text("infeasible".to_owned()), TableCell::Text("out of reach".to_owned())],
            &[const { TableCell::None }; 3],
        ]
        .concat();
    }
    let analysis = Analysis::of(&table, &Question::default()).unwrap();
    let text = study_text("cells", &analysis);
    assert!(
        text.contains("4 cases, 0 placed, 4 infeasible") && text.contains("4 cases, as case 1: out of reach"),
        "{text}"
    );
    let files = study_files("cells", &analysis, &[], &CasePages::new()).unwrap();
    let names: Vec<_> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["study-ranking.csv", "study-report.json", "report.html"]);
}

#[test]
fn tasks_with_placements_of_their_own_are_joined() {
    let mut table = table();
    let task = table.column("task").unwrap();
    let weight = table.column("task_weight").unwrap();
    let height = table.column("height").unwrap();
    for (row, (name, heavy)) in
        table.rows.iter_mut().zip([("s.csv", 1.0), ("t.csv", 3.0), ("s.csv", 1.0), ("t.csv", 3.0)])
    {
        (row[task], row[weight], row[height]) =
            (TableCell::Text(name.to_owned()), TableCell::Number(heavy), TableCell::Number(1.0));
    }
    let analysis = Analysis::of(&table, &Question::default()).unwrap();
    assert_eq!((analysis.layouts.all.len(), analysis.tasks.len()), (2, 2));
    assert_eq!(analysis.map.as_ref().unwrap().names, ["robot", "task"]);
    // (1 * 1 + 3 * 2) / 4 for the first robot; the second has no placement for t.csv.
    assert_eq!((analysis.ranking.ranked.len(), analysis.ranking.ranked[0].value), (1, 1.75));
    assert_eq!(analysis.layouts.status(&analysis.layouts.all[1]), ["infeasible", "t.csv: joint 2 at 7.0 deg"]);
    let text = study_text("cells", &analysis);
    assert!(text.contains("cases 1 2 (robot = a.toml)") && text.contains("s.csv"), "{text}");
}
