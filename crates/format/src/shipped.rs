//! The texts of the robot files that are part of the program, by their names.

use std::path::Path;
use stead_disk::input::InputError;

/// What the name of a shipped arm begins with where a file is requested.
pub const PREFIX: &str = "name:";

/// The arms of these names with their files: those in `robots`, a link to `configs/robots`.
macro_rules! arms {
    ($($name:literal)+) => {
        &[$(($name, include_str!(concat!("../robots/", $name, ".toml")))),+]
    };
}

/// The arms with their files, in the order of their names.
pub(crate) const ARMS: &[(&str, &str)] = arms! {
    "abb-irb120" "abb-irb140" "abb-irb1600-10" "abb-irb4400-60" "abb-irb4600-40" "abb-irb6600-225" "abb-irb6620"
    "abb-irb6640-185" "abb-irb6640-235" "abb-irb6700-235" "abb-irb7600-150" "fanuc-m10ia" "fanuc-m20ia"
    "fanuc-m710ic-50" "fanuc-m900ia-260l" "fanuc-m900ib-700" "kuka-kr10-r1100" "kuka-kr100-ha" "kuka-kr120-r2700-2"
    "kuka-kr120-r3900" "kuka-kr210-2" "kuka-kr210-2-full" "kuka-kr210-r2700" "kuka-kr210-r2700-2" "kuka-kr210-r3100"
    "kuka-kr210-r3100-2" "kuka-kr240-2" "kuka-kr240-r2900-2" "kuka-kr270-2" "kuka-kr270-2-k1-0.265"
    "kuka-kr270-2-k1-0.8" "kuka-kr270-2-k1-1.41" "kuka-kr270-2-k1-5.6" "kuka-kr270-r2700" "kuka-kr300-r2700-2"
    "kuka-kr300-r2800-2-mt" "kuka-kr360-l240" "kuka-kr360-r2830" "kuka-kr500" "kuka-kr500-r2800-2" "kuka-kr6-r900"
    "kuka-kr60-ha" "motoman-ms210" "staubli-rx160l" "staubli-tx200" "staubli-tx200-huynh" "staubli-tx200l"
    "staubli-tx90"
};

/// The file of the shipped arm that a path names by `name:`; nothing for another path.
///
/// # Errors
/// [`InputError`] where there is no arm of this name.
pub fn text(file: &Path) -> Option<Result<&'static str, InputError>> {
    let name = file.to_str()?.strip_prefix(PREFIX)?;
    Some(by_name(name).ok_or_else(|| unknown(file)))
}

/// The file of the shipped arm of a name.
pub fn by_name(name: &str) -> Option<&'static str> {
    ARMS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// That a name is that of no shipped arm.
fn unknown(file: &Path) -> InputError {
    let name = file.to_str().and_then(|path| path.strip_prefix(PREFIX)).unwrap_or_default();
    InputError::new(file, "is no shipped arm").allowed(names_near(name))
}

/// What may be requested in the place of a name.
pub(crate) fn names_near(name: &str) -> String {
    let near = |(known, _): &&(&str, &str)| strsim::jaro(known, name);
    let near =
        ARMS.iter().max_by(|a, b| near(a).total_cmp(&near(b))).map(|(known, _)| format!("{known}, or another of "));
    let near = near.unwrap_or_default();
    format!("{near}the names that `stead robots` prints")
}
