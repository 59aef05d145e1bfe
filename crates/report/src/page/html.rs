//! The page as one file: markup, style, script and data, with a security policy that allows nothing else.

use super::base64::base64;
use serde_json::Value;
use stead_format::input::sha256;

const MARKUP: &str = include_str!("page.html");
/// The style of all pages.
pub(super) const STYLE: &str = concat!(include_str!("base.css"), include_str!("page.css"));

/// The script, module by module; each uses only what stands above it when it is loaded.
const MODULES: [&str; 28] = [
    include_str!("script/data.js"),
    include_str!("script/linear.js"),
    include_str!("script/path.js"),
    include_str!("script/kinematics.js"),
    include_str!("script/external-axes.js"),
    include_str!("script/colour.js"),
    include_str!("script/state.js"),
    include_str!("script/dom.js"),
    include_str!("script/mesh.js"),
    include_str!("script/bodies.js"),
    include_str!("script/path-mesh.js"),
    include_str!("script/surroundings.js"),
    include_str!("script/axis-tracks.js"),
    include_str!("script/shaders.js"),
    include_str!("script/gpu.js"),
    include_str!("script/camera.js"),
    include_str!("script/scene.js"),
    include_str!("script/scene-card.js"),
    include_str!("script/plot.js"),
    include_str!("script/line-chart.js"),
    include_str!("script/charts.js"),
    include_str!("script/map.js"),
    include_str!("script/header.js"),
    include_str!("script/transport.js"),
    include_str!("script/readings.js"),
    include_str!("script/cases.js"),
    include_str!("script/cards.js"),
    include_str!("script/main.js"),
];

/// The script as it stands in a page.
pub(super) fn script() -> String {
    format!("(() => {{\n'use strict';\n{}}})();\n", MODULES.concat())
}

/// The page with this title and content.
pub(super) fn html(title: &str, content: &Value) -> String {
    document(title, STYLE, &script(), &content.to_string())
}

/// A page with this title, style and script, and with data in JSON.
pub(super) fn document(title: &str, style: &str, script: &str, data: &str) -> String {
    let digest = |text: &str| format!("sha256-{}", base64(&from_hex(&sha256(text.as_bytes()))));
    let policy = format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; img-src data:; base-uri 'none'; form-action 'none'",
        digest(script),
        digest(style)
    );
    // In JSON the sign stands only within texts.
    let data = data.replace('<', "\\u003c");
    let parts = [
        ("{{policy}}", policy.as_str()),
        ("{{title}}", &escaped(title)),
        ("{{style}}", style),
        ("{{data}}", &data),
        ("{{script}}", script),
    ];
    let mut page = String::with_capacity(data.len() + script.len() + style.len() + MARKUP.len());
    let mut rest = MARKUP;
    for (mark, text) in parts {
        let (before, behind) = rest.split_once(mark).unwrap_or((rest, ""));
        page.push_str(before);
        page.push_str(text);
        rest = behind;
    }
    page.push_str(rest);
    page
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn from_hex(text: &str) -> Vec<u8> {
    let digit = |byte: u8| char::from(byte).to_digit(16).unwrap_or(0) as u8;
    text.as_bytes().chunks(2).map(|pair| digit(pair[0]) << 4 | pair.get(1).map_or(0, |low| digit(*low))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn all_marks_are_filled_and_nothing_ends_the_script_or_the_data() {
        let page = html("<b>&", &json!({ "name": "</script><script>alert(1)</script>" }));
        assert!(
            ["policy", "title", "style", "data", "script"]
                .iter()
                .all(|mark| !page.contains(&format!("{{{{{mark}}}}}")))
                && page.contains("<title>&lt;b&gt;&amp; · stead</title>")
        );
        // One for the data, one for the script.
        assert_eq!(page.matches("</script").count(), 2);
        assert!(page.contains(r"\u003c/script>"));
        assert!(!STYLE.contains("</") && !script().contains("</") && !script().contains("<!--"));
    }

    #[test]
    fn the_policy_has_the_digest_of_the_script() {
        // echo -n "alert('Hello, world.');" | openssl sha256 -binary | openssl base64
        let digest = base64(&from_hex(&sha256(b"alert('Hello, world.');")));
        assert_eq!(digest, "qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng=");
    }
}
