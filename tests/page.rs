//! The page of a run: who leaves one, and `stead page`.

use crate::common::{Bench, RUN};

const PLACE: [&str; 4] = ["--x-mm", "0", "--y-mm", "-1640"];

#[test]
fn a_run_leaves_a_page_unless_it_is_not_wanted_and_it_can_be_made_again() {
    let bench = Bench::new();
    let place = |more: &[&str]| bench.stead(&[&["place", RUN, "--out", "out"], more].concat());
    assert_eq!(place(&[]).code, Some(0));
    let page = bench.read("out/report.html");
    let manifest = bench.read("out/manifest.json");
    assert!(page.contains("<title>run · stead</title>") && manifest.contains("page-data.json"));
    let scene = bench.tree("out").remove("cell.glb").unwrap().unwrap();
    assert!(scene.starts_with(b"glTF"));
    bench.write("out/report.html", "spoilt");
    bench.write("out/cell.glb", "spoilt");
    let again = bench.stead(&["page", "out"]);
    assert_eq!((again.code, again.stdout.as_str()), (Some(0), "out/report.html\nout/cell.glb\n"));
    assert!(bench.read("out/report.html") == page && bench.read("out/manifest.json") == manifest);

    assert!(bench.tree("out")["cell.glb"].as_ref() == Some(&scene));

    // Without a page none of the run before stays.
    assert_eq!(place(&["--no-page"]).code, Some(0));
    let names = bench.names("out");
    assert!(
        ["report.html", "cell.glb", "page-data.json"].iter().all(|page| names.iter().all(|name| name != page)),
        "{names:?}"
    );
    let refused = bench.stead(&["page", "out"]);
    assert_eq!(refused.code, Some(2));
    assert!(
        refused.stderr.contains("out: manifest.json lists no page-data.json: the run left no page; allowed: "),
        "{}",
        refused.stderr
    );
}

#[test]
fn a_score_leaves_a_page_and_a_name_is_no_markup() {
    let bench = Bench::new();
    bench.replace("configs/robots/kuka-kr270-2.toml", "\"KUKA KR270-2\"", "\"<script>alert(1)</script>\"");
    let arguments = [&["score", RUN], &PLACE[..], &["--z-mm", "-214", "--yaw-deg", "79", "--out", "out"]].concat();
    assert_eq!(bench.stead(&arguments).code, Some(0));
    let page = bench.read("out/report.html");
    assert!(page.contains(r"\u003cscript>alert(1)") && !page.contains("<script>alert"));
    let again = bench.stead(&["page", "out"]);
    assert_eq!(again.code, Some(0));
    assert!(bench.read("out/report.html") == page);
    let without = [&arguments[..], &["--set", "output.page=false"]].concat();
    assert_eq!(bench.stead(&without).code, Some(0));
    assert!(!bench.path("out/report.html").exists());
}
