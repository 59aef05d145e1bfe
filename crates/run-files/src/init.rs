//! Starter sets: small commented files of each kind that run as they are.

mod forces_for;
mod ground;
mod run_for;
mod stock;

pub use forces_for::init_forces;
pub use run_for::init_run;

use std::path::{Path, PathBuf};
use stead_disk::files::new::{Existing, write_all_new};
use stead_disk::input::InputError;
use stead_format::shipped;
use stead_format::toml_file::without_schema;

/// What a starter set is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StarterSet {
    /// `run.toml`, `robot.toml`, `task.csv` and `cell.toml`, for `stead place`.
    Place,
    /// `assess.toml` and `robot.toml`, for `stead assess`.
    Assess,
    /// `identify.toml`, `robot.toml` and `sheet.csv`, for `stead identify`.
    Identify,
    /// `simulate.toml` and `robot.toml`, for `stead simulate` and `stead stability`.
    Simulate,
    /// `study.toml` and the set for `stead place`, for `stead study`.
    Study,
    /// `compensate.toml` and the set for `stead place`, for `stead compensate`.
    Compensate,
    /// `forces.toml` and `part.nc`, for `stead forces`.
    Forces,
}

const ROBOT: (&str, &str) = ("robot.toml", include_str!("init/robot.toml"));
/// The set for `stead place`, which others begin from.
const PLACE: [(&str, &str); 4] = [
    ("run.toml", include_str!("init/run.toml")),
    ROBOT,
    ("task.csv", include_str!("init/task.csv")),
    ("cell.toml", include_str!("init/cell.toml")),
];

impl StarterSet {
    /// The files of the set with their names, the one to start with first.
    pub fn files(self) -> Vec<(&'static str, &'static str)> {
        match self {
            Self::Place => PLACE.to_vec(),
            Self::Assess => vec![("assess.toml", include_str!("init/assess.toml")), ROBOT],
            Self::Identify => vec![
                ("identify.toml", include_str!("init/identify.toml")),
                ROBOT,
                ("sheet.csv", include_str!("init/sheet.csv")),
            ],
            Self::Simulate => vec![
                ("simulate.toml", include_str!("init/simulate.toml")),
                ("robot.toml", without_schema(shipped::by_name("staubli-tx200").unwrap_or_default())),
            ],
            Self::Study => [&[("study.toml", include_str!("init/study.toml"))][..], &PLACE].concat(),
            Self::Forces => {
                vec![("forces.toml", include_str!("init/forces.toml")), ("part.nc", include_str!("init/part.nc"))]
            }
            Self::Compensate => [&[("compensate.toml", include_str!("init/compensate.toml"))][..], &PLACE].concat(),
        }
    }

    /// The files to write into a folder: where a run file is there already, what begins from one begins from that.
    fn files_in(self, folder: &Path) -> Vec<(&'static str, &'static str)> {
        let mut files = self.files();
        if matches!(self, Self::Study | Self::Compensate) && folder.join(PLACE[0].0).is_file() {
            files.truncate(1);
        }
        files
    }
}

/// Writes a starter set to a folder, which is made where there is none. All files or none: where one of them is there
/// already and to be kept, or one cannot be written, no file is left behind and none is changed. Beside a `run.toml`
/// that is there, [`StarterSet::Study`] and [`StarterSet::Compensate`] are one file for that run.
///
/// # Errors
/// [`InputError`] that names the file that is there already, or that cannot be written.
pub fn init(set: StarterSet, folder: &Path, existing: Existing) -> Result<Vec<PathBuf>, InputError> {
    let files: Vec<(PathBuf, &str)> =
        set.files_in(folder).into_iter().map(|(name, text)| (folder.join(name), text)).collect();
    write_all_new(&files, existing, &[])?;
    Ok(files.into_iter().map(|(path, _)| path).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Overrides, read_assessment, read_forces, read_identification, read_plan, read_run, read_simulation,
        read_stability, read_study,
    };

    fn written(set: StarterSet) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let files = init(set, folder.path(), Existing::Kept).unwrap();
        assert_eq!(files.len(), set.files().len());
        folder
    }

    #[test]
    fn every_set_is_read_as_it_is() {
        let place = written(StarterSet::Place);
        let run = read_run(&place.path().join("run.toml")).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(run.problem.task.points().len(), 17);
        assert!(run.notes.len() == 1 && run.notes[0].starts_with("collisions were not checked"), "{:?}", run.notes);
        let file = place.path().join("run.toml");
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text.replacen("# surroundings", "surroundings", 1)).unwrap();
        let run = read_run(&file).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(run.problem.scene.clone().map(|scene| scene.surroundings().shapes().len()), Some(5));
        let assess = written(StarterSet::Assess);
        read_assessment(&assess.path().join("assess.toml")).unwrap_or_else(|e| panic!("{e}"));
        let identify = written(StarterSet::Identify);
        read_identification(&identify.path().join("identify.toml")).unwrap_or_else(|e| panic!("{e}"));
        read_plan(&identify.path().join("identify.toml"), None).unwrap_or_else(|e| panic!("{e}"));
        let simulate = written(StarterSet::Simulate);
        let file = simulate.path().join("simulate.toml");
        read_simulation(&file, &Overrides::default()).unwrap_or_else(|e| panic!("{e}"));
        read_stability(&file, &Overrides::default()).unwrap_or_else(|e| panic!("{e}"));
        let forces = written(StarterSet::Forces);
        let run = read_forces(&forces.path().join("forces.toml")).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(run.problem.operation.rapids.len(), 3);
        let study = written(StarterSet::Study);
        read_study(&study.path().join("study.toml")).unwrap_or_else(|e| panic!("{e}"));
    }

    #[test]
    fn a_run_that_is_there_is_what_a_study_and_a_compensation_begin_from() {
        let folder = written(StarterSet::Place);
        for (set, name) in [(StarterSet::Study, "study.toml"), (StarterSet::Compensate, "compensate.toml")] {
            let files = init(set, folder.path(), Existing::Kept).unwrap();
            assert_eq!(files, [folder.path().join(name)]);
            assert!(init(set, folder.path(), Existing::Kept).unwrap_err().to_string().contains("is there already"));
        }
    }

    #[test]
    fn a_file_that_is_there_is_left_as_it_is_and_nothing_is_written() {
        for name in ["run.toml", "task.csv"] {
            let folder = tempfile::tempdir().unwrap();
            let mine = folder.path().join(name);
            std::fs::write(&mine, "mine").unwrap();
            let message = init(StarterSet::Place, folder.path(), Existing::Kept).unwrap_err().to_string();
            assert!(
                message.contains(&format!("{name}: is there already")) && message.contains("; allowed: "),
                "{message}"
            );
            assert_eq!(std::fs::read_to_string(&mine).unwrap(), "mine");
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        }
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "mine").unwrap();
        let message = init(StarterSet::Assess, &file.join("below"), Existing::Kept).unwrap_err().to_string();
        assert!(message.replace('\\', "/").contains("below/assess.toml: cannot be written: "), "{message}");
    }
}
