//! The texts of the robot files that are part of the program, by their names.

use std::path::Path;
use stead_disk::input::InputError;

/// What the name of a shipped arm begins with where a file is requested.
pub const PREFIX: &str = "name:";

/// A shipped arm by its name: the file of that name in `robots`, a link to `configs/robots`.
macro_rules! arm {
    ($name:literal) => {
        ($name, include_str!(concat!("../robots/", $name, ".toml")))
    };
}

/// The arms with their files, in the order of their names.
pub(crate) const ARMS: &[(&str, &str)] = &[
    arm!("abb-irb120"),
    arm!("abb-irb140"),
    arm!("abb-irb1600-10"),
    arm!("abb-irb4400-60"),
    arm!("abb-irb4600-40"),
    arm!("abb-irb6600-225"),
    arm!("abb-irb6620"),
    arm!("abb-irb6640-185"),
    arm!("abb-irb6640-235"),
    arm!("abb-irb6700-235"),
    arm!("abb-irb7600-150"),
    arm!("fanuc-m10ia"),
    arm!("fanuc-m20ia"),
    arm!("fanuc-m710ic-50"),
    arm!("fanuc-m900ia-260l"),
    arm!("fanuc-m900ib-700"),
    arm!("kuka-kr10-r1100"),
    arm!("kuka-kr100-ha"),
    arm!("kuka-kr120-r2700-2"),
    arm!("kuka-kr120-r3900"),
    arm!("kuka-kr210-2"),
    arm!("kuka-kr210-2-full"),
    arm!("kuka-kr210-r2700"),
    arm!("kuka-kr210-r2700-2"),
    arm!("kuka-kr210-r3100"),
    arm!("kuka-kr210-r3100-2"),
    arm!("kuka-kr240-2"),
    arm!("kuka-kr240-r2900-2"),
    arm!("kuka-kr270-2"),
    arm!("kuka-kr270-2-k1-0.265"),
    arm!("kuka-kr270-2-k1-0.8"),
    arm!("kuka-kr270-2-k1-1.41"),
    arm!("kuka-kr270-2-k1-5.6"),
    arm!("kuka-kr270-r2700"),
    arm!("kuka-kr300-r2700-2"),
    arm!("kuka-kr300-r2800-2-mt"),
    arm!("kuka-kr360-l240"),
    arm!("kuka-kr360-r2830"),
    arm!("kuka-kr500"),
    arm!("kuka-kr500-r2800-2"),
    arm!("kuka-kr6-r900"),
    arm!("kuka-kr60-ha"),
    arm!("motoman-ms210"),
    arm!("staubli-rx160l"),
    arm!("staubli-tx200"),
    arm!("staubli-tx200-huynh"),
    arm!("staubli-tx200l"),
    arm!("staubli-tx90"),
];

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
