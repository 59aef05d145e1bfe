//! A page of cards as one file.

use super::super::base64::base64;
use serde::Serialize;
use stead_format::input::sha256;

const MARKUP: &str = include_str!("cards.html");
const STYLE: &str = concat!(include_str!("../page.css"), include_str!("cards.css"));

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
    let digest = |text: &str| format!("sha256-{}", base64(&from_hex(&sha256(text.as_bytes()))));
    let policy = format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; img-src data:; base-uri 'none'; form-action 'none'",
        digest(&script),
        digest(STYLE)
    );
    // In JSON the sign stands only within texts.
    let data = String::from_utf8_lossy(&crate::document::compact(data)).replace('<', "\\u003c");
    let parts = [
        ("{{policy}}", policy.as_str()),
        ("{{title}}", &escaped(title)),
        ("{{style}}", STYLE),
        ("{{data}}", &data),
        ("{{script}}", &script),
    ];
    let mut page = String::with_capacity(data.len() + script.len() + STYLE.len() + MARKUP.len());
    let mut rest = MARKUP;
    for (mark, text) in parts {
        let (before, behind) = rest.split_once(mark).unwrap_or((rest, ""));
        page.push_str(before);
        page.push_str(text);
        rest = behind;
    }
    page.push_str(rest);
    page.into_bytes()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn from_hex(text: &str) -> Vec<u8> {
    let digit = |byte: u8| char::from(byte).to_digit(16).unwrap_or(0) as u8;
    text.as_bytes().chunks(2).map(|pair| digit(pair[0]) << 4 | pair.get(1).map_or(0, |low| digit(*low))).collect()
}
