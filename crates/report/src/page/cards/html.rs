//! A page of cards as one file: the style of all pages and that of cards, the scripts of cards, the data.

use super::super::html::{STYLE, document};
use serde::Serialize;

const CARDS: &str = include_str!("cards.css");

/// The script, module by module; each uses only what stands above it when it is loaded.
const MODULES: [&str; 9] = [
    include_str!("script/sheet.js"),
    include_str!("script/dom.js"),
    include_str!("script/scale.js"),
    include_str!("script/plot.js"),
    include_str!("script/chart.js"),
    include_str!("script/heat-map.js"),
    include_str!("script/polar.js"),
    include_str!("script/table.js"),
    include_str!("script/main.js"),
];

/// The page with this title and these data.
pub(super) fn page(title: &str, data: &impl Serialize) -> Vec<u8> {
    let script = format!("(() => {{\n'use strict';\n{}}})();\n", MODULES.concat());
    let data = String::from_utf8_lossy(&crate::document::compact(data)).into_owned();
    document(title, &format!("{STYLE}{CARDS}"), &script, &data).into_bytes()
}
