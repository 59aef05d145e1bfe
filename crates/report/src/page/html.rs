//! The page as one file: markup, style, script and data, with a security policy that allows nothing else.

use super::packed::base64;
use super::script::script;
use stead_disk::input::sha256;

const MARKUP: &str = include_str!("page.html");
/// The style of all pages.
const STYLE: &str = concat!(include_str!("base.css"), include_str!("page.css"), include_str!("cards.css"));
/// That of the live page.
const LIVE_STYLE: &str =
    concat!(include_str!("base.css"), include_str!("page.css"), include_str!("cards.css"), include_str!("live.css"));

/// What the main module of the placement page is.
pub(super) const RUN: &str = "run/main.js";
/// What that of pages of cards is.
pub(super) const CARDS: &str = "cards/main.js";

/// What that of a placement that is moved by hand is.
pub(super) const LIVE: &str = "live/main.js";

/// A page with this title, script and content.
pub(super) fn html(title: &str, main: &str, content: &str) -> String {
    // The live page asks the server that it comes from, the others nobody.
    let (style, connections) = if main == LIVE { (LIVE_STYLE, "connect-src 'self'; ") } else { (STYLE, "") };
    document(title, &script_of(main), style, content, connections)
}

/// The script as it stands in a page. All pages can be joined, as the tests of `script` have it; one that could not
/// would say why.
fn script_of(main: &str) -> String {
    script(main).unwrap_or_else(|error| format!("throw new Error({:?});\n", error.to_string()))
}

fn document(title: &str, script: &str, style: &str, data: &str, connections: &str) -> String {
    let digest = |text: &str| format!("sha256-{}", base64(&from_hex(&sha256(text.as_bytes()))));
    let policy = format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; img-src data:; {connections}base-uri 'none'; form-action 'none'",
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
        let content = json!({ "name": "</script><script>alert(1)</script>" });
        let page = html("<b>&", RUN, &content.to_string());
        assert!(
            ["policy", "title", "style", "data", "script"]
                .iter()
                .all(|mark| !page.contains(&format!("{{{{{mark}}}}}")))
                && page.contains("<title>&lt;b&gt;&amp; · stead</title>")
        );
        // One for the data, one for the script.
        assert_eq!(page.matches("</script").count(), 2);
        assert!(page.contains(r"\u003c/script>"));
        assert!(!STYLE.contains("</"));
    }

    #[test]
    fn the_policy_has_the_digest_of_the_script() {
        // echo -n "alert('Hello, world.');" | openssl sha256 -binary | openssl base64
        let digest = base64(&from_hex(&sha256(b"alert('Hello, world.');")));
        assert_eq!(digest, "qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng=");
    }
}
