//! `stead circularity`: roundness of measured points.

use super::arguments::CircularityOptions;
use super::{Failure, files_written, print, print_json, results_in, say_warnings};
use stead::Profile;
use stead_report::output::Folder;

pub(super) fn run(options: &CircularityOptions) -> Result<(), Failure> {
    let circularity = Profile::read(&options.points)?.circularity(&options.exclude_deg)?;
    say_warnings(circularity.warnings());
    let mut folder = String::new();
    if let Some(out) = &options.out {
        let out = Folder::create(out).map_err(Failure::Output)?;
        files_written(circularity.write_in(&out))?;
        folder = out.path().display().to_string();
    }
    if options.json {
        return print_json(&circularity);
    }
    print(format!("{circularity}{}", results_in(folder)).as_bytes())
}
