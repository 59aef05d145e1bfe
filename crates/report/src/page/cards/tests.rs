//! What stands in a page, read back from its bytes.

use super::*;
use serde_json::{Value, json};

/// The data of a page.
fn data(html: &[u8]) -> Value {
    let text = std::str::from_utf8(html).unwrap();
    let start = text.find("id=\"data\">").unwrap() + 10;
    serde_json::from_str(&text[start..start + text[start..].find("</script>").unwrap()]).unwrap()
}

#[test]
fn names_from_the_input_are_text() {
    let evil = "</script><script>alert(1)</script>";
    let input = InputFile { role: "config", name: evil.to_owned(), sha256: "0".repeat(64) };
    let cell = Cell::Link { text: evil.to_owned(), path: "cases/1/report.html".to_owned() };
    let table =
        Table { title: evil.to_owned(), columns: vec![Column::text(evil)], rows: vec![vec![cell]], ..Table::default() };
    let page = Page::new(evil, evil, evil, &[input]).messages(&[evil], &[evil]).with(Card::Table(table));
    let html = page.html();
    let text = std::str::from_utf8(&html).unwrap();
    // One for the data, one for the script.
    assert_eq!(text.matches("</script").count(), 2);
    assert!(text.contains("<title>&lt;/script&gt;"));
    let data = data(&html);
    assert_eq!(data["title"], evil);
    assert_eq!(data["cards"][2]["rows"], json!([[[evil, "cases/1/report.html"]]]));
    assert_eq!(html, page.html());
}

#[test]
fn warnings_come_before_notes_and_both_before_the_rest() {
    let tiles = Card::Tiles(Tiles { tiles: vec![Tile::new("mean", "1", "mm", "")] });
    let page = Page::new("x", "", "", &[]).messages(&["w"], &["a", "b"]).with(tiles.clone());
    let kinds: Vec<Value> =
        data(&page.html())["cards"].as_array().unwrap().iter().map(|card| card["kind"].clone()).collect();
    assert_eq!(kinds, ["text", "text", "tiles"]);
    let none: [&str; 0] = [];
    assert_eq!(Page::new("x", "", "", &[]).messages(&none, &none).with(tiles).cards.len(), 1);
}

#[test]
fn numbers_are_short_and_what_is_none_is_null() {
    let series = Series::curve("a", 0, [[0.0, 1.0 / 3.0], [1.0, f64::NAN], [2.0, f64::INFINITY], [1e9, -123456789.0]]);
    let chart = Chart { series: vec![series], ..Chart::default() };
    let data = data(&Page::new("x", "", "", &[]).with(Card::Chart(chart)).html());
    let series = &data["cards"][0]["series"][0];
    assert_eq!(series["y"], json!([0.333333, null, null, -123457000.0]));
    assert_eq!(series["x"][3], json!(1e9));
}

/// A curve of many points keeps the highest and the lowest of each stretch, at its place.
#[test]
fn long_curves_keep_their_peaks() {
    let height = |k: usize| if k == 61_803 { 5.0 } else { libm::sin(k as f64 * 0.37) };
    let series = Series::curve("a", 0, (0..100_000).map(|k| [k as f64, height(k)]));
    assert!(series.x.len() <= 2000 && series.x.len() > 1500, "{}", series.x.len());
    assert!(series.x.windows(2).all(|pair| pair[0] < pair[1]));
    let peak = series.y.iter().position(|y| *y == 5.0).unwrap();
    assert_eq!(series.x[peak], 61_803.0);
    for (x, y) in series.x.iter().zip(&series.y) {
        assert_eq!(*y, height(*x as usize));
    }
    let short = Series::curve("a", 0, (0..2000).map(|k| [k as f64, 0.0]));
    assert_eq!(short.x.len(), 2000);
}
