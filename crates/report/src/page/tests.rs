use super::made::page;
use super::*;
use crate::Files;
use crate::output::Folder;
use crate::placement::{placement_files, write_placement};
use crate::testing::{context, outcome, problem};
use serde_json::json;

fn files() -> Files {
    placement_files(problem(), outcome(), &context()).unwrap()
}

fn of<'a>(files: &'a Files, name: &str) -> &'a [u8] {
    &files.iter().find(|(file, _)| file == name).unwrap().1
}

#[test]
fn the_page_is_small_the_same_each_time_and_names_no_address() {
    let made = files();
    let text = String::from_utf8(of(&made, PAGE).to_vec()).unwrap();
    assert!(text.len() < 600_000, "{}", text.len());
    assert_eq!(of(&made, PAGE), of(&files(), PAGE));
    assert!(text.contains("<title>paper · stead</title>") && !text.contains("://"));
    let mut without = context();
    without.page = false;
    let names = placement_files(problem(), outcome(), &without).unwrap();
    assert!(names.iter().all(|(name, _)| name != PAGE && name != DATA && name != gltf::SCENE));
}

#[test]
fn a_folder_gives_the_same_page_again() {
    let place = tempfile::tempdir().unwrap();
    let folder = Folder::create(place.path()).unwrap();
    write_placement(&folder, problem(), outcome(), &context()).unwrap();
    drop(folder);
    let file = place.path().join(PAGE);
    let first = std::fs::read(&file).unwrap();
    std::fs::write(&file, "spoilt").unwrap();
    let scene = place.path().join(gltf::SCENE);
    let moving = std::fs::read(&scene).unwrap();
    std::fs::write(&scene, "spoilt").unwrap();
    assert_eq!(rewrite(place.path()).unwrap(), [file.clone(), scene.clone()]);
    assert!(std::fs::read(&scene).unwrap() == moving);
    assert!(std::fs::read(&file).unwrap() == first);
    // As if never touched: the manifest too.
    assert_eq!(rewrite(place.path()).unwrap().len(), 2);
}

#[test]
fn folders_that_are_no_whole_run_are_refused_by_the_file() {
    let place = tempfile::tempdir().unwrap();
    let refused = |parts: &[&str]| {
        let message = rewrite(place.path()).unwrap_err().to_string();
        for part in parts.iter().chain(&["; allowed: "]) {
            assert!(message.contains(part), "{part} in {message}");
        }
    };
    refused(&["has no manifest.json"]);
    let missing = rewrite(&place.path().join("nowhere")).unwrap_err().to_string();
    assert!(missing.contains("nowhere: is no folder"), "{missing}");
    assert!(!place.path().join("nowhere").exists());
    let folder = Folder::create(place.path()).unwrap();
    let mut without = context();
    without.page = false;
    write_placement(&folder, problem(), outcome(), &without).unwrap();
    refused(&["lists no page-data.json: the run left no page"]);
    write_placement(&folder, problem(), outcome(), &context()).unwrap();
    drop(folder);
    let plan = place.path().join("worst.csv");
    let kept = std::fs::read(&plan).unwrap();
    std::fs::remove_file(&plan).unwrap();
    refused(&["worst.csv: is missing, though manifest.json lists it"]);
    std::fs::write(&plan, "point\n").unwrap();
    refused(&["worst.csv: is not the file that `stead place` has written"]);
    std::fs::write(&plan, kept).unwrap();
    rewrite(place.path()).unwrap();
}

#[test]
fn files_of_two_runs_or_of_another_format_make_no_page() {
    let with = |name: &str, change: &dyn Fn(&[u8]) -> Vec<u8>| {
        let mut changed = files();
        changed.iter_mut().filter(|(file, _)| file == name).for_each(|(_, bytes)| *bytes = change(bytes));
        page(&changed).unwrap_err().to_string()
    };
    let edit = |key: &'static str, to: serde_json::Value| {
        move |bytes: &[u8]| {
            let mut value: serde_json::Value = serde_json::from_slice(bytes).unwrap();
            value[key] = to.clone();
            value.to_string().into_bytes()
        }
    };
    let message = with("summary.json", &edit("inputs", json!([])));
    assert!(message.contains("page-data.json: inputs are not those of summary.json"), "{message}");
    let message = with(DATA, &edit("format", json!(7)));
    assert_eq!(message, "page-data.json: is of format 7, where this stead reads format 1");
    let message = with(DATA, &edit("command", json!("assess")));
    assert!(message.contains("command names no command"), "{message}");
    let message =
        with("best.csv", &|bytes| bytes.split_inclusive(|byte| *byte == b'\n').take(9).flatten().copied().collect());
    assert!(message.contains("best.csv: has 8 points and page-data.json 105"), "{message}");
    let message = with("deflection-map-worst.csv", &|bytes| bytes[..2000 - 1].to_vec());
    assert!(message.starts_with("deflection-map-worst.csv: "), "{message}");
}

#[test]
fn a_certificate_is_in_the_page() {
    let mut with = files();
    let certificate = json!({ "format": 1, "best": { "bound_mm": 0.1 } });
    with.push(("certificate.json".to_owned(), certificate.to_string().into_bytes()));
    let before = of(&with, PAGE).to_vec();
    put_page(&mut with).unwrap();
    let text = String::from_utf8(of(&with, PAGE).to_vec()).unwrap();
    assert!(text.as_bytes() != before && text.contains("\"bound_mm\":0.1"));
    assert_eq!(with.iter().filter(|(name, _)| name == PAGE).count(), 1);
}
