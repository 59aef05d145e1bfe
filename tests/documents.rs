//! The figures in the documents are those of the results that are shipped with them.

use crate::common::{assert_states_its_origin, files_with};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn result(name: &str) -> Value {
    let path = root().join("results").join(name).join("summary.json");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).unwrap()
}

/// The rows of all tables of README and validation page, cell by cell.
fn rows() -> Vec<Vec<String>> {
    let texts =
        ["README.md", "src/guide/validation.md"].map(|name| std::fs::read_to_string(root().join(name)).unwrap());
    let lines = texts.iter().flat_map(|text| text.lines()).filter(|line| line.starts_with('|'));
    lines.map(|line| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
}

/// The row whose first cell starts with a text, and those below it; there must be one such row.
fn row(start: &str) -> Vec<Vec<String>> {
    let rows = rows();
    let found: Vec<usize> = (0..rows.len()).filter(|k| rows[*k][0].starts_with(start)).collect();
    let [only] = found[..] else { panic!("{} rows start with {start}", found.len()) };
    rows[only..].to_vec()
}

/// Asserts that a cell states a value with the decimals that it prints.
fn assert_states(cell: &str, value: f64) {
    let decimals = cell.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let printed = format!("{value:.decimals$}");
    assert_eq!(cell, printed, "{value}");
}

fn means(name: &str) -> Vec<f64> {
    result(name)["cases"].as_array().unwrap().iter().map(|case| case["mean_mm"].as_f64().unwrap()).collect()
}

/// Every published or computed row of four cases, with what it must state.
#[test]
fn table_iii_states_the_shipped_results() {
    let published = &result("caro-2013")["reference"]["case_mm"];
    let published: Vec<f64> = published.as_array().unwrap().iter().map(|mean| mean.as_f64().unwrap()).collect();
    let computed = [means("caro-2013"), means("caro-2013-k1-0.8")];
    for (start, means) in [
        ("paper, mm", &published),
        ("stead, k1 = 0.237 as printed, mm", &computed[0]),
        ("stead, k1 = 0.8, mm", &computed[1]),
    ] {
        row(start)[0][1..5].iter().zip(means).for_each(|(cell, mean)| assert_states(cell, *mean));
    }
    for (start, means) in [
        ("paper, ratio", &published),
        ("stead, k1 = 0.237, ratio", &computed[0]),
        ("stead, k1 = 0.8, ratio", &computed[1]),
    ] {
        row(start)[0][1..5].iter().zip(means).for_each(|(cell, mean)| assert_states(cell, mean / means[0]));
    }
    let [_, agreement, ..] = &row("Table III of Caro et al.")[0][..] else { panic!("no agreement stated") };
    for (stated, means) in agreement.split(';').zip(&computed) {
        let ratios = stated.split_whitespace().take(3).map(|ratio| ratio.trim_end_matches(','));
        ratios.zip(&means[1..]).for_each(|(ratio, mean)| assert_states(ratio, mean / means[0]));
    }
}

#[test]
fn the_agreement_with_klimchik_is_that_of_the_shipped_results() {
    let compare = |name: &str, start: &str| {
        let reference = &result(name)["reference"];
        let cells = &row(start)[0];
        let percent = |cell: &str| cell.split(" %").next().unwrap().to_owned();
        assert_states(&percent(&cells[1]), reference["rms_percent"].as_f64().unwrap());
        let word = |is_same: &Value| if is_same.as_bool().unwrap() { "as printed" } else { "differs" };
        assert_eq!(cells[2], word(&Value::Bool(reference["same_best"] == true && reference["same_worst"] == true)));
        assert_eq!(cells[3], word(&reference["same_order"]));
        let (same, all) = (&reference["selection_cells_with_the_same_robots"], &reference["selection_cells"]);
        assert_eq!(cells[4], format!("{same} of {all} cells"));
        assert_eq!(reference["readings"], 55, "{} is a row of 55 values", cells[0]);
        percent(&cells[1])
    };
    let compatible = compare("klimchik-2017-table-compatible", "`stead assess configs/klimchik-2017-table-compatible");
    let as_written = compare("klimchik-2017", "`stead assess configs/klimchik-2017.toml");
    let stated = format!("{compatible} % rms in the table-compatible reading, {as_written} % with eq. 34 as written");
    assert_eq!(row("Klimchik et al. 2017, 55 printed")[0][1], stated);
}

#[test]
fn the_forces_of_the_umons_pass_are_those_of_the_shipped_result() {
    let summary = result("umons-aluminium");
    let variant = summary["variant"].as_str().unwrap();
    let rows = row(variant);
    let columns = [
        ("force_x", "min_n"),
        ("force_x", "max_n"),
        ("force_x", "mean_n"),
        ("force_x", "rms_n"),
        ("force_y", "min_n"),
        ("force_y", "mean_n"),
        ("force_y", "rms_n"),
    ];
    assert_eq!(rows[1][0], "published");
    for (cells, forces) in rows.iter().zip([&summary, &summary["published"]]) {
        for (cell, (force, key)) in cells[1..].iter().zip(columns) {
            assert_states(cell, forces[force][key].as_f64().unwrap());
        }
    }
}

/// The table of the page on studies has every case of the shipped study, under the names of its columns.
#[test]
fn the_study_of_k1_in_the_guide_is_the_shipped_one() {
    let page = std::fs::read_to_string(root().join("src/guide/studies.md")).unwrap();
    let cells = |line: &str| -> Vec<String> {
        line.trim_matches('|').split('|').map(|cell| cell.trim().trim_matches('`').to_owned()).collect()
    };
    let mut lines = page.lines().skip_while(|line| !line.starts_with("| `k1_mnm_per_rad` |"));
    let names = cells(lines.next().unwrap());
    let stated: Vec<Vec<String>> = lines.skip(1).take_while(|line| line.starts_with('|')).map(cells).collect();
    let mut table = csv::Reader::from_path(root().join("results/study-k1/study.csv")).unwrap();
    let rows: Vec<BTreeMap<String, String>> = table.deserialize().map(Result::unwrap).collect();
    assert_eq!(stated.len(), rows.len());
    for (stated, row) in stated.iter().zip(&rows) {
        for (name, cell) in names.iter().zip(stated) {
            assert_states(cell, row[name].parse().unwrap());
        }
    }
}

#[test]
fn every_shipped_document_states_its_origin() {
    let folders = std::fs::read_dir(root().join("results")).unwrap();
    let files = folders.flat_map(|folder| std::fs::read_dir(folder.unwrap().path()).unwrap());
    let documents = files.map(|file| file.unwrap().path()).filter(|path| path.extension().is_some_and(|e| e == "json"));
    // A manifest states for each command what it has read.
    let documents: Vec<PathBuf> = documents.filter(|path| !path.ends_with("manifest.json")).collect();
    assert!(documents.len() >= 12, "{documents:?}");
    for path in documents {
        let document = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        assert_states_its_origin(&document);
    }
}

/// Lines of guide, README and ARCHITECTURE and of comments in Rust files are within 120 columns, but for rows of tables
/// and for what cannot be broken, as a link.
#[test]
fn comments_and_pages_are_within_120_columns() {
    let (mut long, mut lines) = (Vec::new(), 0);
    let is_page = |path: &PathBuf| {
        let of_the_guide = path.parent().is_some_and(|folder| folder.ends_with("src/guide"));
        of_the_guide || ["README.md", "ARCHITECTURE.md"].iter().any(|name| *path == root().join(name))
    };
    let pages = files_with(".md").into_iter().filter(is_page);
    for (path, is_code) in files_with(".rs").into_iter().map(|path| (path, true)).chain(pages.map(|path| (path, false)))
    {
        let text = std::fs::read_to_string(&path).unwrap();
        for (number, line) in text.lines().enumerate() {
            let words = line.trim_start();
            if is_code && !words.starts_with("//") {
                continue;
            }
            lines += 1;
            let words =
                if is_code { words.trim_start_matches('/').trim_start_matches('!').trim_start() } else { words };
            if line.chars().count() > 120 && !words.starts_with('|') && words.contains(' ') {
                long.push(format!("{}:{}", path.display(), number + 1));
            }
        }
    }
    assert!(long.is_empty(), "{} lines: {long:#?}", long.len());
    assert!(lines > 10_000, "{lines}");
}

/// The book has every page of the guide once under its own heading, and every page, picture and file that a page names
/// is there.
#[test]
fn the_book_has_every_page_and_no_page_names_one_that_is_not_there() {
    let guide = root().join("src/guide");
    let book = std::fs::read_to_string(root().join("docs/book.toml")).unwrap();
    assert!(book.contains("src = \"../src/guide\""));
    let summary = std::fs::read_to_string(guide.join("SUMMARY.md")).unwrap();
    let chapters: Vec<(&str, &str)> =
        summary.lines().filter_map(|line| line.strip_prefix("- [")?.strip_suffix(")")?.split_once("](")).collect();
    let pages: Vec<PathBuf> = files_with(".md").into_iter().filter(|path| path.parent() == Some(&guide)).collect();
    assert_eq!(chapters.len() + 1, pages.len());
    let is_page = |name: &str| guide.join(format!("{name}.md")).is_file();
    let mut named = 0;
    for path in pages.iter().filter(|path| !path.ends_with("SUMMARY.md")) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        let heading = text.lines().next().unwrap().strip_prefix("# ").unwrap();
        assert_eq!(chapters.iter().filter(|chapter| **chapter == (heading, name)).count(), 1, "{name}: {heading}");
        // References in words: page `files`, pages `files` and `tables`.
        for (at, _) in text.match_indices("page") {
            let behind = text[at + 4..].trim_start_matches('s');
            let references = behind.strip_prefix([' ', '\n']).and_then(|rest| rest.strip_prefix('`'));
            if let Some((page, _)) = references.and_then(|rest| rest.split_once('`')) {
                assert!(is_page(page), "{name} refers to the page `{page}`");
                named += 1;
            }
        }
        // Links and pictures to files; a link to the web is none of them.
        for (at, _) in text.match_indices("](") {
            let target = text[at + 2..].split([')', ' ']).next().unwrap();
            let is_code = text[..at].lines().last().is_some_and(|line| line.contains('"'));
            if is_code || target.contains("://") || target.starts_with('#') {
                continue;
            }
            assert!(guide.join(target.split('#').next().unwrap()).exists(), "{name} links to {target}");
        }
    }
    assert!(named > 40, "{named}");
}
