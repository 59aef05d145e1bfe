//! Page and scene of the files of a run.

use super::{DATA, PAGE, PageError, content, gltf, html};
use crate::Files;
use crate::output::ReportError;
use serde_json::Value;

/// The page of the files of a run, which `page-data.json` is among.
pub(super) fn page(files: &Files) -> Result<Vec<u8>, PageError> {
    let content = content::content(files)?;
    Ok(html::html(&title(&content), html::RUN, &content.to_string()).into_bytes())
}

/// Page and scene of the files of a run, which `page-data.json` is among.
pub(super) fn made_of(files: &Files) -> Result<Files, PageError> {
    Ok(vec![(PAGE.to_owned(), page(files)?), (gltf::SCENE.to_owned(), gltf::scene(files)?)])
}

/// Makes page and scene of files that hold `page-data.json`, in place of those among them; does nothing where they do
/// not.
///
/// # Errors
/// [`ReportError::Format`]: they make none.
pub fn put_page(files: &mut Files) -> Result<(), ReportError> {
    if files.iter().any(|(name, _)| name == DATA) {
        files.retain(|(name, _)| name != PAGE && name != gltf::SCENE);
        let made = made_of(files)?;
        files.extend(made);
    }
    Ok(())
}

/// The name of the run file, without its ending.
fn title(content: &Value) -> String {
    let inputs = content["inputs"].as_array().map_or(&[][..], Vec::as_slice);
    let config = inputs.iter().find(|input| input["role"] == "config").and_then(|input| input["name"].as_str());
    config.map_or("run", |name| name.strip_suffix(".toml").unwrap_or(name)).to_owned()
}
