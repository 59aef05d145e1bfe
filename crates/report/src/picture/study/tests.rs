use super::*;
use crate::study::testing::analysis;

#[test]
fn labels_are_short_and_fit() {
    let labels = ["robots/kuka-kr500.toml", "high and dry", "0.2", "0.123456789"].map(str::to_owned);
    assert_eq!(labels.clone().map(|label| short(&label)), ["kuka-kr500", "high and dry", "0.2", "0.123"]);
    assert_eq!(fitting(&labels[..2], 70), ["kuka-kr…", "high an…"]);
    let alike = ["kuka-kr270-r2700", "kuka-kr270-r3100"].map(str::to_owned);
    assert_eq!(fitting(&alike, 70), ["…0-r2700", "…0-r3100"]);
    let many: Vec<String> = (100..140).map(|k| k.to_string()).collect();
    let shown = fitting(&many, 8);
    assert_eq!((shown[0].as_str(), shown[1].as_str(), shown[4].as_str()), ("100", "", "104"));
}

#[test]
fn what_is_on_the_front_is_green_with_the_number_of_its_case() {
    let analysis = analysis();
    let svg = front(analysis.front.as_ref().unwrap(), &analysis.layouts);
    let green = svg.lines().filter(|line| line.starts_with("<circle") && line.contains("#009E73"));
    // The legend, and cases 1 and 2.
    assert_eq!(green.count(), 3);
    assert!(svg.contains("on the front: 2") && svg.contains("\n1\n") && svg.contains("\n2\n"));
    assert!(svg.contains("cycle_s (smaller is better)"));
}

#[test]
fn each_axis_has_a_panel_with_its_share() {
    let analysis = analysis();
    let svg = effects(&analysis.effects, &analysis.layouts);
    assert!(svg.contains("of the variance, by") && svg.contains("height") && svg.contains("robot"));
}

#[test]
fn the_map_has_a_figure_in_each_cell() {
    let analysis = analysis();
    let svg = map(analysis.map.as_ref().unwrap());
    for part in ["\n1.00\n", "\n2.00\n", "\n–\n", "objective_mm over two axes"] {
        assert!(svg.contains(part), "{part}");
    }
}
